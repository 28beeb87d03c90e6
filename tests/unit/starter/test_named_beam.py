"""`init --from` for lasers, plasma torches and water jets: what programs of their makers say gives a cell that cuts."""

import math
from pathlib import Path

import pytest

from gcodesim.cell.loader import read_cell
from gcodesim.diagnostics import Severity, SourceText
from gcodesim.simulation import Options, prepare, run
from gcodesim.starter.first_cell import cell_for

LASER = """;Inkscape Lasertools G-code
G90
G21
M03 S1
G00 X8 Y7 F3000
S90
G01 Y27 F120
S1
G00 X9 Y30 F3000
S90
G01 X29 F120
M05 S0
"""
LIGHTBURN = """; LightBurn 1.4.03
; GRBL device profile, absolute coords
; Bounds: X20 Y30 to X40 Y50
G00 G17 G40 G21 G54
G90
M4
; Cut @ 5 mm/sec, 80% power
M8
G0 X20Y30
; Layer C00
G1 X40S800F300
G1 Y50
G1 X20
G1 Y30
M9
G1 S0
M5
G90
; return to user-defined finish pos
G0 X0 Y0
M2
"""
PLASMA = """(Generated with: DXF2GCODE)
G21 (Units in millimeters)
G90 (Absolute programming)
S11
G0 X 32.351 Y  32.351
M3 (plasma on)
G4 P0.5 (pause to pierce)
F450
G2 X  14.249 Y  14.249 I  -9.051 J  -9.051
G2 X  32.351 Y  32.351 I   9.051 J   9.051
M5 (plasma off)
M2
"""
JET = """(WAZER waterjet)
G21 G90
G0 X10 Y10
M3 S1
G4 P1
G1 X40 F60
G1 Y30
M5
M30
"""
RASTER = """G90
M4 S0
G0X5Y5F1000
G1X5.2S0
X15S500
X25S1000
X25.2S0
G0Y6
G1X15S1000
X5S500
M5 S0
"""
PEN_OR_LASER = """G90
G21
G1 X10 Y10 F1000
M3 S255
G1 X30 Y10 F600
M5
G1 X0 Y0 F1000
M2
"""
SHEETCAM = """(Filename: ring.tap)
(Post processor: Mach3 plasma.scpost)
G21 G90 G40
(Process: Outside Offset, 0, T1: 45A Hypertherm, 1.5mm kerf)
M06 T3  (45A Hypertherm, 1.5mm kerf)
G00 X5.0000 Y10.0000
G00 Z1.5
M03
G04 P0.5
F1500.0
G01 X10.0000 Y10.0000
G03 X40.0 Y10.0 I15.0 J0.0
G03 X10.0 Y10.0 I-15.0 J0.0
M05
G00 Z10.0
M30
"""
# S words here tell a height control its settings; the comment beside the change says what T1 is
HEIGHT_CONTROL = (
    SHEETCAM.replace("G21 G90 G40\n", "G21\nG90 G91.1 G40\nF1\nS500\n")
    .replace("(Process: Outside Offset, 0, T1: 45A Hypertherm, 1.5mm kerf)", "(Operation: Outside Offset, T1: Plasma)")
    .replace("M06 T3  (45A Hypertherm, 1.5mm kerf)", "M06 T1 F1500.0  (Plasma)")
)


@pytest.mark.parametrize(
    ("text", "kind", "dialect", "least"),
    [
        (LASER, "laser", "grbl", 20.0),
        (LIGHTBURN, "laser", "grbl", 40.0),
        (PLASMA, "plasma", "linuxcnc", 0.9 * 1.5 * 3.0 * math.pi * 25.6),
        (JET, "jet", "linuxcnc", 0.9 * 1.0 * 3.0 * 50.0),
        (RASTER, "laser", "grbl", 7.2),  # 40 mm at 750 of 1000 and 1000 mm/min: 18.06 J, of which 0.8 count, 2 J/mm³
        (PEN_OR_LASER, "laser", "linuxcnc", 7.9),  # 20 mm at 600 mm/min: 20 J
        (SHEETCAM, "plasma", "linuxcnc", 0.9 * 1.5 * 3.0 * (5.0 + math.pi * 30.0)),
        (HEIGHT_CONTROL, "plasma", "linuxcnc", 0.9 * 1.5 * 3.0 * (5.0 + math.pi * 30.0)),
    ],
    ids=["inkscape", "lightburn", "plasma", "jet", "raster", "no comment", "sheetcam", "height control"],
)
def test_a_beam_takes_what_it_goes_over(text: str, kind: str, dialect: str, least: float) -> None:
    """Torch and jet go through the sheet of 3 mm: kerf times length; `least` in mm³."""
    program = SourceText("part.nc", text.encode())
    loaded = read_cell(SourceText("cell.yaml", cell_for(program)), Path("cell.yaml"))
    assert loaded.cell is not None, [f.message for f in loaded.findings]
    (tool,) = loaded.cell.tools.values()
    assert (tool.kind, loaded.cell.channels["main"].dialect) == (kind, dialect)

    results, _ = run(prepare(program, loaded, Options(world="kinematic")), None)

    assert [f.code for f in results.findings if f.level > Severity.NOTE] == []
    (stock,) = results.stocks.values()
    assert least < 1e9 * stock.removed < 1.5 * least
    assert results.tools[0]["beam_s"] > 0.0


def test_a_mill_that_only_speaks_of_a_laser_stays_a_mill() -> None:
    text = "(engrave by laser later)\nG21 G90\nT1 M6\nG43 H1\nS8000 M3\nG0 X0 Y0 Z5\nG1 Z-2 F200\nG1 X40\nG0 Z5\nM2\n"
    loaded = read_cell(SourceText("c.yaml", cell_for(SourceText("p.nc", text.encode()))), Path("c.yaml"))

    assert loaded.cell is not None
    assert loaded.cell.tools[1].kind == "flat_end_mill"
