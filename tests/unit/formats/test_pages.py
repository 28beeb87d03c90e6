"""The pages about formats: generated parts are fresh, examples in YAML are what the tools take."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from check_jsonschema.builtin_schemas import get_builtin_schema
from ruamel.yaml import YAML

from gcodesim.cli.parser import build_parser
from gcodesim.formats.reference import reference
from gcodesim.key_page import with_keys

TOP = Path(__file__).parents[3]


def page(name: str) -> str:
    return (TOP / "docs" / name).read_text(encoding="utf-8")


def yaml_blocks(name: str) -> list[Any]:
    blocks = re.findall(r"```yaml\n(.*?)```", page(name), re.DOTALL)
    return [YAML(typ="safe", pure=True).load(block) for block in blocks]


def test_the_keys_are_fresh() -> None:
    assert page("output-formats.md") == with_keys(page("output-formats.md"), reference())
    assert len(reference().splitlines()) > 90


def test_the_examples_fit_the_schemas_of_the_servers() -> None:
    workflow, gitlab, hooks = yaml_blocks("ci.md")
    jsonschema.validate({"on": "push", **workflow}, get_builtin_schema("vendor.github-workflows"))
    jsonschema.validate(gitlab, get_builtin_schema("vendor.gitlab-ci"))
    action = YAML(typ="safe", pure=True).load((TOP / "action.yml").read_text(encoding="utf-8"))
    [used] = [step for step in workflow["jobs"]["gcodesim"]["steps"] if "gcodesim" in step["uses"]]
    assert set(used["with"]) <= set(action["inputs"])
    offered = YAML(typ="safe", pure=True).load((TOP / ".pre-commit-hooks.yaml").read_text(encoding="utf-8"))
    assert {hook["id"] for hook in hooks["repos"][0]["hooks"]} == {hook["id"] for hook in offered}


@pytest.mark.parametrize("name", ["ci.md", "output-formats.md"])
def test_options_that_the_pages_name_exist(name: str) -> None:
    parser = build_parser()
    known = set(re.findall(r"--[a-z][\w-]+", parser.format_help()))
    [commands] = [one for one in parser._actions if hasattr(one, "choices") and one.choices]
    for command in commands.choices.values():  # type: ignore[union-attr]
        known |= set(re.findall(r"--[a-z][\w-]+", command.format_help()))
    plugin = (TOP / "gcodesim" / "pytest_plugin.py").read_text(encoding="utf-8")
    of_pytest = {"--lf", *re.findall(r'addoption\(\s*"(--[a-z][\w-]+)"', plugin)}
    assert set(re.findall(r"--[a-z][\w-]+", page(name))) <= known | of_pytest
