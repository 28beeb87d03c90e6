"""What slicers say in comments that a print will take, in the words of each."""

from __future__ import annotations

import pytest

from gcodesim.diagnostics import SourceText
from gcodesim.rs274.marlin.estimate import estimate_in

SAID = {
    "PrusaSlicer": (
        "; filament used [mm] = 1200.50, 34.5\n; filament used [cm3] = 3.0\n; filament used [g] = 3.6\n"
        "; estimated printing time (normal mode) = 1d 2h 3m 4s\n"
        "; estimated printing time (silent mode) = 1d 3h 0m 0s\n",
        93784.0,
        1235.0,
    ),
    "OrcaSlicer": (
        "; HEADER_BLOCK_START\n; model printing time: 4m 54s; total estimated time: 10m 22s\n; HEADER_BLOCK_END\n"
        "G1 X1\n; filament used [mm] = 212.17\n; estimated printing time (normal mode) = 10m 22s\n",
        622.0,
        212.17,
    ),
    "BambuStudio": (
        "; model printing time: 13m 48s; total estimated time: 1h 20m 12s\n"
        "; total filament length [mm] : 391.43,245.25\n; total filament volume [cm^3] : 941.50,589.89\n",
        4812.0,
        636.68,
    ),
    "Cura": (";FLAVOR:Marlin\n;TIME:943\n;Filament used: 1.25m, 0.5m\n;LAYER:0\n;TIME_ELAPSED:12.5\n", 943.0, 1750.0),
    "CuraEngine alone": (
        ";TIME:6666\n;Filament used: 0m\n;LAYER:0\n;TIME_ELAPSED:12.5\n;LAYER:1\n;TIME_ELAPSED:25.25\n", 25.25, None,
    ),
    "Simplify3D": (
        "G1 X1\n; Build Summary\n;   Build time: 1 hours 43 minutes\n;   Filament length: 4062.2 mm (4.06 m)\n"
        ";   Plastic volume: 9770.6 mm^3 (9.77 cc)\n",
        6180.0,
        4062.2,
    ),
    "Simplify3D 5": ("; Build Time: 0 hour 9 minutes\n", 540.0, None),
    "ideaMaker": (
        ";Sliced by ideaMaker 4.2.3\n;Print Time: 1234\n;Material#1 Used: 1200.5\n;Material#2 Used: 4\n",
        1234.0,
        1204.5,
    ),
    "Kiri:Moto": ("; --- filament used: 4062.18 mm ---\n; --- print time: 4798s ---\n", 4798.0, 4062.18),
    "KISSlicer": (
        "; Estimated Build Time:   12.50 minutes\n; Ext 1 =  1234.50 mm  (2.969 cm^3)\n"
        "; Ext 2 =  10.00 mm  (0.024 cm^3)\n",
        750.0,
        1244.5,
    ),
    "IceSL": ("; estimated_print_time_s : 150\n; filament_used_mm : 1200\n", 150.0, 1200.0),
    "nobody": ("G1 X1 ; TIME:7\n; time = 3\n", None, None),
}  # fmt: skip


@pytest.mark.parametrize("ends", ["\n", "\r\n"])
@pytest.mark.parametrize("slicer", SAID)
def test_time_and_filament_are_read_as_the_slicer_writes_them(slicer: str, ends: str) -> None:
    text, time, filament = SAID[slicer]
    found = estimate_in(SourceText("p.gcode", text.replace("\n", ends).encode()))

    assert found.time == pytest.approx(time)
    assert found.filament == (None if filament is None else pytest.approx(filament * 1e-3))


def test_the_time_of_the_model_is_told_apart() -> None:
    text = "; model printing time: 14m 40s; total estimated time: 20m 23s\n"
    assert estimate_in(SourceText("p.gcode", text.encode())) == (1223.0, None, 880.0)
    assert estimate_in(SourceText("p.gcode", b"; total estimated time: 20m 23s\n")).model_time is None


def test_the_ends_of_a_long_program_are_enough() -> None:
    lines = "G1 X1 E0.1\n" * 40_000
    found = estimate_in(SourceText("p.gcode", f"; filament used [mm] = 7\n{lines};TIME:12\n".encode()))
    assert found == (12.0, 0.007, None)
