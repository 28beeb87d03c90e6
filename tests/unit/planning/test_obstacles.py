"""Configurations among obstacles: against a plain search of the test's own, and in whole programs."""

from itertools import product
from pathlib import Path

import numpy as np
import pytest

from gcodesim.cell.loader import read_cell
from gcodesim.checks.machine_bodies import MachineBodies
from gcodesim.checks.meetings import JointWay
from gcodesim.checks.postures import Postures
from gcodesim.diagnostics import SourceText
from gcodesim.planning.configuration import Hindrance, search
from gcodesim.planning.ladder import Passage
from gcodesim.planning.obstacles import Around
from gcodesim.shop import open_shop
from gcodesim.simulation import prepare

TURN = 2.0 * np.pi
SPINS = 10
STEP = np.full(6, 0.8)
POSES = 10

CELL = """gcodesim: 1
robots: {arm: {model: %s}}
work_offsets: {G54: {in: world, xyz: [550, 0, 200]}}
orientation: {tool_axis: -Z of G54, spin: free}
tools: {1: {type: flat_end_mill, diameter: 10, length: 80, holder: {diameter: 40, length: 50}}}
fixtures: {%s}
"""
PROGRAM = "G21 G90 G94 G17\nT1 M6\nG43 H1\nG0 X0 Y-200 Z50\nG1 Z0 F1000\nG1 Y250 F3000\nG1 X100\nG1 Y-200\nG0 Z50\nM2\n"


def cell_with(model, boxes):
    """The text of a cell with boxes: centre and size [mm]."""
    fixtures = ", ".join(
        f"box{k}: {{box: {list(map(float, size))}, in: world, xyz: {(np.array(at) - np.array(size) / 2.0).tolist()}}}"
        for k, (at, size) in enumerate(boxes)
    )
    return read_cell(SourceText("cell.yaml", (CELL % (model, fixtures)).encode()), Path("cell.yaml"))


def prepared(model, boxes, program=PROGRAM):
    return prepare(SourceText("program.nc", program.encode()), cell_with(model, boxes))


def drawn(seed):
    """A robot among boxes and a cut beside them."""
    rng = np.random.default_rng(seed)
    model = ("kuka_kr10_r1100_2", "ur10e")[seed % 2]
    boxes = [
        (rng.uniform([-300, -500, 150], [700, 500, 900]), rng.uniform([60, 60, 60], [250, 250, 500]))
        for _ in range(int(rng.integers(1, 4)))
    ]
    loaded = cell_with(model, boxes)
    shop = open_shop(loaded.cell)
    start, end = rng.uniform([300, -500, 150], [650, 500, 500], size=(2, 3)) * 1e-3
    X = np.zeros((POSES, 4, 4))
    X[:, :3, :3] = np.diag([1.0, -1.0, -1.0])
    X[:, :3, 3] = start + np.linspace(0.0, 1.0, POSES)[:, None] * (end - start)
    X[:, 3, 3] = 1.0
    machine = MachineBodies.of(shop.scene, "arm")
    postures = Postures(machine=machine, tools={}, home=shop.home)
    around = Around(obstacles=postures, tools=np.zeros(POSES, dtype=np.int64))
    X_FT = np.eye(4)
    X_FT[2, 3] = 0.08
    return shop, machine, Passage(X_BT=X, X_FT=X_FT, free=seed % 3 != 0, step=STEP, around=around)


def is_clear(machine, home):
    """A judge of postures by the search along ways; links that are in each other at home are drawn so."""

    def drawn_so(pair):
        links = all(machine.bodies[k].role == "link" for k in pair)
        return links and machine.moving(machine.bodies, [pair]).search(JointWay.straight(home[None]))

    pairs = [pair for pair in machine.pairs() if not drawn_so(pair)]
    moving = machine.moving(machine.bodies, pairs)
    return lambda q: not moving.search(JointWay.straight(q[None]))


def every_vector(kinematics, X_BF):
    """All joint vectors (m, 6) of one pose within limits, with all whole turns."""
    lower, upper = kinematics.joints.lower, kinematics.joints.upper
    found = []
    for q in kinematics.branches(X_BF):
        choices = [
            [v + TURN * k for k in range(-3, 4) if low - 1e-9 <= v + TURN * k <= high + 1e-9]
            for v, low, high in zip(q, lower, upper, strict=True)
        ]
        found += list(product(*choices))
    return np.array(found).reshape(-1, 6)


def plain(shop, machine, cut):
    """How many poses can be run from the start, the length of the longest part, and why the first is not reached."""
    clear = is_clear(machine, shop.home)
    angles = TURN * np.arange(SPINS) / SPINS if cut.free else np.zeros(1)
    flange = cut.flange(np.tile(angles, (POSES, 1)))
    free, bare = [], []
    for row in flange:
        vectors = np.concatenate([every_vector(shop.kinematics, X) for X in row])
        # a collision does not depend on whole turns
        keys = {tuple(np.round(np.mod(q + 1e-7, TURN), 5)) for q in vectors}
        known = {key: clear(np.array(key)) for key in keys}
        good = np.array([known[tuple(np.round(np.mod(q + 1e-7, TURN), 5))] for q in vectors], dtype=bool)
        bare.append(vectors)
        free.append(vectors[good] if len(vectors) else vectors)

    def run(rungs):
        prefix, longest = 0, 0
        oldest = None
        for k, here in enumerate(rungs):
            age = np.zeros(len(here), dtype=int) + k
            if k and len(rungs[k - 1]):
                for i, q in enumerate(here):
                    near = (np.abs(rungs[k - 1] - q) <= STEP).all(axis=1)
                    if near.any():
                        age[i] = min(age[i], oldest[near].min())
            oldest = age
            if len(here):
                longest = max(longest, k - int(age.min()) + 1)
                if age.min() == 0 and prefix == k:
                    prefix = k + 1
        return prefix, longest

    prefix, longest = run(free)
    reason = None
    if prefix < POSES:
        reached = any(len(shop.kinematics.branches(X)) for X in flange[prefix])
        if not reached:
            reason = Hindrance.REACH
        elif not len(bare[prefix]):
            reason = Hindrance.LIMIT
        else:
            reason = Hindrance.COLLISION if not len(free[prefix]) or run(bare)[0] > prefix else Hindrance.WAY
    return prefix, longest, reason, clear


@pytest.mark.parametrize("seed", [*range(5), *(pytest.param(k, marks=pytest.mark.slow) for k in range(5, 60))])
def test_a_drawn_cut_among_boxes_is_answered_as_by_a_plain_search(seed):
    shop, machine, cut = drawn(seed)
    found = search(shop.kinematics, cut, spins=SPINS)
    prefix, longest, reason, clear = plain(shop, machine, cut)
    assert found.prefix == prefix
    assert found.stretch[1] - found.stretch[0] + 1 == longest
    assert found.obstacle == reason
    for way in (found.clear, found.short):
        if way is not None:
            assert all(clear(q) for q in way.q)


def test_drawn_cuts_end_for_each_reason():
    """What the sweep above compares is not always the same."""
    reasons = {search(shop.kinematics, cut, spins=SPINS).obstacle for shop, _, cut in map(drawn, range(12))}
    assert reasons == {None, Hindrance.COLLISION}


def codes(job):
    return [
        found.code for found in job.findings if found.code in ("GS202", "GS203", "GS205", "GS216", "GS305", "GS306")
    ]


def test_the_spin_is_one_with_which_the_wrist_passes_a_box():
    box = ((712, 291, 449), (26, 21, 71))
    job, alone = prepared("ur10e", [box]), prepared("ur10e", [])
    assert codes(job) == []
    assert job.plan is not None and alone.plan is not None
    joints = alone.plan.joints(alone.plan.trajectory.sample(np.linspace(0.0, alone.plan.trajectory.duration, 400)))
    clear = is_clear(MachineBodies.of(job.shop.scene, "arm"), job.shop.home)
    assert not all(clear(q) for q in joints)  # as it goes where nothing stands, the arm would hit the box


def test_where_every_way_ends_in_a_collision_the_hit_names_the_longest_part_and_what_hits_what():
    job = prepared("kuka_kr10_r1100_2", [((330, 170, 350), (60, 60, 700))])
    assert "GS216" not in codes(job)
    found = [finding for finding in job.findings if "every way on ends in a collision" in finding.hint]
    assert len(found) == 1
    assert found[0].code == "GS305"
    assert found[0].span is not None and found[0].span.line == 6 and found[0].related is None  # both are here
    assert "then every way on ends in a collision: `arm/link_3` hits box0; " in found[0].hint
