"""The JSON Schema agrees with the reader."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft202012Validator
from ruamel.yaml import YAML

from gcodesim.cell.schema import cell_schema

TESTS = Path(__file__).parents[2]
SOUND = sorted([*(TESTS / "data" / "cells" / "sound").glob("*.yaml"), *(TESTS.parent / "cells").glob("*.yaml")])
BROKEN = TESTS / "data" / "cells" / "broken"


def plain(path: Path) -> Any:
    """What an editor hands to the schema: YAML 1.2 values, keys and dates as texts."""
    text = path.read_text(encoding="utf-8")
    return json.loads(json.dumps(YAML(typ="safe", pure=True).load(text), default=str))


@pytest.fixture(scope="module")
def validator() -> Draft202012Validator:
    schema = cell_schema()
    Draft202012Validator.check_schema(schema)
    return Draft202012Validator(schema)


@pytest.mark.parametrize("path", SOUND, ids=lambda path: path.stem)
def test_sound_cells_are_valid(path: Path, validator: Draft202012Validator) -> None:
    assert [error.message for error in validator.iter_errors(plain(path))] == []


@pytest.mark.parametrize(
    "name",
    [
        "unknown_key_top",
        "unknown_key_tool",
        "no_machine",
        "rapids_word",
        "word_on",
        "tool_type_unknown",
        "bull_nose_without_radius",
        "unit_missing",
        "work_offset_name",
        "check_unknown",
        "dialect_unknown",
        "flutes_fraction",
        "file_missing",
    ],
)
def test_what_a_schema_can_see_it_refuses(name: str, validator: Draft202012Validator) -> None:
    valid = validator.is_valid(plain(BROKEN / f"{name}.yaml"))

    assert valid is (name == "file_missing")  # a schema knows nothing of files


def test_every_key_is_described(validator: Draft202012Validator) -> None:
    schema = validator.schema
    assert isinstance(schema, dict)
    cell = schema["$defs"]["Cell"]["properties"]

    assert {"machine", "robots", "stock", "tools", "work_offsets", "simulation"} <= cell.keys()
    assert all("description" in entry for entry in cell.values())
    assert json.dumps(schema, sort_keys=True) == json.dumps(cell_schema(), sort_keys=True)
