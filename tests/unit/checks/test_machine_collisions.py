"""What links, tools and carried fixtures of a machine hit along whole programs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from gcodesim.cell.loader import read_cell
from gcodesim.checks.machine_bodies import MachineBodies
from gcodesim.checks.plan_way import SLACK, PlanWay
from gcodesim.diagnostics import Diagnostic, SourceText
from gcodesim.jobs.job import Job
from gcodesim.simulation import prepare

ARM = """gcodesim: 1
robots: {arm: {model: kuka_kr10_r1100_2, home: [0, -90, 90, 0, 90, 0]}}
work_offsets: {G54: {in: world, xyz: [600, 0, 300]}}
tools: {1: {type: flat_end_mill, diameter: 6, length: 60}}
simulation: {world: kinematic}
"""
MILL = """gcodesim: 1
machine:
  axes:
    X: {travel: [0, 500 mm], speed: 20 m/min, acceleration: 2 m/s^2}
    Y: {travel: [0, 400 mm], speed: 20 m/min, acceleration: 2 m/s^2}
    Z: {travel: [-350, 0 mm], speed: 12 m/min, acceleration: 1.5 m/s^2}
work_offsets: {G54: {xyz: [200, 200, -300]}}
tools: {1: {type: flat_end_mill, diameter: 6, length: 60}}
simulation: {world: kinematic}
"""
HEAD = "G21 G90 G94\nT1 M6\nG43 H1\n"


def prepared(program: str, cell: str) -> Job:
    loaded = read_cell(SourceText("cell.yaml", cell.encode()), Path("cell.yaml"))
    return prepare(SourceText("program.nc", program.encode()), loaded)


def hits(program: str, cell: str) -> list[Diagnostic]:
    return [found for found in prepared(program, cell).findings if found.code.startswith(("GS3", "GS930"))]


def test_nodes_are_so_close_that_bodies_stay_near_the_chords() -> None:
    """Between its nodes an arm follows straight lines and arcs of the tip, which bend its joints."""
    job = prepared(HEAD + "G0 X-50 Y0 Z50\nG1 X100 Y120 F3000\nG2 X150 Y120 I25 J0\nG1 Z0\nM2\n", ARM)
    assert job.plan is not None and job.shop is not None
    machine = MachineBodies.of(job.shop.scene, "arm")
    reach = machine.greatest_reach(job.shop.cell.tools.values(), np.zeros(6))
    way = PlanWay.of(job.plan, reach)
    assert ((way.way.bend @ reach) < 2.0 * SLACK).all()
    times = np.linspace(0.0, job.plan.trajectory.duration, 1500)
    q = job.plan.joints(job.plan.trajectory.sample(times))
    begin, step = way.way.q[:-1], np.diff(way.way.q, axis=0)
    for joints in q:
        square = np.maximum((step * step).sum(axis=1), 1e-30)
        share = np.clip(((joints - begin) * step).sum(axis=1) / square, 0.0, 1.0)
        off = np.abs(joints - begin - share[:, None] * step) @ reach
        assert off.min() < SLACK


def test_a_time_is_that_of_the_place() -> None:
    job = prepared(HEAD + "G0 X-50 Y0 Z50\nG1 X100 Y120 F3000\nM2\n", ARM)
    assert job.plan is not None
    way = PlanWay.of(job.plan, np.ones(6))
    for stretch in range(0, len(way.piece), 7):
        time = way.time(stretch, 0.5)
        q = job.plan.joints(job.plan.trajectory.sample(np.array([time])))[0]
        assert q == pytest.approx(way.way.at(stretch, 0.5), abs=2e-4)


def test_an_elbow_that_goes_through_a_post_is_found() -> None:
    """The tool is free: it ends 200 mm in front of the post."""
    post = "fixtures: {post: {box: [40, 40, 900], in: world, xyz: [280, 150, 0]}}\n"
    program = HEAD + "G0 X0 Y0 Z50\nG0 Y250\nM2\n"
    found = hits(program, ARM + post)
    assert {(hit.code, hit.bodies[1], hit.span.line) for hit in found} == {("GS305", "post", 5)}
    assert all(hit.value is not None and hit.value > 1.0 and hit.time is not None for hit in found)
    assert hits(program, ARM + post.replace("150, 0]", "-250, 0]")) == []


def test_a_link_that_passes_by_a_hair_is_free_and_one_that_does_not_is_not() -> None:
    """Under the flange at rest: its disc of 42 mm radius ends at Z 60 of the work while the tip is at 0."""
    plate = "fixtures: {{plate: {{box: [10, 10, 5], in: world, xyz: [630, 0, {}]}}}}\n"
    program = HEAD + "G0 X0 Y0 Z50\nZ0\nM2\n"
    free, hit = (hits(program, ARM + plate.format(355.0 + off)) for off in (-0.01, 0.01))
    assert free == []
    assert [found.code for found in hit] == ["GS305"]
    assert hit[0].value == pytest.approx(0.01, abs=1e-3)


def test_a_spindle_head_of_a_machine_is_a_fixture_on_its_flange() -> None:
    """A head of 160 mm around the nose, beside a vise that the tool passes with room."""
    head = "  head: {box: [160, 160, 100], zero: top-center, in: machine/flange}\n"
    vise = "fixtures:\n  vise: {box: [60, 60, 80], in: world, xyz: [250, 170, -320]}\n"
    program = HEAD + "G0 X0 Y0 Z80\nG0 Z-10\nM2\n"
    assert hits(program, MILL + vise) == []
    found = hits(program, MILL + vise + head)
    assert [(hit.code, hit.span.line, set(hit.bodies)) for hit in found] == [("GS305", 5, {"head", "vise"})]
    assert found[0].value == pytest.approx(10.0, abs=1e-3)  # the nose at -300 - 10 + 60, the vise up to -240


def test_bodies_that_overlap_from_the_start_are_named_and_left_out() -> None:
    cell = ARM.replace("[0, -90, 90, 0, 90, 0]", "[0, -120, 155, 0, 55, 0]").replace("[600, 0, 300]", "[0, 0, 0]")
    found = hits("G21 G91 G94\nG0 X100 Z-100\nM2\n", cell)
    assert [(hit.code, hit.bodies) for hit in found] == [("GS930", ("arm/link_2", "arm/link_4"))]


@pytest.mark.parametrize("height", [5.0, 1.5, 0.5])
def test_a_near_miss_has_its_least_distance(height: float) -> None:
    """The cutter passes over a clamp; a collision is no near miss."""
    clamp = "fixtures: {clamp: {box: [20, 20, 40], in: world, xyz: [250, 190, -300]}}\nlimits: {clearance: 2 mm}\n"
    found = hits(HEAD + f"G0 X0 Y0 Z{40 + height}\nG0 X100\nM2\n", MILL + clamp)
    if height > 2.0:
        assert found == []
    else:
        (miss,) = found
        assert (miss.code, miss.span.line, miss.limit) == ("GS308", 5, 2.0)
        assert miss.value == pytest.approx(height, abs=1e-3)


def test_a_collision_is_no_near_miss() -> None:
    clamp = "fixtures: {clamp: {box: [20, 20, 40], in: world, xyz: [250, 190, -300]}}\nlimits: {clearance: 2 mm}\n"
    found = hits(HEAD + "G0 X0 Y0 Z35\nG0 X100\nM2\n", MILL + clamp)
    assert [hit.code for hit in found] == ["GS301"]
