"""Calls with drawn arguments, made with the original and with our module: each gives what both are to agree on."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pybullet as p

from tests.unit.pybullet_industrial.scenes import UP, client

Draw = np.random.Generator
KINDS: tuple[Callable[[Any], Any], ...] = (list, tuple, np.array)
JOINTS = [f"j{number}" for number in range(1, 7)]


def _quaternion(draw: Draw) -> np.ndarray:
    values = draw.normal(size=4)
    return values / np.linalg.norm(values)


def _given(draw: Draw, values: Any) -> Any:
    """The same numbers as a list, a tuple or an array."""
    return KINDS[draw.integers(3)](np.asarray(values).tolist())


def _maybe(draw: Draw, *choices: Sequence[Any]) -> Sequence[Any]:
    return choices[draw.integers(len(choices))]


def _columns(path: Any) -> list[Any]:
    return [np.asarray(rows, dtype=float) for rows in (path.positions, path.orientations, path.tool_activations)]


def line(pi: Any, draw: Draw) -> Any:
    start, end = draw.normal(size=(2, 3))
    turns = [_given(draw, scale * _quaternion(draw)) for scale in draw.uniform(-3, 3, draw.integers(3))]
    return _columns(pi.linear_interpolation(_given(draw, start), _given(draw, end), int(draw.integers(1, 12)), *turns))


def arc(pi: Any, draw: Draw) -> Any:
    start, end = draw.normal(size=(2, 3))
    axis = int(draw.integers(3))
    radius = draw.choice([0.3, 0.5001, 0.9, 4.0]) * np.linalg.norm(np.delete(end - start, axis))
    turns = _maybe(draw, [], [_quaternion(draw)], [_quaternion(draw), _quaternion(draw)])
    samples = int(draw.integers(2, 12))
    return _columns(pi.circular_interpolation(start, end, radius, samples, axis, bool(draw.integers(2)), *turns))


def turn(pi: Any, draw: Draw) -> Any:
    first, last = _quaternion(draw), _quaternion(draw)
    last = _maybe(draw, last, -first, first, 0.2 * last)
    shares = _maybe(draw, draw.uniform(0, 1, 5), draw.uniform(-1, 2, 3), [0.2, 0.1], float(draw.uniform(0, 1)))
    return importlib.import_module(f"{pi.__name__}.interpolation").slerp(_given(draw, first), last, shares)


def spline(pi: Any, draw: Draw) -> Any:
    points = draw.normal(size=(3, int(draw.integers(1, 9))))
    return _columns(pi.spline_interpolation(_maybe(draw, points, points.tolist()), int(draw.integers(1, 20))))


def path(pi: Any, draw: Draw) -> Any:
    """A path, also of lists, of whole numbers or of arrays that do not fit, is changed a few times."""
    count = int(draw.integers(1, 6))
    positions: Any = _maybe(draw, draw.normal(size=(3, count)), draw.integers(-3, 3, size=(3, count)))
    orientations: Any = np.array([_quaternion(draw) for _ in range(count)]).T
    if draw.integers(3) == 0:
        positions, orientations = positions.tolist(), orientations.tolist()
    made = pi.ToolPath(positions, *_maybe(draw, [], [orientations], [None, [1] * int(draw.integers(count, count + 2))]))
    other = pi.linear_interpolation([0, 0, 0], [1, 2, 3], 3, _quaternion(draw))
    out: list[Any] = []
    for number in draw.integers(6, size=4):
        changes: tuple[Callable[[], Any], ...] = (
            lambda: made.translate(_given(draw, draw.normal(size=3))),
            lambda: made.rotate(_given(draw, 3 * _quaternion(draw))),
            lambda: made.append(_maybe(draw, [other], [made])[0]),
            lambda: made.prepend(other),
            lambda: out.extend(np.array(part) for part in made.get_start_pose()),
            lambda: out.extend([np.array(at), np.array(turned), float(on)] for at, turned, on in made),
        )
        changes[number]()
    return [len(made), *out, *_columns(made), np.asarray(positions, dtype=float)]


def _program(draw: Draw) -> str:
    def words(letters: str, least: float, greatest: float, share: float) -> str:
        return " ".join(f"{w}{draw.uniform(least, greatest):.4f}" for w in letters if draw.uniform() < share)

    kinds = (
        lambda: (
            f"G{draw.integers(2)} {words('XZ', 0.3, 0.7, 0.6)} {words('Y', -0.2, 0.2, 0.5)} {words('ABC', -1, 1, 0.3)}"
        ),
        lambda: f"G{draw.integers(2, 4)} {words('XYZ', 0.0, 0.6, 0.7)} R{draw.uniform(0.1, 1.0):.3f}",
        lambda: f"G{draw.choice([17, 18, 19, 54, 500, 4])}",
        lambda: f"{draw.choice(['M', 'T'])}{draw.integers(1, 4)}",
        lambda: "G1 RA1={:.2f} RA3={:.2f}".format(*draw.uniform(-0.5, 0.5, 2)),
        lambda: str(draw.choice(["% text", "", "g1 x.5", "G1 U1", "X0.4", "G1", "G1X0.5", "F0.5"])),
    )
    return "\n".join(kinds[draw.integers(len(kinds))]() for _ in range(6))


def program(pi: Any, draw: Draw) -> Any:
    """A program moves an arm and a tool; what it does up to a fault counts too."""
    with client() as file:
        arm = pi.RobotBase(file("arm.urdf"), [0, 0, 0], UP)
        arm.reset_joint_position({"j2": 0.5, "j3": 0.5})
        tool = pi.EndeffectorTool(file("tool.urdf"), [0.6, 0, 0.8], UP)
        out: list[Any] = []
        tools = {"1": [lambda: None if tool.is_coupled() else tool.couple(arm)], "2": [tool.decouple]}
        offset = np.array([draw.uniform(-0.1, 0.1, 3), draw.uniform(-0.3, 0.3, 3)]) * draw.integers(2)
        given = (_maybe(draw, [tool], [None])[0] and [tool], {"1": [lambda: out.append(1.0)], "3": []}, tools, offset)
        runner = pi.GCodeProcessor(_program(draw), arm, *given, interpolation_precision=0.05)
        try:
            for number, words in zip(range(120), runner, strict=False):
                if words is not None:
                    out.append(words)
                if number % 5 == 0:
                    p.stepSimulation()
                    out += arm.get_joint_position().values()
        except (KeyError, ValueError, TypeError, RuntimeWarning):  # the last: where the original divides by 0
            out.append("fault")
        return out


def robot(pi: Any, draw: Draw) -> Any:
    with client() as file:
        base = _given(draw, draw.uniform(-1, 1, 3)), _given(draw, _quaternion(draw))
        arm = pi.RobotBase(file("arm.urdf"), *base, *_maybe(draw, [], ["link4"], ["none"]))
        out: list[Any] = []
        for number in draw.integers(8, size=8):
            joints = {name: float(draw.uniform(-1.9, 1.9)) for name in JOINTS if draw.integers(2)}
            place = _given(draw, draw.uniform(-0.5, 0.5, 3))
            pose = [place, *_maybe(draw, [], [_quaternion(draw)], [_quaternion(draw), "link5"], [None, "link3"])]
            link = _maybe(draw, [], ["link2"])
            calls: tuple[Callable[[], Any], ...] = (
                lambda joints=joints: arm.set_joint_position(joints),
                lambda joints=joints: arm.reset_joint_position(joints),
                lambda pose=pose: arm.set_endeffector_pose(*pose),
                lambda pose=pose: arm.reset_endeffector_pose(*pose),
                lambda place=place: arm.reset_robot(place, UP, *_maybe(draw, [], [draw.uniform(-1, 1, 6)])),
                lambda place=place: arm.set_world_state(place, _quaternion(draw)),
                lambda out=out: out.append([arm.get_joint_limits(), arm.get_moveable_joints(), arm.get_world_state()]),
                lambda out=out, link=link: out.append([arm.get_endeffector_pose(*link), arm.get_joint_state()]),
            )
            calls[number]()
            for _ in range(int(draw.integers(20))):
                p.stepSimulation()
            out += arm.get_joint_position().values()
        return out


def tool(pi: Any, draw: Draw) -> Any:
    with client() as file:
        arms = [pi.RobotBase(file("arm.urdf"), [x, 0, 0], UP) for x in (0, 3)]
        arms[0].reset_joint_position({"j2": 0.5, "j3": 0.5})
        frames = _maybe(draw, [], [arms[0]], [None, "tip"], [None, None, "tip"], [None, "none"])
        held = pi.EndeffectorTool(file("tool.urdf"), [0.6, 0, 0.8], _given(draw, _quaternion(draw)), *frames)
        out: list[Any] = []
        for number in draw.integers(7, size=8):
            force, near = _given(draw, draw.normal(size=3)), np.array([0.5, 0.1, 0.6]) + draw.uniform(-0.1, 0.1, 3)
            calls: tuple[Callable[[], Any], ...] = (
                lambda: held.couple(arms[0]),
                lambda: held.couple(arms[1], "link3"),
                held.decouple,
                lambda near=near: held.set_tool_pose(near, _quaternion(draw)),
                lambda force=force: held.apply_tcp_force(force, *_maybe(draw, [], [True], [False])),
                lambda force=force: held.apply_tcp_torque(force),
                lambda: out.append(held.get_tool_pose(*_maybe(draw, [], ["tip"], ["none"], [7]))),
            )
            try:
                calls[number]()
            except (ValueError, TypeError):
                out.append("fault")
            for _ in range(int(draw.integers(1, 20))):
                p.stepSimulation()
            out.append([float(held.is_coupled()), held.get_tool_pose()])
        return out


DRAWN: dict[str, Callable[[Any, Draw], Any]] = {
    function.__name__: function for function in (line, arc, turn, spline, path, program, robot, tool)
}
