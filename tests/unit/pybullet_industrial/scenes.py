"""Small scripts with robots and tools, run with the original and with our module: the same calls, numbers out."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pybullet as p

_INERTIAL = (
    '<inertial><mass value="{m}"/><inertia ixx=".1" iyy=".1" izz=".1" ixy="0" ixz="0" iyz="0"/></inertial>'
    '<collision><geometry><box size=".04 .04 .04"/></geometry></collision>'
)


def _urdf(name: str, links: list[str], joints: list[tuple[str, str, str, str]], mass: float = 1.0) -> str:
    """A chain from link to link; each joint: name, type, axis, origin."""
    parts = [f'<link name="{link}">{_INERTIAL.format(m=mass)}</link>' for link in links]
    for number, (joint, kind, axis, origin) in enumerate(joints):
        parts.append(
            f'<joint name="{joint}" type="{kind}"><parent link="{links[number]}"/><child link="{links[number + 1]}"/>'
            f'<axis xyz="{axis}"/><origin xyz="{origin}"/>'
            '<limit lower="-2" upper="2" effort="1e3" velocity="3"/></joint>'
        )
    return f'<robot name="{name}">{"".join(parts)}</robot>'


_ARM = [
    ("j1", "revolute", "0 0 1", "0 0 .3"),
    ("j2", "revolute", "0 1 0", "0 0 .3"),
    ("j3", "revolute", "0 1 0", "0 0 .4"),
    ("j4", "revolute", "1 0 0", ".3 0 0"),
    ("j5", "revolute", "0 1 0", ".1 0 0"),
    ("j6", "revolute", "1 0 0", ".1 0 0"),
]
_FILES = {
    "arm.urdf": _urdf("arm", [f"link{k}" for k in range(7)], _ARM),
    "tool.urdf": _urdf("tool", ["base", "tip"], [("fixed", "fixed", "0 0 1", "0 0 .1")], 0.1),
    "fingers.urdf": _urdf(
        "fingers",
        ["base", "left", "right"],
        [("a", "prismatic", "0 1 0", "0 0 .1"), ("b", "prismatic", "0 1 0", "0 0 0")],
    ),
    "cart.urdf": _urdf(
        "cart", ["body", "l", "r"], [("wl", "continuous", "0 1 0", "0 .1 0"), ("wr", "continuous", "0 1 0", "0 -.2 0")]
    ),
}
UP = [0.0, 0.0, 0.0, 1.0]


@contextmanager
def client() -> Iterator[Callable[[str], str]]:
    """A client of its own; the result gives the paths of the models."""
    number = p.connect(p.DIRECT)
    try:
        with TemporaryDirectory() as folder:
            for name, text in _FILES.items():
                Path(folder, name).write_text(text)
            yield lambda name: str(Path(folder, name))
    finally:
        p.disconnect(number)


def _steps(count: int) -> None:
    for _ in range(count):
        p.stepSimulation()


def robot(pi: Any) -> list[float]:
    with client() as file:
        arm = pi.RobotBase(file("arm.urdf"), [0, 0, 0.1], UP)
        lower, upper = arm.get_joint_limits()
        out = [*lower.values(), *upper.values(), arm.get_moveable_joints()[1][-1], arm.number_of_joints]
        arm.set_joint_position({"j2": 0.4, "j3": -0.3, "j5": 0.2})
        _steps(100)
        out += arm.get_joint_position().values()
        arm.set_endeffector_pose([0.5, 0.1, 0.7], UP)
        _steps(100)
        for state in arm.get_joint_state().values():
            out += [state["position"], state["velocity"], state["torque"], *state["reaction force"]]
        out += [*arm.get_endeffector_pose()[0], *arm.get_endeffector_pose("link3")[1]]
        arm.reset_endeffector_pose([0.4, 0.2, 0.6])
        out += arm.get_joint_position().values()
        arm.reset_robot([1, 2, 3], UP, [0.1] * 6)
        out += [*arm.get_world_state()[0], *arm.get_endeffector_pose()[0]]
        arm.reset_joint_position({"j1": 1.0})
        return [*out, *arm.get_endeffector_pose()[0]]


def tool(pi: Any) -> list[float]:
    with client() as file:
        arm = pi.RobotBase(file("arm.urdf"), [0, 0, 0], UP)
        arm.reset_joint_position({"j2": 0.5, "j3": 0.5})
        own = pi.EndeffectorTool(file("tool.urdf"), [0.6, 0, 0.8], UP)
        own.couple(arm, "link6")
        _steps(50)
        out = [*own.get_tool_pose()[0], *own.get_tool_pose("tip")[1], float(own.is_coupled())]
        own.set_tool_pose(np.array([0.6, 0.1, 0.7]), np.array(UP))
        for _ in range(40):
            own.apply_tcp_force([0, 0, 5.0])
            own.apply_tcp_torque([0.1, 0, 0])
            p.stepSimulation()
        out += [*own.get_tool_pose()[0], *own.get_tool_pose()[1]]
        own.decouple()
        _steps(20)
        own.set_tool_pose([0.1, 0.2, 0.9], UP)
        _steps(60)
        return [*out, *own.get_tool_pose()[0], float(own.is_coupled())]


def rays(pi: Any) -> list[float]:
    """A block is printed over, milled and cleared."""
    with client() as file:
        np.random.seed(4)
        block = pi.spawn_material_block([0, 0, 0], [0.2, 0.1, 0.1], pi.MetalVoxel, {"particle size": 0.05})
        out = [float(len(block)), *block[0].get_position(), *block[-1].get_position()]
        head = {"opening angle": 0.2, "number of rays": 4, "maximum distance": 1.0, "material": pi.Plastic}
        extruder = pi.Extruder(
            file("tool.urdf"), [0.1, 0.05, 0.3], UP, {**head, "material properties": {"particle size": 0.01}}
        )
        for ball in extruder.extrude():
            out += ball.get_position()
        extruder.change_properties(
            {"material": pi.Paint, "material properties": {"particle size": 0.01, "color": [0, 1, 0, 1]}}
        )
        drops = extruder.extrude()
        for drop in drops:
            out += [*drop.get_position(), drop.target_id]
        remover = pi.Remover(file("tool.urdf"), [0.02, 0.02, 0.4], UP, {"maximum distance": 1.0})
        out += [*remover.calculate_process_force(None), *remover.remove()]
        mill = pi.MillingTool(
            file("tool.urdf"), [0.1, 0.15, -0.05], UP, {"diameter": 0.08, "height": 0.04, "number of rays": 3}
        )
        rays = mill.cast_rays(*mill.get_tool_pose())
        out += [float(ray[0]) for ray in rays]
        out += [*mill.get_cutting_state(rays)[1], *mill.force_model(0.2, [0.01, 0.0, 0.02, 0, 0], [0.1, 1, 2, 3, 4])]
        removed = list(dict.fromkeys(ray[0] for ray in rays if ray[0] != -1))
        return [*out, *removed, float(p.getNumBodies())]


def gripper(pi: Any) -> list[float]:
    with client() as file:
        fingers = pi.Gripper(file("fingers.urdf"), [0, 0, 1], UP)
        fingers.actuate(0.6)
        _steps(100)
        out = [p.getJointState(fingers.urdf, index)[0] for index in range(2)]
        arm = pi.RobotBase(file("arm.urdf"), [2, 0, 0], UP)
        cup = pi.SuctionGripper(file("tool.urdf"), [0, 0, 3], UP, arm)
        return [*out, float(len(cup.activate())), float(cup.is_coupled())]


def camera(pi: Any) -> list[float]:
    with client() as file:
        pi.spawn_material_block([0, 0, 1.2], [0.2, 0.1, 0.1], pi.Plastic, {"particle size": 0.1, "color": [1, 0, 0, 1]})
        eye = pi.Camera(file("tool.urdf"), [0.1, 0.05, 0.5], UP, {"width": 24, "height": 16, "fov": 50})
        eye.set_camera_parameters({"far plane distance": 10})
        image = eye.get_image()
        return [*image.shape, *image.astype(float).sum(axis=(0, 1)), *eye.projection_matrix]


def cart(pi: Any) -> list[float]:
    with client() as file:
        sizes = {"wheel_radius": 0.1, "track_width": 0.3, "max_linear_velocity": 0.6, "max_angular_velocity": 0.5}
        agv = pi.DiffDriveAGV(file("cart.urdf"), [0, 0, 0], UP, "wl", "wr", sizes)
        agv.set_target_pose(np.array([1, 0.5, 0]), p.getQuaternionFromEuler([0, 0, 1.0]))
        agv.update_position_loop()
        _steps(10)
        out = [p.getJointState(agv.urdf, index)[1] for index in range(2)]
        for distance, angle, error in ((2.0, 0.3, -0.2), (0.3, -2.0, 3.0), (0.01, 0.2, 0.001)):
            out += agv.standard_position_controller(distance, angle, error)
        agv.set_world_state([1, 2, 0], UP)
        return [*out, *agv.get_world_state()[0]]


def collisions(pi: Any) -> list[float]:
    with client() as file:
        arms = [pi.RobotBase(file("arm.urdf"), [x, 0, 0], UP) for x in (0.0, 0.03, 2.0)]
        checker = pi.CollisionChecker()
        out = [float(checker.is_collision_free()), float(checker.is_internal_collision_free())]
        out += [float(len(pairs)) for _, pairs in checker.get_external_collisions()]
        out += [checker.get_external_distance(1.0), checker.get_body_distance(0, 2, 3.0)]
        checker.set_safe_state()
        out.append(float(checker.is_collision_free()))
        arms[1].reset_joint_position({"j3": 0.9})
        out += [float(checker.is_external_collision_free()), float(len(checker.get_external_collisions()))]
        checker.ignore_external_body_collision((1, 0))
        checker.remove_body_id(2)
        out += [float(checker.is_external_collision_free())]
        checker.add_body_id(2)
        checker.clear_ignored_external_collision()
        checker.make_robot_static(0)
        out += [float(checker.is_external_collision_free()), float(len(checker.get_internal_collisions()))]
        touching = pi.CollisionChecker.get_bodies_external_collisions(0, 1)
        return [*out, *(float(link) for pair in touching for link in pair)]


def program(pi: Any) -> list[float]:
    """A program runs, is logged, simplified and written."""
    with client() as file:
        arm = pi.RobotBase(file("arm.urdf"), [0, 0, 0], UP)
        arm.reset_joint_position({"j2": 0.5, "j3": 0.5})
        calls: list[float] = []
        text = "% start\nG0 X0.5 Y0.1 Z0.6\n\nG1 X0.55 A0.1\nG17\nG2 X0.6 Y0.15 R0.1\nM3\nT1\nG54\nG1 X0.01\n"
        text += "G500\nG1 RA1=0.2 RA3=0.4"
        functions = {"3": [lambda: calls.append(3.0)]}
        runner = pi.GCodeProcessor(
            text, arm, None, functions, {"1": [lambda: calls.append(1.0)]}, interpolation_precision=0.02
        )
        logger = pi.GCodeLogger(arm)
        turns = 0
        for line in runner:
            turns += 1
            _steps(3)
            if line is not None:
                logger.update_g_code()
        out = [float(turns), *calls, *arm.get_endeffector_pose()[0]]
        lines = pi.GCodeSimplifier.round_pose_values(logger.g_code_robot_view, 3, 2)
        lines = pi.GCodeSimplifier.scale_g_code(lines, 1000.0, ["X", "Y", "Z"])
        lines = pi.GCodeSimplifier.apply_feedrate(pi.GCodeSimplifier.convert_to_degrees(lines), 0.5)
        lines = pi.GCodeSimplifier.skip_command(lines, {"G": 1})
        joints = pi.GCodeSimplifier.round_joint_positions(logger.g_code_joint_position, 3)
        pi.GCodeLogger.write_g_code(lines + joints, file("out.txt"), {"F0.5": "FEED"}, "begin", "end")
        path = pi.linear_interpolation([0, 0, 0], [1, 2, 3], 3, [0, 0, 0.6, 0.8])
        for line in pi.GCodeProcessor.tool_path_to_g_code(path):
            out += line.values()
        for line in pi.GCodeProcessor.joint_path_to_g_code(pi.JointPath(np.arange(4.0).reshape(2, 2), ["a", "b"])):
            out += line.values()
        return [*out, *(float(ord(sign)) for sign in Path(file("out.txt")).read_text())]


SCENES: dict[str, Callable[[Any], list[float]]] = {
    scene.__name__: scene for scene in (robot, tool, rays, gripper, camera, cart, collisions, program)
}
