"""A printer whose bed nobody has placed is homed before its first move."""

from pathlib import Path

import pytest

from gcodesim.cell.loader import read_cell
from gcodesim.diagnostics import SourceText
from gcodesim.simulation import prepare, run

BED = "stock: {min: [-10, -10, -8], max: [110, 10, 0], resolution: 0.5}\n"
CELL = "gcodesim: 1\nmachine: gantry_xyz\ndialect: marlin\n" + BED
CELL += "tools: {0: {type: extruder, bead_width: 6, bead_height: 3, filament_diameter: 1.75}}\n"
CELL += "simulation: {world: kinematic}\n"
ONE = "M104 S210\nM83\nG1 X100 E100 F1200\n"


def results_of(program, cell=CELL):
    loaded = read_cell(SourceText("cell.yaml", cell.encode()), Path("cell.yaml"))
    job = prepare(SourceText("one.gcode", program.encode()), loaded)
    results, _ = run(job)
    return job, results


def test_a_bead_without_homing_lies_where_it_is_programmed():
    """The first scenario of a printing lab: 100 mm of filament for a bead that asks for far more."""
    _, results = results_of(ONE)

    assert results.stocks["stock"].deposited == pytest.approx(240.5e-9, rel=1e-3)
    codes = {finding.code for finding in results.findings}
    assert {"GS524", "GS921"} <= codes and "GS522" not in codes
    assert results.stocks["stock"].deposited == results_of("G28\n" + ONE)[1].stocks["stock"].deposited


@pytest.mark.parametrize("first", ["G1 X5 F1200", "G1 E5 F600\nG1 X5", "G53 G0 X5", "G28 X0\nG1 X5", "G28\nG1 X5"])
def test_the_way_begins_at_the_bed(first):
    job, _ = results_of(f"M83\n{first}\nG1 X50 F1200\n")
    path = job.plan.path

    assert path.start[-1][:3] - path.end[-1][:3] == pytest.approx([-0.045, 0.0, 0.0])


def test_a_print_may_be_as_high_as_the_machine_goes():
    """The bed that nobody has placed is nearly as low as the nozzle reaches."""
    program = "G28\nM83\nG1 Z-5 F1200\nG1 Z{} F1200\nG1 X50 F1200\n"
    high, _ = results_of(program.format(380))
    too_high, _ = results_of(program.format(395))

    assert "GS201" not in {finding.code for finding in high.findings}
    assert "GS201" in {finding.code for finding in too_high.findings}


def test_whoever_says_where_the_bed_is_says_where_the_head_begins():
    placed = CELL + "work_offsets: {G54: {xyz: [400, 300, -200]}}\n"
    job, _ = results_of("M83\nG1 X5 F1200\n", placed)

    assert len(job.plan.path) == 1 and job.plan.path.start[0][0] == 0.0
