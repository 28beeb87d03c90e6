"""Pastes: how high they stand, and what they carry at their age."""

from __future__ import annotations

from math import sqrt
from pathlib import Path

import pytest

from gcodesim.cell.loader import read_cell
from gcodesim.diagnostics import SourceText
from gcodesim.tools.paste import KNOWN, Paste
from tests.physics.runs import Ran, run_texts

CELL = """
gcodesim: 1
machine:
  axes:
    X: {{travel: [-100, 1100], speed: 1 m/s, acceleration: 2 m/s^2}}
    Y: {{travel: [-100, 1100], speed: 1 m/s, acceleration: 2 m/s^2}}
    Z: {{travel: [-100, 1100], speed: 1 m/s, acceleration: 2 m/s^2}}
work_offsets: {{G54: {{xyz: [0, 0, 0]}}}}
stock: {{min: [-50, -50, -5], max: [450, 50, 0], in: G54, resolution: 20}}
tools:
  1: {{type: extruder, bead_width: 60, bead_height: {height}, length: 200, paste: {paste} {more}}}
m_codes: {{M10: {{tool: activate}}, M11: {{tool: deactivate}}}}
"""


def wall(paste: str, *, height: float = 20.0, layers: int = 10, rest: float = 0.0, more: str = "") -> Ran:
    body = "".join(f"G0 X0 Y0 Z{height * (k + 1)}\nM10\nG1 X400 F24000\nM11\nG4 P{rest}\n" for k in range(layers))
    return run_texts(f"G21 G90\nT1 M6\nG43 H1\n{body}M2\n", CELL.format(height=height, paste=paste, more=more))


def told(ran: Ran) -> list[tuple[str, float, float]]:
    return [(f.code, f.value or 0.0, f.limit or 0.0) for f in ran.results.findings if f.code in ("GS528", "GS529")]


def test_the_height_that_stands_is_that_of_von_mises() -> None:
    """3.05 kPa and 2070 kg/m³ (Wolfs, Bos and Salet 2018): sqrt(3) tau / (rho g) = 260.2 mm, and 4.95 mm a minute."""
    concrete = Paste(like="concrete")

    assert concrete.standing(0.0) == pytest.approx(sqrt(3.0) * 3050.0 / (2070.0 * 9.80665), rel=1e-12)
    assert concrete.standing(60.0) - concrete.standing(0.0) == pytest.approx(4.949e-3, rel=1e-3)
    assert Paste(like="concrete", yield_stress=6100.0).standing(0.0) == pytest.approx(2.0 * concrete.standing(0.0))
    assert all(paste.source for paste in KNOWN.values())


def test_a_wall_stands_up_to_what_its_foot_carries() -> None:
    """sqrt(3) 2 kPa / (2000 kg/m³ g) = 176.6 mm: nine layers of 20 mm are too many, eight are not."""
    paste = "{density: 2000 kg/m^3, yield_stress: 2 kPa}"

    assert told(wall(paste, layers=8)) == []
    ((code, value, limit),) = told(wall(paste, layers=10))
    assert (code, value) == ("GS529", pytest.approx(180.0)) and limit == pytest.approx(176.6, abs=0.05)


@pytest.mark.parametrize("more", ["", ", flow: 500 cm^3/s"])
def test_waiting_lets_the_foot_set(more: str) -> None:
    """60 Pa/min more: after ten minutes of rest it carries 53 mm more; nine layers with 80 s between them stand."""
    paste = "{density: 2000 kg/m^3, yield_stress: 2 kPa, structuration: 60 Pa/min}"

    assert [code for code, _, _ in told(wall(paste, more=more))] == ["GS529"]
    assert told(wall(paste, rest=80.0, more=more)) == []


def test_a_bead_that_is_too_high_slumps() -> None:
    ((code, value, limit),) = told(wall("{density: 2000 kg/m^3, yield_stress: 0.3 kPa}", height=40.0, layers=2))

    assert (code, value) == ("GS528", 40.0) and limit == pytest.approx(26.49, abs=0.01)


@pytest.mark.parametrize(
    ("paste", "told"),
    [("{density: 2000 kg/m^3}", "is like none"), ("{like: clay, density: 2000 kg/m^3}", "no data of clay")],
)
def test_a_paste_without_constants_is_told(paste: str, told: str) -> None:
    text = CELL.format(height=20, paste=paste, more="")

    loaded = read_cell(SourceText("cell.yaml", text.encode()), Path("cell.yaml"))

    ((code, message),) = [(f.code, f.message) for f in loaded.findings]
    assert code == "GS720" and "`yield_stress`" in message and told in message
