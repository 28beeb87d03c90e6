"""The search for a configuration over a whole cut: cases with a truth of their own, and all ways of small ladders."""

from itertools import product

import numpy as np
import pytest

from gcodesim.kinematics import MODELS
from gcodesim.planning.configuration import Hindrance, search
from gcodesim.planning.ladder import Passage
from gcodesim.planning.ladder_kernels import LIMITED, TURN, Ladder, earliest, link, shortest, trace, widest
from gcodesim.units import DEG
from tests.configuration_cases import answer, answer_placement, can_run, compare, kinematics_for, read_cases

DATA = read_cases()
MODES = [(case, mode) for case in DATA["cases"] for mode in ("fixed", "free")]
BOUND = np.array([1.3, 1.5])  # [rad] that joints may go between rungs of small ladders
ARMS = [name for name, model in MODELS.items() if model.kind == "arm"]


@pytest.mark.parametrize(("case", "mode"), MODES, ids=lambda value: value if isinstance(value, str) else value["id"])
def test_a_cut_has_the_answer_of_a_search_over_all_ways(case, mode):
    limits = DATA["robots"][case["robot"]]["limits_deg"]
    assert not case["truth"][mode]["unsure"]
    assert compare().judge(case, mode, limits, answer(case, mode)) == []


@pytest.mark.parametrize("case", DATA["placements"], ids=lambda case: case["id"])
def test_a_part_can_be_shifted_as_far_as_a_search_over_all_ways_says(case):
    assert compare().judge_place(case, answer_placement(case)) == []


def small_ladder(rng):
    """Four rungs with a few vectors of two joints; the limits leave room for two and three turns."""
    lower, upper = np.array([-4.0, -9.0]), np.array([5.0, 8.0])
    counts = rng.integers(2, 6, 4)
    first = np.concatenate([[0], np.cumsum(counts)])
    q = lower + rng.uniform(0.0, TURN, (first[-1], 2))
    turns = np.array([2, 3])
    whole = np.array(list(np.ndindex(*turns)))
    return Ladder(first, q, lower, upper, np.array([LIMITED, LIMITED]), turns, whole)


def all_ways(ladder, rungs, bound):
    """Joints (n, 2) of all ways along the vectors of `rungs` within the limits: every vector, turn and order."""
    choices = []
    for i in rungs:
        q = ladder.q[ladder.first[i] : ladder.first[i + 1], None] + TURN * ladder.whole
        q = q.reshape(-1, 2)
        choices.append(q[np.all((q >= ladder.lower) & (q <= ladder.upper), axis=1)])
    ways = [[q] for q in choices[0]]
    for choice in choices[1:]:
        ways = [[*way, q] for way, q in product(ways, choice) if np.all(np.abs(q - way[-1]) <= bound)]
    return np.array(ways).reshape(-1, len(choices), 2)


@pytest.mark.parametrize("seed", range(12))
def test_no_way_of_a_small_ladder_is_missed(seed):
    """A slow twin walks all ways one by one."""
    ladder, bound = small_ladder(np.random.default_rng(seed)), BOUND
    rails = link(ladder, bound, False)
    runs = {(a, b): all_ways(ladder, range(a, b + 1), bound) for a in range(4) for b in range(a, 4)}
    open_runs = {run for run, ways in runs.items() if len(ways)}
    prefix, start, end = earliest(ladder, rails)
    assert prefix == max([b + 1 for a, b in open_runs if a == 0], default=0)
    assert end - start == max([b - a for a, b in open_runs], default=-1)
    ways = runs[0, 3]
    if not len(ways):
        assert widest(ladder, rails) == -1.0
        return
    margins = np.minimum(ways - ladder.lower, ladder.upper - ways).min(axis=(1, 2))
    assert widest(ladder, rails) == pytest.approx(margins.max(), abs=1e-12)
    parent = np.empty((len(ladder.q), len(ladder.whole)), dtype=np.int16)
    start = np.zeros((ladder.first[1], len(ladder.whole)))
    for margin in (0.0, float(margins.max()) - 1e-9):
        enough = ways[margins >= margin]
        travel, vector, turn = shortest(ladder, rails, margin, start, parent)
        assert travel == pytest.approx(np.abs(np.diff(enough, axis=1)).sum(axis=(1, 2)).min(), abs=1e-12)
        steps = np.empty((4, 2), dtype=np.int64)
        trace(ladder, rails, parent, vector, turn, steps)
        q = ladder.q[steps[:, 0]] + TURN * ladder.whole[steps[:, 1]]
        assert np.abs(np.diff(q, axis=0)).sum() == pytest.approx(travel, abs=1e-12)


def test_small_ladders_have_ways_and_have_none():
    ladders = [small_ladder(np.random.default_rng(seed)) for seed in range(12)]
    found = [widest(ladder, link(ladder, BOUND, False)) for ladder in ladders]
    assert min(found) == -1.0 < 0.0 < max(found)


def swing(name, *, free):
    """A cut that is the trace of the tip of an arm that moves all joints a little from its home."""
    robot = kinematics_for(name)
    home = np.array(MODELS[name].home)
    q = home + np.linspace(0.0, 1.0, 9)[:, None] * np.array([0.4, -0.1, 0.1, 0.3, -0.2, 0.5])
    X_FT = np.eye(4)
    X_FT[:3, 3] = 0.02, 0.0, 0.15
    return robot, q, Passage(X_BT=robot.forward(q) @ X_FT, X_FT=X_FT, free=free, step=np.full(6, 20 * DEG))


@pytest.mark.parametrize("name", ARMS)
def test_every_arm_finds_the_way_that_it_came(name):
    """The known joints are a way, so no best one is worse."""
    robot, q, cut = swing(name, free=False)
    found = search(robot, cut)
    assert found.continuous
    margin = np.minimum(q - robot.joints.lower, robot.joints.upper - q).min()
    travel = np.abs(np.diff(q, axis=0)).sum()
    assert found.clear.margin >= 0.97 * margin
    assert found.short.travel <= travel + 1e-9
    for way in (found.clear, found.short):
        assert np.abs(robot.forward(way.q) - robot.forward(q)).max() < 1e-9
        assert np.abs(np.diff(way.q, axis=0)).max() <= 20 * DEG


def test_a_free_tool_does_at_least_as_well_as_a_fixed_one():
    robot, _, fixed = swing("staubli_tx2_90", free=False)
    free = swing("staubli_tx2_90", free=True)[2]
    narrow, wide = search(robot, fixed, spins=36), search(robot, free, spins=36)
    assert wide.short.travel < narrow.short.travel
    assert wide.clear.margin > narrow.clear.margin
    tips = robot.forward(wide.clear.q) @ free.X_FT
    assert np.abs(tips[:, :3, 2:] - free.X_BT[:, :3, 2:]).max() < 1e-9


@pytest.mark.parametrize("spins", [24, 36, 72])
def test_refinement_makes_up_for_a_coarse_grid(spins):
    robot, _, cut = swing("kuka_kr10_r1100_2", free=True)
    coarse, fine = search(robot, cut, spins=spins), search(robot, cut, spins=144)
    assert coarse.short.travel <= 1.05 * fine.short.travel
    assert coarse.clear.margin >= 0.95 * fine.clear.margin


def test_what_is_out_of_reach_ends_a_cut():
    robot, _, cut = swing("ur10e", free=False)
    far = cut.X_BT.copy()
    far[5:, 2, 3] += 3.0
    found = search(robot, Passage(X_BT=far, X_FT=cut.X_FT, free=False, step=cut.step))
    assert (found.prefix, found.stretch, found.obstacle) == (5, (0, 4), Hindrance.REACH)
    assert len(found.clear.q) == 5
    away = search(robot, cut.shifted(np.array([9.0, 0.0, 0.0])))
    assert (away.prefix, away.stretch, away.clear, away.obstacle) == (0, (0, -1), None, Hindrance.REACH)
    assert not can_run(robot, cut.shifted(np.array([9.0, 0.0, 0.0])))
    assert can_run(robot, cut)


def test_a_pinned_branch_is_kept():
    robot, q, cut = swing("kuka_kr10_r1100_2", free=False)
    ways = {}
    for branch in range(8):
        found = search(robot, cut, branches=(branch,))
        if found.continuous:
            ways[branch] = found.short.q
    assert len(ways) > 1
    own = [branch for branch, way in ways.items() if np.abs(way - q).max() < 1e-9]
    assert len(own) == 1
