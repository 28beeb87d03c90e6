"""Cases of moving bodies with known truth, put to the search that a run uses; lengths of the files are mm."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from gcodesim.arithmetic.matrices import norm
from gcodesim.checks.meetings import JointWay, Meeting, MovingBodies
from gcodesim.checks.rigid import RigidBody
from gcodesim.frames import Array, Pose, rotation_from_quaternion
from gcodesim.kinematics.chain import Tree
from gcodesim.solids import Box, Cone, Cylinder, Mesh, Placed, Revolution, Sphere
from gcodesim.units import MM

DATA = Path(__file__).parent / "data" / "collisions" / "cases.json"
Case = dict[str, Any]


def read_cases(path: Path = DATA) -> dict[str, Any]:
    """The whole file."""
    return dict(json.loads(path.read_text()))


def pose_of(entry: Case) -> Pose:
    """The pose of an entry, the identity where it has none."""
    q = np.array(entry.get("quat_xyzw", (0.0, 0.0, 0.0, 1.0)))
    return Pose(np.array(entry.get("xyz", (0.0, 0.0, 0.0)), dtype=float) * MM, rotation_from_quaternion(q))


def solids_of(body: Case) -> list[Placed]:
    """One body of a case as solids."""
    X, kind = pose_of(body), body["shape"]
    if kind == "box":
        return [Placed(Box.about_origin(tuple(s * MM for s in body["size"])), X)]
    if kind == "sphere":
        return [Placed(Sphere(radius=body["radius"] * MM), X)]
    if kind == "revolution":
        outline = sorted(((r * MM, z * MM) for r, z in body["outline"]), key=lambda point: -point[1])
        return [Placed(Revolution(outline=_closed(body["outline"]) or tuple(outline)), X)]
    if kind == "mesh":
        return [Placed(Mesh.of(np.array(body["vertices"]) * MM, np.array(body["triangles"])), X)]
    radius, half = body["radius"] * MM, 0.5 * body["length"] * MM
    if kind == "cone":
        return [Placed(Cone(bottom_radius=radius, top_radius=0.0, bottom=-half, top=half), X)]
    parts = [Placed(Cylinder(radius=radius, bottom=-half, top=half), X)]
    if kind == "capsule":
        for end in (-half, half):
            parts.append(Placed(Sphere(radius=radius), X @ Pose(np.array([0.0, 0.0, end]), np.eye(3))))
    return parts


def _closed(outline: list[list[float]]) -> tuple[tuple[float, float], ...]:
    """An outline from the top down."""
    points = [(r * MM, z * MM) for r, z in outline]
    return tuple(points if points[0][1] >= points[-1][1] else points[::-1])


class _Joints:
    """A chain of joints that is put together one by one."""

    def __init__(self) -> None:
        self.before: list[Array] = []
        self.axis: list[Array] = []
        self.prismatic: list[int] = []
        self.ways: list[tuple[float, float]] = []

    def add(self, axis: Array, way: tuple[float, float], *, shifts: bool, X: Pose | None = None) -> None:
        self.before.append((X or Pose.identity()).matrix)
        self.axis.append(np.asarray(axis, dtype=float))
        self.prismatic.append(int(shifts))
        self.ways.append(way)

    def shift(self, begin: Array, end: Array) -> None:
        """From one place to another."""
        step = end - begin
        length = norm(step)
        axis = step / length if length > 0.0 else np.array([1.0, 0.0, 0.0])
        self.add(axis, (0.0, length), shifts=True, X=Pose(begin, np.eye(3)))

    def moved(self) -> tuple[Tree, JointWay]:
        count = len(self.axis)
        tree = Tree(
            parent=np.arange(-1, count - 1),
            before=np.array(self.before),
            axis=np.array(self.axis),
            prismatic=np.array(self.prismatic, dtype=np.int64),
            path=np.ones(count, dtype=np.int64),
            carrier=np.zeros(0, dtype=np.int64),
            offset=np.zeros((0, 4, 4)),
            flange_carrier=count - 1,
            flange_offset=np.eye(4),
        )
        return tree, JointWay.straight(np.array(self.ways).T)


def _body_motion(motion: Case) -> tuple[Tree, JointWay, Pose]:
    """Joints that move the frame of a body, and where it stands on the last of them."""
    joints = _Joints()
    R = rotation_from_quaternion(np.array(motion.get("quat_xyzw", (0.0, 0.0, 0.0, 1.0))))
    if motion["type"] in ("line", "line_turn"):
        joints.shift(np.array(motion["from"]) * MM, np.array(motion["to"]) * MM)
        if motion["type"] == "line_turn":
            axis = np.array(motion["turn_axis"]) / norm(np.array(motion["turn_axis"]))
            joints.add(axis, (0.0, np.radians(motion["turn_deg"])), shifts=False)
        return *joints.moved(), Pose(np.zeros(3), R)
    axis = np.array(motion["axis"]) / norm(np.array(motion["axis"]))
    centre, begin = np.array(motion["center"]) * MM, np.array(motion["from"]) * MM
    joints.add(axis, (0.0, motion.get("rise", 0.0) * MM), shifts=True, X=Pose(centre, np.eye(3)))
    turn = np.radians(motion["angle_deg"])
    joints.add(axis, (0.0, turn), shifts=False)
    if motion.get("orientation", "fixed") == "fixed":
        joints.add(axis, (0.0, -turn), shifts=False, X=Pose(begin - centre, np.eye(3)))
        return *joints.moved(), Pose(np.zeros(3), R)
    return *joints.moved(), Pose(begin - centre, R)


def _scene(case: Case, robots: Case) -> tuple[MovingBodies, MovingBodies, JointWay]:
    """What moves among still bodies, what moves among itself, and how."""
    moving, motion = case["moving"], case["motion"]
    still = [RigidBody(name=f"static {i}", solids=tuple(solids_of(b))) for i, b in enumerate(case["static"])]
    if moving["type"] == "body":
        tree, way, X = _body_motion(motion)
        solids = tuple(placed.at(X) for part in moving["parts"] for placed in solids_of(part))
        body = RigidBody(name="body", solids=solids, carrier=len(tree.parent) - 1)
        pairs = np.array([(0, i) for i in range(1, 1 + len(still))], dtype=np.int64).reshape(-1, 2)
        return MovingBodies(tree, [body, *still], pairs), MovingBodies(tree, [], pairs[:0]), way
    robot = robots[moving["robot"]]
    joints = _Joints()
    for entry, begin, end in zip(robot["joints"], motion["from_deg"], motion["to_deg"], strict=True):
        X = Pose(np.array(entry["xyz"]) * MM, np.eye(3))
        joints.add(np.array(entry["axis"]), (np.radians(begin), np.radians(end)), shifts=False, X=X)
    tree, way = joints.moved()
    last = len(tree.parent) - 1
    links = [
        RigidBody(name=link["name"], solids=tuple(p for b in link["bodies"] for p in solids_of(b)), carrier=i - 1)
        for i, link in enumerate(robot["links"])
    ]
    if moving.get("tool"):
        X = pose_of(robot["tool0"])
        solids = tuple(placed.at(X) for part in moving["tool"] for placed in solids_of(part))
        links.append(RigidBody(name="tool", solids=solids, carrier=last))
    bodies = [*links, *still]
    pairs = [(i, j) for i in range(1, len(links)) for j in range(len(links), len(bodies))]
    ignored = robot["ignored_pairs"]
    own = [
        (i, j)
        for j in range(len(links))
        for i in range(j)
        if ignored != "all" and [links[i].name, links[j].name] not in ignored
        and [links[j].name, links[i].name] not in ignored
    ]  # fmt: skip
    columns = [np.array(some, dtype=np.int64).reshape(-1, 2) for some in (pairs, own)]
    return MovingBodies(tree, bodies, columns[0]), MovingBodies(tree, bodies, columns[1]), way


def answer(case: Case, robots: Case) -> dict[str, Any]:
    """What the search says about a case, in the form in which it is compared with the truth."""
    among_still, among_itself, way = _scene(case, robots)
    found: list[Meeting] = [*among_still.search(way), *among_itself.search(way)]
    if found:
        first = min(found, key=lambda meeting: meeting.share)
        deepest = min(meeting.gap for meeting in found)
        answered: dict[str, Any] = {"collides": True, "first": first.share}
        if all(len(body.convexes.first) == 1 for body in among_still.bodies):
            answered["depth"] = -deepest / MM
        return answered
    answered = {"collides": False}
    for key, some in (("distance", among_still), ("self_distance", among_itself)):
        if len(some.pairs):
            answered[key] = some.least_gap(way) / MM
    return answered
