"""What motors bear besides weight and inertia: the force of the work, loads at the tip, friction and rotors."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from gcodesim.arithmetic.matrices import applied
from gcodesim.cell.loader import read_cell
from gcodesim.diagnostics import Diagnostic, SourceText
from gcodesim.jobs.job import Job
from gcodesim.planning.arm_kernels import SegmentRates
from gcodesim.planning.loads import Loads, Motors
from gcodesim.planning.shop_posing import loads_of
from gcodesim.simulation import prepare, run

CELL = """gcodesim: 1
robots: {arm: {model: kuka_kr10_r1100_2CONTROL}}
work_offsets: {G54: {in: world, xyz: [700, 0, 300]}}
tools: {1: {type: flat_end_mill, diameter: 8, flutes: 2, length: 60TOOL}}
"""
PROGRAM = "G21 G90 G94 G61\nT1 M6\nG43 H1\nG0 X0 Y0 Z0\nG1 X60 F12000\nY40\nX0 Y0\nM2\n"


def job_of(*, tool: str = "", control: str = "", program: str = PROGRAM) -> Job:
    cell = CELL.replace("TOOL", tool).replace("CONTROL", control)
    return prepare(SourceText("a.nc", program.encode()), read_cell(SourceText("c.yaml", cell.encode()), Path("c.yaml")))


def loads(job: Job) -> Loads:
    assert job.shop is not None
    return loads_of(job.shop)


def postures(job: Job, count: int) -> np.ndarray:
    assert job.shop is not None
    return job.shop.home + np.random.default_rng(5).uniform(-0.5, 0.5, (count, 6))


def test_a_force_of_any_direction_is_that_of_the_worst_one() -> None:
    """Joint i bears F . J_i, so at most |F| |J_i|, with J_i the velocity of the tip for a unit of its speed."""
    job = job_of(tool=", expected_force: 100 N")
    q, still = postures(job, 1), np.zeros((1, 6))
    reserve = loads(job).reserve(np.array([1]), q, still, np.array([True]))
    assert job.plan is not None
    X_FT, step = job.plan.tool_frames[1], 1e-6

    def tip(at: np.ndarray) -> np.ndarray:
        X = job.plan.kinematics.forward(at)  # type: ignore[union-attr]
        return applied(X[:, :3, :3], X_FT.p) + X[:, :3, 3]

    for i in range(6):
        turn = step * np.eye(6)[i]
        column = (tip(q + turn) - tip(q - turn))[0] / (2 * step)
        assert reserve[0, i] == pytest.approx(100.0 * np.linalg.norm(column), abs=1e-4)
    assert not loads(job).reserve(np.array([1]), q, still, np.array([False])).any()
    assert not loads(job).reserve(np.array([0]), q, still, np.array([True])).any()


def test_a_load_in_axes_of_the_tool_turns_with_it() -> None:
    """The motors bear -F . J_i besides; of a tool that hangs straight, the tool's Z is that of the flange."""
    world, tool = (job_of(tool=f", load: {{force: [0, 0, 50 N], frame: {frame}}}") for frame in ("world", "tool"))
    q, step = postures(world, 3), 1e-6
    none, here = loads(job_of()), (np.ones(3, dtype=np.int64), q, (0.0, 0.0))
    assert world.plan is not None
    forward, X_FT = world.plan.kinematics.forward, world.plan.tool_frames[1]
    for job, axis in ((world, np.tile([0.0, 0.0, 1.0], (3, 1))), (tool, forward(q)[:, :3, 2])):
        more = loads(job).efforts(*here)[0] - none.efforts(*here)[0]
        for i in range(6):
            ends = [forward(q + side * step * np.eye(6)[i]) for side in (1.0, -1.0)]
            tips = [applied(X[:, :3, :3], X_FT.p) + X[:, :3, 3] for X in ends]
            column = (tips[0] - tips[1]) / (2 * step)
            assert more[:, i] == pytest.approx(-50.0 * (column * axis).sum(axis=1), abs=1e-4)


def test_timing_leaves_room_for_the_work_where_it_feeds() -> None:
    heavy = ", payload: {mass: 8 kg}"
    free, bound = job_of(control=heavy), job_of(control=heavy, tool=", expected_force: 100 N")
    assert free.plan is not None and bound.plan is not None
    (note,) = (finding for finding in bound.findings if finding.code == "GS231")

    assert bound.plan.trajectory.duration > free.plan.trajectory.duration
    assert "for friction and the force of the work" in note.message
    rapids = np.isinf(bound.plan.path.feed)
    assert bound.plan.trajectory.row_time[rapids] == pytest.approx(free.plan.trajectory.row_time[rapids])


def test_more_force_of_the_work_never_makes_a_motion_quicker() -> None:
    """Beyond what motors bear at rest, too: there it was dropped, and the arm went at full speed again."""
    heavy, times = ", payload: {mass: 8 kg}", []
    for force in (50, 200, 400, 700, 1500):
        plan = job_of(control=heavy, tool=f", expected_force: {force} N").plan
        assert plan is not None
        times.append(plan.trajectory.duration)

    assert times == sorted(times)
    assert times[-1] > 1.5 * times[0]


def test_a_force_that_no_slowness_helps_against_is_told() -> None:
    notes = [finding for finding in job_of(tool=", expected_force: 900 N").findings if finding.code == "GS231"]

    assert any("from the worst side" in note.message and note.value > note.limit for note in notes)  # type: ignore[operator]


def test_the_lightest_payload_that_slows_needs_just_more_than_a_motor_gives() -> None:
    def notes(mass: float) -> list[Diagnostic]:
        job = job_of(control=f", payload: {{mass: {mass} kg}}")
        return [finding for finding in job.findings if finding.code == "GS231"]

    none, some = 0.0, 40.0
    for _ in range(8):
        middle = 0.5 * (none + some)
        none, some = (none, middle) if notes(middle) else (middle, some)
    (note,) = notes(some)
    assert note.value is not None and note.limit is not None
    assert 0.0 < note.value - note.limit < 0.02 * note.limit


STRETCHED = ", home: [0, -10, 20, 0, 0, 0]"


def heaviest(job: Job) -> tuple[float, int]:
    """The payload [kg] at the flange that motors bear at home with the tool, and the joint whose motor bears no more.

    Weight at the flange asks a joint for its mass times g times how fast the flange rises with the joint.
    """
    assert job.shop is not None
    home, joints, step = job.shop.home, job.shop.kinematics.joints, 1e-6
    (own,) = loads(job).efforts(np.array([1]), home[None], (0.0, 0.0))
    ends = [job.shop.kinematics.forward(home + side * step * np.eye(6))[:, 2, 3] for side in (1.0, -1.0)]
    each = 9.80665 * (ends[0] - ends[1]) / (2.0 * step)
    most = (joints.effort - np.sign(each) * own[0]) / np.maximum(np.abs(each), 1e-9)
    return float(most.min()), int(most.argmin())


def test_a_home_pose_that_a_motor_cannot_bear_is_told_before_anything_moves() -> None:
    mass, joint = heaviest(job_of(control=STRETCHED))
    for share in (0.99999, 1.00001):
        job = job_of(control=f"{STRETCHED}, payload: {{mass: {share * mass!r} kg}}")
        told = [finding for finding in job.findings if finding.code == "GS230"]
        assert len(told) == (share > 1.0)
    assert job.shop is not None
    (finding,) = told
    name = job.shop.kinematics.joints.names[joint]
    assert finding.message.startswith(f"{name} cannot bear its weight") and finding.time == pytest.approx(0.0, abs=1e-9)
    assert finding.value == pytest.approx(finding.limit, rel=1e-4) and finding.value > finding.limit  # type: ignore[operator]


def test_a_run_tells_of_that_weight_once() -> None:
    mass, joint = heaviest(job_of(control=STRETCHED))
    job = job_of(control=f"{STRETCHED}, payload: {{mass: {1.1 * mass} kg}}")
    before = [finding for finding in job.findings if finding.code == "GS230"]
    run(job)
    after = [finding for finding in job.findings if finding.code == "GS230"]
    assert job.shop is not None
    name = job.shop.kinematics.joints.names[joint]
    for found in (before, after):
        assert len([finding for finding in found if f"{name} " in finding.message]) == 1
    assert all("is at its limit" in finding.message for finding in after)


def test_friction_and_rotors_of_a_controller_count() -> None:
    friction = ", controller: {type: computed_torque, friction: [90 N·m], rotor_inertia: [5 kg·m^2]}"
    free, bound = job_of(), job_of(control=friction)
    assert free.plan is not None and bound.plan is not None

    assert bound.plan.trajectory.duration > free.plan.trajectory.duration
    assert any(finding.code == "GS231" for finding in bound.findings)


def test_a_controller_of_an_arm_on_a_rail_has_values_for_its_own_joints() -> None:
    stiffness = "stiffness: [2e5, 2e5, 6e4, 2000, 2000, 500 N·m/rad]"
    rail = f", controller: {{type: pd, friction: [9, 9, 9, 2, 2, 1 N·m], {stiffness}}}"
    cell = CELL.replace("TOOL", "").replace("CONTROL", rail) + (
        "externals: {rail: {carries: arm, axes: {U: {travel: [-1, 1 m], speed: 1 m/s, acceleration: 2 m/s^2}}}}\n"
    )
    loaded = read_cell(SourceText("c.yaml", cell.encode()), Path("c.yaml"))
    job = prepare(SourceText("a.nc", PROGRAM.encode()), loaded)
    assert job.shop is not None, [finding.message for finding in job.findings]
    own = job.shop.mover.controller

    assert sorted(own.friction) == [0.0, 1.0, 2.0, 2.0, 9.0, 9.0, 9.0]
    assert own.friction[job.shop.kinematics.joints.names.index("rail/U")] == 0.0


@pytest.mark.parametrize(("driven", "here"), [(False, False), (True, False), (False, True), (True, True)])
def test_where_motors_surely_have_enough_nothing_is_slowed(driven: bool, here: bool) -> None:
    """Of motions from gentle to far too quick, those called ample need no slowing when they are worked out.

    By what motors bear anywhere, or `here`, where the arm stands.
    """
    job = job_of()
    own, q, random = loads(job), postures(job, 300), np.random.default_rng(3)
    if driven:
        own = replace(own, motors=Motors(coulomb=np.full(6, 0.5), viscous=np.full(6, 0.2), rotor=np.full(6, 0.02)))
    tool, size = np.ones(len(q), dtype=np.int64), np.linspace(0.0, 3.0, len(q))[:, None]
    qd, qdd = size * random.normal(size=q.shape), 8.0 * size * random.normal(size=q.shape)
    static, ahead, behind = own.efforts(tool, q, (0.0, 0.0), (qd, qdd), (qd, -qdd))
    rates, one = SegmentRates(qd, qd + qdd, qd + 0.5 * qdd), np.ones(len(q))
    anywhere = own.ample_anywhere(tool, rates, one, one, 0.0 * one, at_end=False)
    ample = own.ample(tool, static, qd, qdd) if here else anywhere
    feeds = np.ones(len(q), dtype=bool)
    slowing = own.slowing((tool, size[:, 0]), static, ahead, behind, reserve=own.reserve(tool, q, qd, feeds))
    assert 10 < ample.sum() < len(q)
    assert (slowing.share[ample] == 1.0).all() and (slowing.joint[ample] == -1).all()
    assert not slowing.overborne[ample].any()
    assert (slowing.share[~ample] < 1.0).any()


def test_what_pushes_on_a_tool_is_always_worked_out() -> None:
    own, still = loads(job_of(tool=", expected_force: 1 N")), np.zeros((2, 6))
    assert own.ample(np.array([0, 1]), still, still, still).tolist() == [True, False]
