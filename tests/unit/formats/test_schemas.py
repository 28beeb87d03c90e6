"""The schemas are right: what gcodesim prints fits them, and no key may be missing or come besides."""

from __future__ import annotations

import json
from collections.abc import Iterator
from copy import deepcopy
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft202012Validator

import gcodesim.canon.events as ev
from gcodesim.cli import main
from gcodesim.cli.commands.schema import NAMES
from gcodesim.formats.canon_schema import EVENTS
from gcodesim.formats.json_schema import of_type
from gcodesim.formats.schemas import SCHEMAS, schema_of
from gcodesim.log.logfile import LogFile

CELL = """gcodesim: 1
machine: gantry_xyz
stock: {box: [100, 60, 20], zero: top-front-left, material: al6082_t6, resolution: 2}
tools: {1: {type: flat_end_mill, diameter: 6 mm}}
simulation: {world: kinematic}
subroutines: [.]
suppress: [{code: GS176, reason: this program is about it}]
"""
BAD = "G21 G90 G17 G94\nT1 M6\nG43 H1\nS8000\nM8\nG0 X10 Y10\nG0 Z2\nG1 Z-1 F400\no<s> call\nG1 X30\nG0 Z20\nM5\nM2\n"
SUB = "o<s> sub\nG1 X20\nG0 X10\nG0 X9999\no<s> endsub\nM2\n"
SPLINE = "G21 G90 G17\nG1 X0 Y0 F100\nG5 X10 Y0 I2 J3 P-2 Q3\nM2\n"
MISTAKE = "G21\nG1 X5\nG2 X10 I4 F100\nM2\n"


@pytest.fixture(scope="module")
def printed(tmp_path_factory: pytest.TempPathFactory) -> dict[str, list[Any]]:
    """What commands print as JSON, by the name of the schema."""
    folder = tmp_path_factory.mktemp("printed")
    files = {
        "cell.yaml": CELL,
        "bad.nc": BAD,
        "s.ngc": SUB,
        "mistake.nc": MISTAKE,
        "spline.nc": SPLINE,
        "bad.test.yaml": "cell: cell.yaml\n",
    }
    for name, text in {**files, "broken.yaml": "gcodesim: 1\nmachin: x\n", "x.test.yaml": "sell: y\n"}.items():
        (folder / name).write_text(text)
    patch = pytest.MonkeyPatch()
    patch.chdir(folder)
    patch.setenv("GCODESIM_TEST_CACHE", str(folder / "cache"))
    try:
        return {
            "results": [
                _json("run", "bad.nc", "--cell", "cell.yaml"),
                _json("check", "bad.nc", "--cell", "cell.yaml"),
                _json("check", "mistake.nc", "--cell", "cell.yaml"),
                _json("run", "bad.nc", "--cell", "broken.yaml"),
                json.loads((folder / "out/results.json").read_text()),
            ],
            "findings": [_json("lint", "bad.nc", "mistake.nc"), _json("cell", "validate", "broken.yaml")],
            "test": [_json("test"), *_accepted_and_changed(folder)],
            "mutants": [_json("test", "--fail-on", "never", "--mutate", "6")],
            "diff": [
                _json("diff", "bad.nc", "mistake.nc"),
                _json("diff", "bad.nc", "bad.nc"),
                _json("diff", "out", "out2"),
                _json("diff", "out", "out3"),
                _json("diff", ".", "sub"),
            ],
            "canon": [_json("canon", name) for name in ("bad.nc", "mistake.nc", "spline.nc")],
            "baseline": [_baseline(folder)],
            "info": [_json("info", "out2"), *(_json("info", name) for name in _harmed_logs(folder))],
        }
    finally:
        patch.undo()


def _json(*arguments: str) -> Any:
    import contextlib
    import io

    out = io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err := io.StringIO()):
        main([*arguments, "--format", "json"])
    assert out.getvalue(), err.getvalue()
    return json.loads(out.getvalue())


def _accepted_and_changed(folder: Path) -> Iterator[Any]:
    """Verdicts of a case that was accepted: as it was, and with a deeper cut."""
    (folder / "x.test.yaml").unlink()
    main(["accept"])
    yield _json("test")
    (folder / "bad.nc").write_text(BAD.replace("Z-1", "Z-3").replace("G1 X30", "G1 X30\nG1 Y12"))
    yield _json("test")
    for out in ("out2", "out3"):
        _json("run", "bad.nc", "--cell", "cell.yaml", "--out", out)
    (folder / "sub").mkdir()
    (folder / "sub/bad.nc").write_text(BAD)


def _harmed_logs(folder: Path) -> Iterator[str]:
    """Logs with a chunk and an attachment that are damaged, and one without its end."""
    whole = (folder / "out2/run.mcap").read_bytes()
    log = LogFile.open(folder / "out2/run.mcap")
    data = bytearray(whole)
    for at in (log.chunks[0].offset + 200, log.attachments["results.json"][0] + 200):
        data[at] ^= 1
    (folder / "harmed.mcap").write_bytes(data)
    (folder / "cut.mcap").write_bytes(whole[: len(whole) * 2 // 3])
    yield from ("harmed.mcap", "cut.mcap")


def _baseline(folder: Path) -> Any:
    main(["lint", "mistake.nc", "--write-baseline", "known.json"])
    return json.loads((folder / "known.json").read_text())


JSON_OUTPUTS = ("results", "findings", "test", "mutants", "diff", "canon", "baseline", "info")


@pytest.mark.parametrize("name", SCHEMAS)
def test_a_schema_is_one(name: str) -> None:
    Draft202012Validator.check_schema(schema_of(name))


@pytest.mark.parametrize("name", JSON_OUTPUTS)
def test_what_is_printed_fits(name: str, printed: dict[str, list[Any]]) -> None:
    validator = Draft202012Validator(schema_of(name))
    for value in printed[name]:
        errors = [f"{error.json_path}: {error.message[:200]}" for error in validator.iter_errors(value)]
        assert not errors


def _places(value: Any, at: tuple[str | int, ...] = ()) -> Iterator[tuple[str | int, ...]]:
    """Paths of all objects in a value."""
    if isinstance(value, dict):
        yield at
        for key, one in value.items():
            yield from _places(one, (*at, key))
    elif isinstance(value, list):
        for i, one in enumerate(value[:3]):
            yield from _places(one, (*at, i))


FREE = {"stocks", "programs", "run", "result"}
"""Objects whose keys are names of the user's; old and new values of a change may be anything."""


@pytest.mark.parametrize("name", JSON_OUTPUTS)
def test_no_key_may_come_besides_or_be_missing(name: str, printed: dict[str, list[Any]]) -> None:
    """Every object of the output in turn gets a key more and loses one: the schema sees both."""
    validator = Draft202012Validator(schema_of(name))
    for value in printed[name]:
        for at in _places(value):
            if (at and at[-1] in FREE) or {"old", "new"} & set(at):
                continue
            for change in (_with_another, _without_one):
                if change is _with_another and at[-2:-1] == ("tools",):
                    continue  # a figure that a process of the cell declares
                changed = deepcopy(value)
                inside = changed
                for step in at:
                    inside = inside[step]
                if change(inside):
                    assert not validator.is_valid(changed), (at, change.__name__)


def _with_another(value: dict[str, Any]) -> bool:
    value["surprise"] = 1
    return True


def _without_one(value: dict[str, Any]) -> bool:
    optional = {"count", "line"} if "kind" in value or set(value) >= {"file", "code", "line"} else set()
    name = next((name for name in value if name not in optional), None)
    if name is None:
        return False
    del value[name]
    return True


def test_outputs_say_all_there_is_to_say(printed: dict[str, list[Any]]) -> None:
    """The examples are no empty ones: lists that the schemas describe have entries somewhere."""
    results = printed["results"][0]
    assert all(results[name] for name in ("findings", "stocks", "tools", "joints", "not_simulated"))
    assert results["inputs"]["files"] and any(one["callers"] for one in results["findings"])
    assert {value["status"] for value in printed["results"]} >= {"findings", "failed"}
    broken, accepted, changed = printed["test"]
    assert broken["findings"] and accepted["failed"] is False and changed["failed"] is True
    comparison = changed["cases"][0]["comparison"]
    assert comparison["moves"] and comparison["changes"] and comparison["totals"]
    assert {value["status"] for value in printed["canon"]} == {"ok", "error"}


def test_every_kind_of_event_has_its_record() -> None:
    kinds = {cls.__name__ for cls in vars(ev).values() if isinstance(cls, type) and issubclass(cls, ev.Event)}
    from gcodesim.canon.listing import _KINDS

    assert {cls.__name__ for cls in _KINDS} == kinds - {"Event", "Move"}
    assert {kind for kind, _ in _KINDS.values()} == set(EVENTS)


def test_all_listings_of_the_conformance_corpus_fit() -> None:
    """They are facts about another program, in the same form; events of one shape are tried once."""
    met: dict[str, Any] = {}
    for path in sorted(Path(__file__).parents[2].joinpath("data/conformance").rglob("*.json")):
        for event in json.loads(path.read_text(encoding="utf-8")).get("events", []):
            shape = {name: type(value).__name__ for name, value in sorted(event.items())}
            if event["kind"] != "spline":  # the corpus has samples of them, we print points of our own
                met.setdefault(f"{event['kind']} {shape}", event)
    assert len({event["kind"] for event in met.values()}) > 15
    listing = {"status": "ok", "error": None, "events": list(met.values()), "findings": []}
    validator = Draft202012Validator(schema_of("canon"))
    assert not [error.message[:300] for error in validator.iter_errors(listing)]


@pytest.mark.parametrize("kind", [{1, 2}, list[int], complex])
def test_types_without_a_schema_are_told(kind: Any) -> None:
    with pytest.raises(TypeError):
        of_type(kind, {})


def test_the_command_names_all_of_them() -> None:
    assert tuple(SCHEMAS) == NAMES
