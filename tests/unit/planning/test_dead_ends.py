"""What a program's findings say where an arm gets no farther, against a brute force along the path.

The brute force looks at many places of the path with every branch and whole turn within limits; collisions are asked of
pybullet, which has shapes of its own.
"""

import re
from itertools import combinations, product
from pathlib import Path

import numpy as np
import pybullet
import pytest

from gcodesim import simulation
from gcodesim.cell.loader import read_cell
from gcodesim.diagnostics import SourceText
from gcodesim.kinematics import kinematics_of, load_urdf, model_path
from gcodesim.kinematics.path_kernels import JUMP
from gcodesim.units import MM

REACH = {"abb_irb1200_5_90": 0.85, "fanuc_m20ia": 1.6, "kuka_kr10_r1100_2": 1.0, "staubli_tx2_90": 0.9}  # [m], about
PLACES = 400
DIAMETER, LENGTH = 30.0, 180.0  # [mm] of the tool
UP = np.array([0.0, 0.0, 1.0])
DOWN = np.diag([1.0, -1.0, -1.0])
CELL = """gcodesim: 1
robots: {arm: {model: %s, allow_collisions: [%s]}}
work_offsets: {G54: {in: world}}
orientation: {tool_axis: -Z of G54, spin: 0 deg}
tools: {1: {type: flat_end_mill, diameter: 30, flutes: 2, length: 180, flute_length: 30}}
fixtures: {%s}
"""
HOLDS = re.compile(r"at most (\d+) % of lines \d+ to \d+ can be run, from line (\d+) to (\d+)")


def drawn(seed, blocked):
    """The name of an arm, corners (n, 3) [mm] of its path, and a box on the path or a corner out of reach."""
    rng = np.random.default_rng([seed, blocked])
    name = str(rng.choice(list(REACH)))
    size = 1e3 * REACH[name]
    corners = rng.uniform([0.35, -0.35, 0.05], [0.75, 0.35, 0.45], size=(int(rng.integers(3, 6)), 3)) * size
    if not blocked:
        corners[rng.integers(len(corners))] = size * rng.uniform([1.0, -0.5, 0.0], [1.4, 0.5, 0.4])
        return name, np.rint(corners), None
    k, share = rng.integers(len(corners) - 1), rng.uniform(0.2, 0.9)
    centre = corners[k] + share * (corners[k + 1] - corners[k]) + rng.uniform([-60, -60, -60], [60, 60, 120])
    return name, np.rint(corners), (np.rint(rng.uniform(0.06, 0.2, 3) * size), np.rint(centre))


def told(name, corners, box):
    """The share of the path that can be run, its lines and why it ends, as findings say; None: they do not."""
    chain, _ = load_urdf(model_path(name), name=name)
    links = ", ".join(f"[{one}, {other}]" for one, other in combinations([chain.base_name, *chain.link_names[1:]], 2))
    block = ""
    if box is not None:
        size, centre = (", ".join(f"{value:g}" for value in each) for each in box)
        block = f"block: {{box: [{size}], zero: center, in: world, xyz: [{centre}]}}"
    points = ["X{:g} Y{:g} Z{:g}".format(*each) for each in corners]
    moves = [f"G0 {points[0]}", *(f"G1 {each} F3000" for each in points[1:])]
    program = "\n".join(["G21 G90 G94 G61", "T1 M6", "G43 H1", *moves, "M2", ""])
    cell = read_cell(SourceText("cell.yaml", (CELL % (name, links, block)).encode()), Path("cell.yaml"))
    job = simulation.prepare(SourceText("program.nc", program.encode()), cell)
    for finding in simulation.check(job).findings:
        words = f"{finding.message} {finding.hint}"
        part = HOLDS.search(words)
        if part is None:
            continue
        why = {"GS202": "reach", "GS203": "limit", "GS216": "way"}.get(finding.code, "")
        why = "collision" if "ends in a collision" in words else why
        return int(part[1]) / 100, (int(part[2]), int(part[3])), why
    return None


class Brute:
    """An arm at places of a path."""

    def __init__(self, name, box):
        self.arm = kinematics_of(load_urdf(model_path(name), name=name)[0])
        self.client = pybullet.connect(pybullet.DIRECT)
        self.robot = pybullet.loadURDF(str(model_path(name)), useFixedBase=True, physicsClientId=self.client)
        kinds = [pybullet.getJointInfo(self.robot, k, self.client)[2] for k in range(self.joints)]
        self.moving = [k for k, kind in enumerate(kinds) if kind != pybullet.JOINT_FIXED]
        self.box = None if box is None else self.body(pybullet.GEOM_BOX, box[1], halfExtents=(box[0] / 2 * MM).tolist())
        self.tool = self.body(pybullet.GEOM_CYLINDER, [0, 0, 0], radius=DIAMETER / 2 * MM, height=LENGTH * MM)

    @property
    def joints(self):
        return pybullet.getNumJoints(self.robot, self.client)

    def body(self, kind, place, **shape):
        solid = pybullet.createCollisionShape(kind, **shape, physicsClientId=self.client)
        place = (np.asarray(place) * MM).tolist()
        return pybullet.createMultiBody(0, solid, basePosition=place, physicsClientId=self.client)

    def hits(self, q, tip):
        """Whether link or tool are in the box, or the tool is in a link that it is not held by."""
        for joint, value in zip(self.moving, q, strict=True):
            pybullet.resetJointState(self.robot, joint, float(value), physicsClientId=self.client)
        middle = [tip[0], tip[1], tip[2] + LENGTH / 2 * MM]
        pybullet.resetBasePositionAndOrientation(self.tool, middle, [1, 0, 0, 0], self.client)
        pairs = [(self.robot, self.box), (self.tool, self.box)]
        found = [each for pair in pairs for each in pybullet.getClosestPoints(*pair, 0.0, physicsClientId=self.client)]
        for link in (-1, *self.moving[:4]):
            found += pybullet.getClosestPoints(self.tool, self.robot, 0.0, linkIndexB=link, physicsClientId=self.client)
        return any(each[8] < 0.0 for each in found)

    def rung(self, tip):
        """Joints (k, 6) that can be had with the tip there, and why there are none."""
        joints, found, why = self.arm.joints, [], "reach"
        X = np.eye(4)
        X[:3, :3], X[:3, 3] = DOWN, tip + LENGTH * MM * UP
        for q in self.arm.branches(X):
            turns = np.add.outer(q, 2.0 * np.pi * np.arange(-1, 2))
            inside = (turns >= joints.lower[:, None]) & (turns <= joints.upper[:, None])
            why = "limit" if why == "reach" else why
            if not inside.any(axis=1).all():
                continue
            if self.box is not None and self.hits(q, tip):
                why = "collision"
                continue
            found += product(*(row[good] for row, good in zip(turns, inside, strict=True)))
        return np.array(found).reshape(-1, 6), why

    def longest(self, corners, places):
        """The share of the longest part of the way, its lines, and why it ends; None: all of it can be run."""
        at = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(corners, axis=0), axis=1))])
        way = np.linspace(0.0, at[-1], places)
        tips = np.stack([np.interp(way, at, column) for column in corners.T], axis=1) * MM
        best, before, begun = (0, -1), np.empty((0, 6)), np.empty(0)
        reasons = []
        for k, tip in enumerate(tips):
            q, why = self.rung(tip)
            reasons.append("way" if len(q) else why)
            near = (np.abs(q[:, None] - before) <= JUMP).all(axis=2)
            begun = np.where(near, begun, k).min(axis=1, initial=k)
            before = q
            if len(q) and k - begun.min() > best[1] - best[0]:
                best = int(begun.min()), k
        first, last = best
        if last - first + 1 == places:
            return None
        line = [4 + int(np.searchsorted(at, way[k] - 1e-9)) for k in best]
        return (last - first) / (places - 1), tuple(line), reasons[last + 1 if last + 1 < places else first - 1]


def longest(name, corners, box, places=PLACES):
    """The longest part by brute force; it ends by a collision, too, where it would be longer without the box."""
    brute = Brute(name, box)
    try:
        truth = brute.longest(corners, places)
    finally:
        pybullet.disconnect(brute.client)
    if box is None or truth is None or truth[2] != "way":
        return truth
    alone = longest(name, corners, None, places)
    return (*truth[:2], "collision" if alone is None or alone[0] > truth[0] else "way")


def check(seeds, blocked):
    judged = 0
    for seed in seeds:
        name, corners, box = drawn(seed, blocked)
        truth = longest(name, corners, box)
        found = told(name, corners, box)
        if truth is None and found is not None:  # what is in the way may be less than the places are apart
            truth = longest(name, corners, box, 10 * PLACES)
        if found is None and blocked:
            continue  # nothing but the tool is in the box, which no configuration changes: the finding says where
        judged += truth is not None
        assert (found is None) == (truth is None), seed
        if truth is not None and found is not None:
            assert found[0] == pytest.approx(truth[0], abs=0.012), seed
            assert found[1:] == truth[1:], seed
    return judged


@pytest.mark.parametrize("blocked", [False, True], ids=["reach", "collision"])
def test_the_longest_part_and_its_reason_are_those_of_a_brute_force(blocked):
    assert check(range(6), blocked) >= 2


@pytest.mark.slow
@pytest.mark.parametrize("blocked", [False, True], ids=["reach", "collision"])
def test_many_longest_parts_and_their_reasons_are_those_of_a_brute_force(blocked):
    assert check(range(6, 60), blocked) >= 20
