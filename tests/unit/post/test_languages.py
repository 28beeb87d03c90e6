"""Robot programs read back by readers of our own: the same places, joints, ways and outputs as in the plan."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from gcodesim.cell.loader import read_cell
from gcodesim.diagnostics import SourceText
from gcodesim.jobs.job import Job, Options
from gcodesim.post import LANGUAGES
from gcodesim.post.from_plan import NotPostedError, Wish, program_of
from gcodesim.post.language import WrittenFiles
from gcodesim.post.meeting import MeetingLines
from gcodesim.simulation import prepare

from .readers import READERS, Read, Target

ROOT = Path(__file__).parents[3]
ARMS = {"krl": "kuka_kr10_r1100_2", "rapid": "abb_irb1200_5_90", "urscript": "ur10e", "fanuc-ls": "fanuc_m20ia"}
TABLE = (520.0, -35.0, 262.0)
HEIGHT = {"fanuc-ls": 525.0}  # of joint 2 of the M-20iA above the floor: where Fanuc's world frame is

CELL = """gcodesim: 1
robots: {{arm: {{model: {arm}, home: {home}}}}}
work_offsets: {{G54: {{in: world, xyz: [520, -35, 262], rpy: [0, 0, {turned}]}}}}
orientation: {{tool_axis: -Z of G54, spin: free}}
tools:
  1: {{type: flat_end_mill, diameter: 8, flutes: 2, length: 50}}
  2: {{type: flat_end_mill, diameter: 6, flutes: 2, length: 80}}
"""
HOMES = {
    "krl": "[0, -90, 90, 0, 90, 0]",
    "rapid": "[0, 0, 0, 0, 90, 0]",
    "urscript": "[0, -90, 90, -90, -90, 0]",
    "fanuc-ls": "[0, 0, 0, 0, -90, 0]",
}
# points of G54 where a line or an arc ends, by the line of the program
POINTS = {5: (0, 0, 10), 7: (0, 0, -1), 8: (40, 0, -1), 9: (40, 20, -1), 10: (20, 20, -1), 14: (20, 20, 30)}
PROGRAM = """G21 G90 G17 G94
{mode}
T1 M6 G43 H1
S6000 M3
G0 X0 Y0 Z10
M62 P1
G1 Z-1 F300
X40
G3 X40 Y20 I0 J10
G1 X20
G4 P0.25
M65 P1
M67 E2 Q0.5
G0 Z30
T2 M6
G43 H2
G0 X5
M2
"""


@cache
def job(kind: str, mode: str = "G61.1", turned: float = 0.0) -> Job:
    text = CELL.format(arm=ARMS[kind], home=HOMES[kind], turned=turned)
    return prepare(
        SourceText("part.nc", PROGRAM.format(mode=mode).encode()),
        read_cell(SourceText("arm.yaml", text.encode()), Path("arm.yaml")),
    )


def written(of: Job, kind: str, **wish: object) -> WrittenFiles:
    language = LANGUAGES[kind]()
    return language.write(program_of(of, language, Wish(**wish))[0])


def read(kind: str, files: Mapping[str, str], name: str = "part") -> list[Read]:
    return READERS[kind](files, name.upper() if kind == "fanuc-ls" else name)


def moves(reads: list[Read]) -> list[Read]:
    return [one for one in reads if one.to is not None]


def in_G54(kind: str, target: Target, turned: float = 0.0) -> np.ndarray:
    """The tip [mm] in G54, from the control's base."""
    assert target.X_KT is not None
    p = target.X_KT[:3, 3] * 1000 + [0, 0, HEIGHT.get(kind, 0.0)] - np.array(TABLE)
    c, s = math.cos(math.radians(turned)), math.sin(math.radians(turned))
    return np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) @ p


@pytest.mark.parametrize("kind", ARMS)
@pytest.mark.parametrize("turned", [0.0, 30.0])
def test_targets_are_the_points_of_the_program(kind: str, turned: float) -> None:
    reads = moves(read(kind, written(job(kind, turned=turned), kind).files))

    ends = {one.line: one.to for one in reads if one.kind != "joint" and one.to is not None}
    for line in (7, 8, 9, 10, 14):
        np.testing.assert_allclose(in_G54(kind, ends[line], turned), POINTS[line], atol=0.01)
        tool_z = ends[line].X_KT[:3, 2]  # type: ignore[index]
        np.testing.assert_allclose(tool_z, [0, 0, -1], atol=1e-6)
    middles = [one.via for one in reads if one.line == 9]
    assert len(middles) == 2  # half a circle is two moves of a quarter
    for via, angle in zip(middles, (-45.0, 45.0), strict=True):
        assert via is not None
        on_circle = (40 + 10 * math.cos(math.radians(angle)), 10 + 10 * math.sin(math.radians(angle)), -1)
        np.testing.assert_allclose(in_G54(kind, via, turned), on_circle, atol=0.01)


@pytest.mark.parametrize("kind", ARMS)
def test_joints_come_back(kind: str) -> None:
    of = job(kind)
    plan = of.plan
    assert plan is not None
    first, second = [one.to for one in moves(read(kind, written(of, kind).files)) if one.kind == "joint"][:2]

    begin = plan.joints(plan.trajectory.sample(np.zeros(1)))[0]
    there = plan.joints(plan.trajectory.sample(plan.trajectory.row_end[:1]))[0]
    for target, q in ((first, begin), (second, there)):
        assert target is not None
        np.testing.assert_allclose(np.degrees(target.joints), np.degrees(q), atol=1e-3)


@pytest.mark.parametrize("kind", ARMS)
def test_tool_and_place_of_the_wrist_agree_with_the_plan(kind: str) -> None:
    """Base, tool and target together put the flange where the plan has it at the end of each block."""
    of = job(kind, turned=30.0)
    plan = of.plan
    assert plan is not None
    reads = [one for one in moves(read(kind, written(of, kind).files)) if one.kind == "linear"]
    rows = {plan.path.span(row).line: row for row in range(len(plan.path))}
    for one in reads:
        assert one.to is not None and one.to.X_KT is not None
        row = rows[one.line]
        q = plan.joints(plan.trajectory.sample(plan.trajectory.row_end[row : row + 1] - 1e-12))
        X_KF = one.to.X_KT @ np.linalg.inv(one.X_FT)
        X_KF[2, 3] += HEIGHT.get(kind, 0.0) / 1000
        np.testing.assert_allclose(X_KF, plan.kinematics.forward(q)[0], atol=1e-5)
    assert {tuple(np.round(one.X_FT[:3, 3], 6)) for one in reads} == {(0, 0, 0.05), (0, 0, 0.08)}


@pytest.mark.parametrize("kind", ARMS)
def test_speeds_and_stops(kind: str) -> None:
    reads = read(kind, written(job(kind), kind).files)
    feeds = [one for one in moves(reads) if one.line in (7, 8, 9, 10)]

    assert [one.speed for one in feeds] == pytest.approx([0.005] * len(feeds), rel=1e-3)
    assert [one.blend for one in feeds if one.line != 9] == [0.0] * 3
    assert [one.value for one in reads if one.kind == "wait"] == [0.25]
    assert [one.kind for one in reads].count("halt") == 1  # the second tool


@pytest.mark.parametrize("kind", ARMS)
def test_outputs_stand_where_the_program_switches(kind: str) -> None:
    wish = {"signals": {"P1": "7", "E2": "2", "spindle": "3", "speed": "4"}}
    reads = read(kind, written(job(kind), kind, **wish).files)

    steps = [(one.signal, one.value) if one.kind == "set" else one.line for one in reads]
    assert steps.index(("4", 6000.0)) < steps.index(("3", 1.0)) < steps.index(7)
    assert steps.index(("7", 1.0)) < steps.index(8)
    assert steps.index(10) < steps.index(("7", 0.0)) < steps.index(("2", 0.5)) < steps.index(14)


def test_codes_of_the_cell_that_are_outputs_keep_their_numbers() -> None:
    text = CELL.format(arm=ARMS["krl"], home=HOMES["krl"], turned=0.0)
    text = text.replace("  2: {type: flat_end_mill, diameter: 6, flutes: 2, length: 80}", GRIPPER)
    of = prepare(
        SourceText("part.nc", b"G21 G90\nT2 M6 G43 H2\nG0 X0 Y0 Z50\nM64 P3\nG0 X5\nM65 P3\nM2\n"),
        read_cell(SourceText("arm.yaml", text.encode()), Path("arm.yaml")),
    )
    reads = read("krl", written(of, "krl").files)
    assert [(one.signal, one.value) for one in reads if one.kind == "set"] == [("3", 1.0), ("3", 0.0)]


GRIPPER = """  2: {type: suction_gripper, length: 80, cups: [{at: [0, 0], diameter: 30}], vacuum: 60 kPa}
m_codes: {M64 P3: {gripper: close}, M65 P3: {gripper: open}}"""


@pytest.mark.parametrize("kind", ARMS)
def test_tools_are_changed_by_the_control_s_own_program(kind: str) -> None:
    reads = read(kind, written(job(kind), kind, tool_change="CHANGE").files)

    assert [one.value for one in reads if one.kind == "call"] == [1, 2]
    assert not any(one.kind == "halt" for one in reads)


@pytest.mark.parametrize("kind", ARMS)
def test_controls_meet_over_their_lines(kind: str) -> None:
    """Two arms, each with its own program, come to the same mark twice."""
    jobs = meeting_jobs(kind)
    there, back = MeetingLines(output="5", input="6"), MeetingLines(output="7", input="8")
    lines = {("main", "other"): there, ("other", "main"): back}
    language = LANGUAGES[kind]()
    said = []
    for one in jobs:
        program, findings = program_of(one, language, Wish(meet=lines), jobs)
        assert not findings
        files = language.write(program).files
        reads = read(kind, files, "part" if one is jobs[0] else "b_other")
        said.append([(r.kind, r.signal, r.value) for r in reads if r.kind in ("await", "set")])

    leads = [("await", "6", 0), ("set", "5", 1), ("await", "6", 1), ("set", "5", 0)]
    follows = [("await", "8", 1), ("set", "7", 1), ("await", "8", 0), ("set", "7", 0)]
    assert said == [[("set", "5", 0), *leads, *leads], [("set", "7", 0), *follows, *follows]]


@pytest.mark.parametrize("kind", ARMS)
def test_without_lines_a_control_stops_for_the_others(kind: str) -> None:
    jobs = meeting_jobs(kind)
    language = LANGUAGES[kind]()

    program, findings = program_of(jobs[1], language, Wish(), jobs)

    assert [(one.code, one.span.line) for one in findings] == [("GS802", 3)]
    assert "--meet other/main=" in str(findings[0].hint)
    assert [one.kind for one in read(kind, language.write(program).files, "b_other")].count("halt") == 2


def meeting_jobs(kind: str) -> tuple[Job, ...]:
    text = (
        f"robots: {{a: {{model: {ARMS[kind]}, home: {HOMES[kind]}}}, "
        f"b: {{model: {ARMS[kind]}, home: {HOMES[kind]}, base: {{in: world, xyz: [3000, 0, 0]}}}}}}\n"
        "channels:\n"
        "  main: {robot: a, work_offsets: {G54: {in: world, xyz: [520, -35, 562]}}, m_codes: {M200: {wait: both}}}\n"
        "  other: {robot: b, work_offsets: {G54: {in: world, xyz: [3520, -35, 562]}}, m_codes: {M200: {wait: both}}}\n"
    )
    other = SourceText("b.nc", b"G21 G90\nG0 X5 Y0 Z0\nM200\nG0 X9\nM200\nM2\n")
    job = prepare(
        SourceText("part.nc", b"G21 G90\nG0 X0 Y0 Z0\nM200\nG1 X5 F500\nM200\nM2\n"),
        read_cell(SourceText("arms.yaml", text.encode()), Path("arms.yaml")),
        Options(channels={"other": other}),
    )
    assert not job.findings or all(one.level.word != "error" for one in job.findings), list(job.findings)
    return job.all


def test_what_has_no_output_is_told_once() -> None:
    language = LANGUAGES["krl"]()
    _, findings = program_of(job("krl"), language, Wish())

    assert [finding.code for finding in findings] == ["GS802", "GS802"]
    assert [finding.span.line for finding in findings] == [4, 4]


@pytest.mark.parametrize("kind", ["krl", "rapid", "urscript"])
def test_corners_are_cut_no_more_than_allowed(kind: str) -> None:
    """By the parabola between the two places in the distance of the blend."""
    of = job(kind, mode="G64 P0.05")
    reads = [one for one in moves(read(kind, written(of, kind).files)) if one.kind != "joint"]
    corner = next(one for one in reads if one.line == 7)  # from down to along X: a right angle

    assert corner.blend > 0.0
    assert corner.blend * math.sin(math.radians(45)) / 2 <= 0.05e-3 + 1e-6
    straight_on = [one for one in reads if one.line == 8]  # into the arc without a corner
    assert straight_on[0].blend > 0.2e-3


def posture(kind: str, q: np.ndarray, of: Job) -> tuple[int | str, ...]:
    """What a control says of joints (6,), by the pictures in its manual: from where wrist centre and elbow are."""
    assert of.plan is not None
    kinematics = of.plan.kinematics
    names = kinematics.link_names
    links = kinematics.links(q[None])[0]
    X_BA = np.linalg.inv(kinematics.links(np.zeros((1, 6)))[0][names.index("link_1")])
    X_B1 = links[names.index("link_1")] @ X_BA  # turned with axis 1
    wrist, elbow, shoulder = (links[names.index(n)][:3, 3] for n in ("link_5", "link_3", "link_2"))
    behind = (np.linalg.inv(X_B1) @ np.append(wrist, 1.0))[0] < 0.0
    across = X_B1[:3, 1]  # to the left of the arm, as it looks
    back = float(np.cross(elbow - shoulder, wrist - shoulder) @ across) < 0.0
    deg = np.degrees(q)
    negative = deg[4] < 0.0
    if kind == "krl":
        return behind + 2 * (not back) + 4 * negative, sum(1 << k for k in range(6) if deg[k] < -1e-5)
    if kind == "rapid":
        quarters = [math.floor(round(deg[k], 5) / 90.0) for k in (0, 3, 5)]
        return (*quarters, 4 * behind + 2 * back + negative)
    turns = [0 if -180 <= deg[k] < 180 else math.floor((deg[k] + 180) / 360) for k in (0, 3, 5)]
    return ("N" if negative else "F", "D" if back else "U", "B" if behind else "T", *turns)


@pytest.mark.parametrize("kind", ["krl", "rapid", "fanuc-ls"])
@pytest.mark.parametrize("turned", [0.0, 30.0, -100.0])
def test_configuration_leads_to_the_joints_of_the_plan(kind: str, turned: float) -> None:
    of = job(kind, turned=turned)
    plan = of.plan
    assert plan is not None
    rows = {plan.path.span(row).line: row for row in range(len(plan.path))}
    for one in moves(read(kind, written(of, kind).files)):
        if one.kind != "linear":
            continue
        assert one.to is not None and one.to.X_KT is not None
        X_BF = one.to.X_KT @ np.linalg.inv(one.X_FT)
        X_BF[2, 3] += HEIGHT.get(kind, 0.0) / 1000
        whole = [q + 2 * math.pi * np.array(k) for q in plan.kinematics.branches(X_BF) for k in _turns()]
        lower, upper = plan.kinematics.joints.lower, plan.kinematics.joints.upper
        inside = [q for q in whole if np.all(q >= lower - 1e-9) and np.all(q <= upper + 1e-9)]
        fitting = [q for q in inside if posture(kind, q, of) == one.to.stands]
        row = rows[one.line]
        there = plan.joints(plan.trajectory.sample(plan.trajectory.row_end[row : row + 1] - 1e-12))[0]
        assert any(np.degrees(np.abs(q - there).max()) < 1e-3 for q in fitting)
        assert len(fitting) == 1 or kind == "krl"  # T knows the sign of an axis, not its turn


def _turns() -> list[tuple[int, ...]]:
    return [(a, 0, 0, b, 0, c) for a, b, c in itertools.product((-1, 0, 1), repeat=3)]


@pytest.mark.parametrize("kind", ["krl", "rapid", "fanuc-ls"])
def test_each_branch_of_an_arm_has_its_own_words(kind: str) -> None:
    """All eight ways to stand at one place, told as the pictures of the manuals tell them."""
    from gcodesim.post.posture import posture_of

    of = job(kind)
    assert of.plan is not None
    kinematics = of.plan.kinematics
    rng = np.random.default_rng(5)
    seen = set()
    for _ in range(12):
        q = rng.uniform(-1.2, 1.2, 6)
        for branch in kinematics.branches(kinematics.forward(q[None])[0]):
            found = posture_of(kinematics, branch)
            assert found is not None
            stands = posture(kind, branch, of)
            if kind == "krl":
                assert found.behind + 2 * (not found.elbow_back) + 4 * found.wrist_negative == stands[0]
            elif kind == "rapid":
                assert 4 * found.behind + 2 * found.elbow_back + found.wrist_negative == stands[3]
            else:
                assert ("FN"[found.wrist_negative], "UD"[found.elbow_back], "TB"[found.behind]) == stands[:3]
            seen.add((found.behind, found.elbow_back, found.wrist_negative))
    assert len(seen) == 8


@pytest.mark.parametrize("kind", ARMS)
def test_joint_moves_keep_the_tip_on_the_way(kind: str) -> None:
    of = job(kind)
    plan = of.plan
    assert plan is not None
    reads = moves(read(kind, written(of, kind, motion="joint", tolerance=1e-5).files))
    assert all(one.kind == "joint" for one in reads)

    joints = [one.to.joints for one in reads if one.to is not None and one.to.joints is not None]
    cut = [n for n, one in enumerate(reads) if one.line == 8]
    steps = [joints[n - 1] + share * (joints[n] - joints[n - 1]) for n in cut for share in (0.25, 0.5, 0.75, 1.0)]
    tips = plan.tip(np.array(steps), np.full(len(steps), 2))[:, :3, 3] * 1000 - np.array(TABLE)
    assert np.abs(tips[:, 1:] - [0, -1]).max() < 0.0105
    assert len(cut) > 2
    if kind == "rapid":
        at_full = plan.trajectory.row_end[2] - plan.trajectory.row_start[2]
        text = written(of, kind, motion="joint", tolerance=1e-5).files["part.mod"]
        told = [float(line.partition("\\T:=")[2].partition(",")[0]) for line in text.splitlines() if "! line 8" in line]
        assert sum(told) == pytest.approx(at_full, abs=1e-3)


@pytest.mark.parametrize(("name", "kind"), [("rail", "krl"), ("turntable", "rapid"), ("rail", "fanuc-ls")])
def test_external_axes_go_along(name: str, kind: str) -> None:
    """A control that moves tip and external axes evenly between the points is nowhere off the way of the plan."""
    of = prepare(
        SourceText.read(ROOT / f"programs/{name}.nc"),
        read_cell(SourceText.read(ROOT / f"cells/{name}.yaml"), ROOT / f"cells/{name}.yaml"),
    )
    plan = of.plan
    assert plan is not None
    reads = moves(read(kind, written(of, kind).files, name))
    lines = [one for one in reads if one.kind == "linear"]
    assert len(lines) > 50
    path = plan.path
    row = next(r for r in range(len(path)) if path.span(r).line == lines[60].line and plan.trajectory.row_time[r] > 0.5)
    t = plan.trajectory
    times = np.linspace(t.row_start[row], t.row_end[row], 42)[8:-8]
    samples = t.sample(times)
    q = plan.joints(samples)
    tips = plan.tip(q, samples.row)
    slides = of.shop.kinematics.joints.kinds  # type: ignore[union-attr]
    own = plan.kinematics.externals  # type: ignore[attr-defined]
    scale = np.array([1000.0 if slides[k] == "prismatic" else 180 / math.pi for k in own])
    height = _world_height(kind, of)
    for X, joints in zip(tips, q, strict=True):
        p, ext = X[:3, 3] - [0, 0, height], joints[own] * scale
        off = min(_off(a, b, p, ext) for a, b in itertools.pairwise(lines))
        assert off < 0.03  # mm and degrees


def _world_height(kind: str, of: Job) -> float:
    return 0.4 if kind == "fanuc-ls" else 0.0  # of joint 2 of the KR 10 that stands on the rail


def _off(a: Read, b: Read, p: np.ndarray, ext: np.ndarray) -> float:
    assert a.to is not None and b.to is not None and a.to.X_KT is not None and b.to.X_KT is not None
    p0, p1 = a.to.X_KT[:3, 3], b.to.X_KT[:3, 3]
    e0, e1 = np.array(a.to.externals), np.array(b.to.externals)
    way = p1 - p0
    share = float(np.clip((p - p0) @ way / max(way @ way, 1e-18), 0, 1))
    return max(float(np.linalg.norm(p - p0 - share * way)) * 1000, float(np.abs(ext - e0 - share * (e1 - e0)).max()))


@pytest.mark.parametrize("kind", ["krl", "rapid", "fanuc-ls"])
def test_long_programs_are_divided(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = read(kind, written(job(kind), kind).files)
    monkeypatch.setattr(LANGUAGES[kind], "most_moves", 3)
    divided = written(job(kind), kind).files

    assert len(divided) > 3
    assert all("gcodesim" in text for text in divided.values())  # so that they may be written anew
    again = read(kind, divided)
    assert [(one.kind, one.line, one.speed, one.value) for one in again] == [
        (one.kind, one.line, one.speed, one.value) for one in whole
    ]
    for one, other in zip(moves(whole), moves(again), strict=True):
        assert one.to is not None and other.to is not None
        if one.to.X_KT is not None:
            np.testing.assert_array_equal(one.to.X_KT, other.to.X_KT)


@pytest.mark.parametrize("kind", ARMS)
def test_the_same_bytes_each_time(kind: str) -> None:
    first, second = written(job(kind), kind), written(job(kind), kind)

    assert first.files == second.files
    assert all(text.isascii() for text in first.files.values())


def test_what_cannot_be_said_is_refused() -> None:
    rail = prepare(
        SourceText.read(ROOT / "programs/rail.nc"),
        read_cell(SourceText.read(ROOT / "cells/rail.yaml"), ROOT / "cells/rail.yaml"),
    )
    with pytest.raises(NotPostedError, match="rail/U"):
        program_of(rail, LANGUAGES["urscript"](), Wish())
    mill = prepare(
        SourceText.read(ROOT / "programs/pocket.nc"),
        read_cell(SourceText.read(ROOT / "cells/pocket.yaml"), ROOT / "cells/pocket.yaml"),
    )
    with pytest.raises(NotPostedError, match="machine tool"):
        program_of(mill, LANGUAGES["krl"](), Wish())


def test_remarks_of_fanuc_are_cut_between_words() -> None:
    """The control shows 32 characters of a remark."""
    text = written(job("fanuc-ls"), "fanuc-ls").files["PART.ls"]
    remarks = [line.partition("!")[2].removesuffix(" ;") for line in text.split("\r\n") if ":  !" in line]

    assert max(map(len, remarks)) <= 32
    assert " ".join(remarks).startswith("part.nc in arm.yaml, as gcodesim has checked it (fanuc-ls) frame 1: ")
    assert all(one == one.strip() for one in remarks)
