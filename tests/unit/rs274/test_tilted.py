"""G68.2 and G53.1: planes by five forms, arcs in them, and the turn of the machine into them."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest

from gcodesim.cell import load_cell
from gcodesim.cell.loader import read_cell
from gcodesim.diagnostics import SourceText
from gcodesim.jobs.job import Options
from gcodesim.simulation import prepare

from .test_tool_point import trunnion

DATA = Path(__file__).parents[2] / "data" / "five_axis"
CELL = """gcodesim: 1
dialect: fanuc
path_control: G61.1
machine:
  axes:
    X: {travel: [-900, 900], speed: 60 m/min}
    Y: {travel: [-900, 900], speed: 60 m/min}
    Z: {travel: [-900, 900], speed: 60 m/min}
    A: {travel: [-120, 120 deg], speed: 90 deg/s, at: [0, 0, -20]}
    C: {travel: unlimited, speed: 90 deg/s, at: [0, 0, 0]}
work_offsets: {G54: {xyz: [0, 0, 0]}}
tools:
  1: {type: flat_end_mill, diameter: 6, length: 60}
"""


@pytest.fixture
def fanuc(program):
    return lambda *lines, **settings: program("%\nO0001\n" + "\n".join(lines) + "\n%\n", dialect="fanuc", **settings)


def test_joints_of_tilted_pockets_are_those_of_linuxcnc(tmp_path):
    """Every block on the three inclined planes, to the decimals of the file."""
    (tmp_path / "cell.yaml").write_text(CELL)
    job = prepare(SourceText.read(DATA / "tilted_pockets.g68.nc"), load_cell(tmp_path / "cell.yaml"), Options())
    plan, rows = job.plan, list(csv.DictReader((DATA / "tilted_pockets.csv").open()))
    assert plan is not None
    path, trajectory = plan.path, plan.trajectory
    q = plan.joints(trajectory.sample(trajectory.row_end - 1e-9))
    found = {path.span(row).line: q[row] for row in range(len(path))}

    seen = 0
    for row in rows:
        if float(row["ac_a"]) == 0.0:
            continue  # C is free there, and stays
        at = found[int(row["line_g68"])]
        assert at[:3] * 1e3 - [0, 0, 60] == pytest.approx([float(row[f"ac_{k}"]) for k in "xyz"], abs=1e-5)
        assert np.degrees(at[3:]) == pytest.approx([float(row["ac_a"]), float(row["ac_c"])], abs=1e-6)
        seen += 1
    assert seen == 30


S = 0.5**0.5


@pytest.mark.parametrize(
    ("lines", "axes"),
    [
        (("G68.2 X1. Y2. Z3. I90. J90. K0.",), [[0, 1, 0], [0, 0, 1], [1, 0, 0]]),
        (("G68.2 X1. Y2. Z3. I0. J0. K90.",), [[0, 1, 0], [-1, 0, 0], [0, 0, 1]]),
        (("G68.2 P1 Q123 X1. Y2. Z3. I90. J0. K90.",), [[0, 1, 0], [0, 0, 1], [1, 0, 0]]),
        (("G68.2 P1 Q321 X1. Y2. Z3. I90. J0. K90.",), [[0, 0, 1], [-1, 0, 0], [0, -1, 0]]),
        (
            ("G68.2 P2 Q1 X1. Y2. Z3.", "G68.2 P2 Q2 X1. Y2. Z9.", "G68.2 P2 Q3 X5. Y2. Z7."),
            [[0, 0, 1], [1, 0, 0], [0, 1, 0]],
        ),
        (("G68.2 P3 Q1 X1. Y2. Z3. I0. J1. K0.", "G68.2 P3 Q2 I1. J0. K1."), [[0, 1, 0], [-S, 0, S], [S, 0, S]]),
        (("G68.2 P4 X1. Y2. Z3. I0. J45. K0.",), [[1, 0, 0], [0, S, S], [0, -S, S]]),
    ],
)
def test_each_form_gives_its_plane(fanuc, lines, axes):
    moves = ("G00 X0. Y0. Z0.", "G00 X1. Y0. Z0.", "G00 X0. Y1. Z0.", "G00 X0. Y0. Z1.")
    done = fanuc(*lines, *moves, "G69", "G00 X0. Y0. Z0.", "M30")

    assert not done.errors
    zero, *ends, after = [np.array(end[:3]) for end in done.ends]
    assert zero == pytest.approx([1, 2, 3]) and after == pytest.approx([0, 0, 0])
    np.testing.assert_allclose([end - zero for end in ends], axes, atol=1e-9)


def test_points_may_shift_and_turn_the_plane(fanuc):
    points = ("G68.2 P2 Q0 X1. Y0. Z2. R90.", "G68.2 P2 Q1 X0. Y0. Z0.", "G68.2 P2 Q2 X1. Y0. Z0.")
    done = fanuc(*points, "G68.2 P2 Q3 X0. Y1. Z0.", "G00 X3. Y0. Z0.", "M30")

    assert done.ends[0][:3] == pytest.approx([1, 3, 2])


def test_arcs_lie_in_the_plane(fanuc):
    done = fanuc("G68.2 X0. Y0. Z10. I0. J90. K0.", "G00 X5. Y0. Z0.", "G03 X0. Y5. I-5. F100.", "M30")

    arc = done.acts("arc")[0]
    assert arc["end"][:3] == pytest.approx([0, 0, 15], abs=1e-9)
    assert arc["center"] == pytest.approx([0, 0, 10], abs=1e-9)
    assert arc["normal"] == pytest.approx([0, -1, 0], abs=1e-9) and arc["ccw"]


@pytest.mark.parametrize(("choice", "turned"), [("", [35, 90]), ("P1", [35, 90]), ("P2", [-35, -90])])
def test_the_machine_turns_by_the_shorter_way_or_as_told(fanuc, choice, turned):
    lines = ("G68.2 X14. Y0. Z-8. I90. J35. K0.", f"G53.1 {choice}", "G01 X0. Y0. Z0. F100.", "G69", "M30")
    done = fanuc("T1 M06", "G43 H1", *lines, has_cell=True, tool_point=trunnion())

    rapid, line = done.acts("rapid")[0]["end"], done.acts("line")[0]["end"]
    assert not done.errors
    assert [rapid[3], rapid[5]] == pytest.approx(turned) and rapid[:3] == pytest.approx([0, 0, -50])
    assert line[:3] == pytest.approx([14, 0, -8])


@pytest.mark.parametrize(
    ("lines", "code"),
    [
        (("G53.1",), "GS105"),
        (("G68.2 P5 I1.",), "GS106"),
        (("G68.2 P1 Q122 I1.",), "GS106"),
        (("G68.2 P2 Q1 X0. Y0. Z0.", "G68.2 P2 Q3 X1. Y0. Z0."), "GS105"),
        (("G68.2 P3 Q1 I1. J0. K0.", "G68.2 P3 Q2 I1. J0. K0."), "GS106"),
        (("G68 X0. Y0. R30.", "G68.2 I10. J0. K0."), "GS106"),
        (("G68.2 I10. J5. K0.", "G68 X0. Y0. R30."), "GS106"),
        (("G68.2 I10. J170. K0.", "G53.1 P3"), "GS106"),
    ],
)
def test_what_gives_no_plane_is_said(fanuc, lines, code):
    done = fanuc(*lines, "M30")

    assert [(finding.code, finding.span.line) for finding in done.errors] == [(code, 2 + len(lines))]


def test_a_machine_that_cannot_turn_so_far_says_so(fanuc):
    """A table A C of travel to 120 degrees; a machine whose axes have no place is told apart."""
    from gcodesim.cell.tool_point import MachinePoint
    from gcodesim.kinematics.cartesian import Axis, Cartesian, chain_of_axes
    from gcodesim.kinematics.tool_point import ToolPoint

    a = Axis(letter="A", point=(0.0, 0.0, 0.0), lower=-0.1, upper=0.1)
    axes = [*(Axis(letter=letter) for letter in "XYZ"), a, Axis(letter="C", point=(0.0, 0.0, 0.0))]
    tool = ToolPoint.of(Cartesian(chain=chain_of_axes(axes)))
    assert tool is not None
    lines = ("G68.2 I90. J35. K0.", "G53.1", "M30")

    assert [f.code for f in fanuc(*lines, has_cell=True, tool_point=MachinePoint(tool)).errors] == ["GS106"]
    assert [f.code for f in fanuc(*lines, has_cell=True).errors] == ["GS915"]


LENGTH = ("G21 G90 G40 G80 G94 G17", "T1 M6", "S5000 M3", "G68.2 X0 Y0 Z0 I90. J30. K0.", "G53.1")


@pytest.mark.parametrize(
    ("moves", "found"),
    [
        (("G0 X-20. Y-20.", "G43 Z50. H1", "G1 Z2. F300."), []),  # sideways to the tool, as in G17
        (("G0 X-20. Y-20.", "Z50.", "G43 H1", "G1 Z2. F300."), [("GS162", 9)]),
        (("G43 H1", "G0 Z50.", "G69", "G49", "T1 M6", "G0 X5. Y5."), []),  # the plane is over, Z is that of the machine
    ],
)
def test_a_tool_that_stands_on_a_plane_may_go_sideways_without_its_length(moves, found):
    text = "%\nO0001\n" + "\n".join((*LENGTH, *moves, "G49", "G69", "M5", "M30")) + "\n%\n"
    cell = SourceText("cell.yaml", CELL.encode())
    job = prepare(SourceText("part.nc", text.encode()), read_cell(cell, Path("cell.yaml")), Options())
    assert [(f.code, f.span.line) for f in job.findings if f.code == "GS162"] == found
