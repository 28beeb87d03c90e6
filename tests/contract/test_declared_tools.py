"""What a tool of another package may declare: every kind of value is read, refused, described and listed."""

from __future__ import annotations

import json
from math import pi
from typing import Any

import pytest
from jsonschema import Draft202012Validator

from gcodesim.cell import LoadedCell
from gcodesim.cell.reference import tool_reference
from gcodesim.cell.schema import cell_schema
from gcodesim.cell.show import cell_as_json, cell_as_text
from gcodesim.declarations.keys import all_keys
from gcodesim.diagnostics.show import as_text
from gcodesim.tools import TOOLS
from tests.contract.declared_tools import Gripper, SprayGun
from tests.unit.cell.text import loaded, sound

HEAD = "machine: gantry_xyz\ntools:\n  1: "


@pytest.fixture(autouse=True)
def newcomers(monkeypatch: pytest.MonkeyPatch) -> None:
    """As an entry point adds them."""
    for cls in (Gripper, SprayGun):
        monkeypatch.setitem(TOOLS._entries, cls.kind, f"{cls.__module__}:{cls.__name__}")


def gripper(more: str) -> str:
    return f"{HEAD}{{type: test_gripper, force: 60 N{more}}}\n"


def told(result: LoadedCell) -> list[str]:
    return [as_text(finding, result.sources) for finding in result.findings]


def test_values_are_read_in_si() -> None:
    tool = sound(
        gripper(
            ", power: 0.2 kW, pressure: 6 bar, closing: 150 ms, openings: [5, 60 mm], forces: [10 N, 0.02 kN],"
            " mode: angular, senses: true, jaw: vise.stl, finger: {width: 2 cm}, holder: {diameter: 40, length: 50}"
        )
    ).tools[1]

    assert isinstance(tool, Gripper)
    assert (tool.number, tool.name, tool.force, tool.power, tool.closing) == (1, "T1", 60.0, 200.0, 0.15)
    assert (tool.pressure, tool.stiffness) == pytest.approx((6e5, 6e4))
    assert tool.openings == pytest.approx((5e-3, 60e-3)) and tool.forces == pytest.approx((10.0, 20.0))
    assert (tool.mode, tool.senses) == ("angular", True)
    assert tool.jaw is not None and tool.jaw.name == "vise.stl"
    assert tool.finger is not None and (tool.finger.width, tool.finger.friction) == pytest.approx((0.02, 0.5))
    assert tool.holder is not None and tool.true_length == pytest.approx(tool.length + 0.05)


@pytest.mark.parametrize(
    ("written", "kelvin"), [("25 degC", 298.15), ("25 °C", 298.15), ("300 K", 300.0), ("77 degF", 298.15)]
)
def test_keys_of_a_process_stand_among_those_of_its_tool(written: str, kelvin: float) -> None:
    tool = sound(f"{HEAD}{{type: test_spray_gun, flow: 0.3 cm^3/s, powder: 15 g/min, temperature: {written}}}\n").tools[
        1
    ]

    assert isinstance(tool, SprayGun)
    assert tool.spray.temperature == pytest.approx(kelvin, abs=1e-9)
    assert (tool.spray.flow, tool.spray.powder) == pytest.approx((3e-7, 0.015 / 60))
    assert tool.spray.cone == 0.25 * pi


@pytest.mark.parametrize(
    ("more", "code", "mark", "message", "hint"),
    [
        ("power: 200", "GS708", "200", "`power` is 200 without a unit; a power carries its unit", "`200 W`"),
        ("power: 200 N", "GS709", "200 N", "`power` is 200 N, a force; a power such as `3 kW` is expected", "W, kW"),
        ("pressure: 6 Bar", "GS709", "6 Bar", "`Bar` is no unit of a pressure", "did you mean `bar`?"),
        ("closing: soon", "GS707", "soon", "`closing` is `soon`; a time such as `6 s` is expected", "open to closed"),
        ("forces: [1 N, -2 N]", "GS710", "-2 N", "it must be greater than 0", "forces of the steps"),
        ("openings: [5 mm]", "GS706", "[5 mm]", "`openings` has 1 entry; a list of 2 lengths", "narrowest and widest"),
        ("openings: [5, 4 mm]", "GS720", "[5, 4 mm]", "impossible: `openings` must grow", "narrowest and widest"),
        ("mode: paralel", "GS711", "paralel", "`mode` cannot be `paralel`", "did you mean `parallel`?"),
        ("senses: yes", "GS706", "yes", "`senses` is `yes`", "`true` or `false`"),
        ("jaw: none.stl", "GS714", "none.stl", "a mesh of the jaw `none.stl` is not there", "relative to the cell"),
        (
            "finger: {friction: 1}",
            "GS705",
            "finger",
            "`finger` lacks `width`: a length such as `20 mm`",
            "width",
        ),
        ("finger: {width: 5, wide: 1}", "GS704", "wide", "`finger` has no key `wide`", "did you mean `width`?"),
        ("stroke: 3", "GS704", "stroke", "tool 1 (test_gripper) has no key `stroke`", "known are"),
    ],
)
def test_faults_have_place_and_remedy(more: str, code: str, mark: str, message: str, hint: str) -> None:
    text = gripper(f", {more}")
    result = loaded(text)

    [finding] = result.findings
    assert finding.code == code, told(result)
    line = text.splitlines()[2]
    assert (finding.span.line, line[finding.span.column - 1 : finding.span.end_column - 1]) == (3, mark), told(result)
    assert message in finding.message and hint in finding.hint, told(result)
    assert result.cell is None


def test_a_required_key_is_asked_for() -> None:
    [finding] = loaded(f"{HEAD}{{type: test_gripper}}\n").findings

    assert finding.code == "GS705" and finding.hint == "greatest force of the fingers"
    assert finding.message == "tool 1 (test_gripper) lacks `force`: a force such as `60 N`"


def test_no_temperature_goes_without_its_unit() -> None:
    [finding] = loaded(f"{HEAD}{{type: test_spray_gun, flow: 1 mm^3/s, temperature: 0}}\n").findings
    [cold] = loaded(f"{HEAD}{{type: test_spray_gun, flow: 1 mm^3/s, temperature: -120 degC}}\n").findings

    assert finding.code == "GS708" and "degC, K, degF" in finding.hint
    assert cold.code == "GS710" and cold.message == "`temperature` is -120 degC; it must be at least -100 degC"


def test_the_cell_is_shown_with_units_and_defaults() -> None:
    cell = sound(gripper(", finger: {width: 20 mm}") + "  2: {type: test_spray_gun, flow: 300 mm^3/s, length: 80}\n")
    text = cell_as_text(cell)

    for line in (
        "    force: 60 N",
        "    pressure: 0.6 N/mm^2  # default",
        "    closing: 0.2 s  # default",
        "    stiffness: 60 N/mm  # default: the force at 1 mm",
        "    openings: [0 mm, 40 mm]  # default",
        "    mode: parallel  # default",
        "    senses: false  # default",
        "      width: 20 mm",
        "      friction: 0.5  # default",
        "    flow: 300 mm^3/s",
        "    temperature: 20 degC  # default",
    ):
        assert line in text.splitlines(), text
    assert cell_as_json(sound(text))["cell"]["tools"] == cell_as_json(cell)["cell"]["tools"]


def test_json_has_units_in_its_names() -> None:
    shown = cell_as_json(sound(f"{HEAD}{{type: test_spray_gun, flow: 300 mm^3/s, temperature: 300 K}}\n"))

    tool: dict[str, Any] = shown["cell"]["tools"]["1"]
    assert (tool["flow_mm3_s"], tool["temperature_degC"]) == (300.0, 26.85)
    assert json.dumps(shown, allow_nan=False)


def test_the_schema_knows_every_key() -> None:
    schema = cell_schema()
    Draft202012Validator.check_schema(schema)
    validator = Draft202012Validator(schema)

    def valid(**tool: object) -> bool:
        return validator.is_valid({"machine": "gantry_xyz", "tools": {"1": {"type": "test_gripper", **tool}}})

    described = schema["$defs"]["test_gripper"]
    assert list(described["properties"]) == ["type", *all_keys(Gripper)]
    assert all("description" in entry for name, entry in described["properties"].items() if name != "type")
    assert described["required"] == ["type", "force"]
    assert valid(force="60 N", openings=[5, "60 mm"], mode="angular", finger={"width": 20})
    assert not valid(force=60) and not valid() and not valid(force="60 N", finger={}) and not valid(force="1 N", x=1)


def test_a_class_of_another_package_has_a_definition_of_its_own() -> None:
    """It may be called like one of ours."""
    assert {"Holder", "tests.Finger"} <= cell_schema()["$defs"].keys()


def test_the_docs_have_a_table() -> None:
    text = tool_reference(["test_gripper", "test_spray_gun"])

    assert "| `force` (required) | a force such as `60 N` | greatest force of the fingers |" in text
    assert "| `stiffness` | a stiffness such as `1e5 N/mm` | of the fingers (default: the force at 1 mm) |" in text
    assert "| `temperature` | a temperature such as `200 degC` | of what leaves the nozzle (default: 20 degC) |" in text
