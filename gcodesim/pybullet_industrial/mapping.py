"""What each name of PyBullet Industrial 1.0.4 is in gcodesim, and what differs; the page for those who move over."""

from __future__ import annotations

import ast
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Final

from gcodesim.frozen import frozen
from gcodesim.key_page import rewrite
from gcodesim.pybullet_industrial import MODULES

OWN_MODULE_NAMES: Final = {
    "interpolation": ("build_circular_path", "planar_circular_interpolation", "slerp"),
    "g_code_processor": ("JOINT_KEY",),
    "collision_checker": ("BASE_LINK", "MAX_DISTANCE_INTERNAL"),
}
"""Names that scripts import from the module rather than from the package."""


INHERITED: Final = {"Extruder": ("calculate_process_force",), "Remover": ("calculate_process_force",)}
"""Methods of a class that are those of a class in another module."""


@frozen
class Counterpart:
    """`ours`: with what gcodesim itself does the same, where it does. `differs`: what the module does otherwise."""

    ours: str = ""
    differs: str = ""


_RAY = "the force acts in axes of the working point, also where a `tcp_frame` is named"
_ONCE = f"each body is removed and returned once; {_RAY}"
_SINGLE_POINT = "a single point is the first one; the original divides by 0"
_ARC = f"{_SINGLE_POINT}, and where start and end are the same; that is a ValueError"
_PATHS = "`gcodesim.{}`: points as rows, other paths"

COUNTERPARTS: Final[dict[str, Counterpart]] = {
    "AGVRobot": Counterpart(ours="`externals:` whose axes carry a robot"),
    "DiffDriveAGV": Counterpart(differs="names of wheels that are missing are told with those that there are"),
    "CollisionChecker": Counterpart(ours="findings GS3xx of `check` and `run`, with the line and the depth"),
    "CollisionChecker.ignore_external_link_collision": Counterpart(
        differs="a pair of links belongs to the pair of bodies as it is given; the original sorts both, so that links "
        "can change sides"
    ),
    "CollisionChecker.remove_link_id": Counterpart(
        differs="the link is left out against other bodies too; the original goes on looking at it there"
    ),
    "CollisionChecker.get_body_distance": Counterpart(
        differs="the bodies may be given in any order; in the original links change sides if the second comes first"
    ),
    "CollisionChecker.add_body_id": Counterpart(
        differs="pairs that were ignored stay so; the original forgets those with a body that was removed in between"
    ),
    "EndeffectorTool": Counterpart(
        ours="`tools:` of a cell, by T and M6; `type: end_effector` is a body with a tip alone"
    ),
    "EndeffectorTool.couple": Counterpart(differs="a link that does not exist leaves the tool as it was"),
    "EndeffectorTool.is_coupled": Counterpart(differs="True and False instead of 1 and 0"),
    "EndeffectorTool.set_tool_pose": Counterpart(
        differs="without orientation the tool keeps its own; the original fails there"
    ),
    "Extruder": Counterpart(ours="`type: extruder`: volume by flow and speed, into the stock"),
    "Extruder.extrude": Counterpart(ours="`tool.extrude(path)` of a session", differs=_RAY),
    "RayCaster": Counterpart(ours="`type: laser`, `jet`, `sand_blaster`: footprints along rays"),
    "Remover": Counterpart(ours="mills and drills, which remove what they sweep"),
    "Remover.remove": Counterpart(differs=_ONCE),
    "MillingTool": Counterpart(
        ours="`type: flat_end_mill` and others: forces from the engagement, per tooth and height"
    ),
    "MillingTool.mill": Counterpart(differs=_ONCE),
    "MillingTool.force_model": Counterpart(
        differs="0 where nothing is cut or nothing moves; the original divides by 0 there"
    ),
    "Gripper": Counterpart(ours="`type: finger_gripper`"),
    "SuctionGripper": Counterpart(
        ours="`type: suction_gripper`: cups, pressure, leakage",
        differs="a link that does not exist is a ValueError with all names",
    ),
    "SuctionGripper.activate": Counterpart(
        differs="`tolerance` and `suction_links` count, and the robot that carries the gripper is never held; "
        "the original holds whatever is near"
    ),
    "SuctionGripper.deactivate": Counterpart(differs="may be called again; the original removes old constraints twice"),
    "Camera": Counterpart(ours="`sensors:` of a cell; `cell.camera(NAME).picture()`"),
    "GCodeProcessor": Counterpart(
        ours="`gcodesim run PROGRAM --cell CELL`; `gcodesim.read` for the path",
        differs="all functions of a code are called; the original calls the last one for each",
    ),
    "GCodeProcessor.read_g_code": Counterpart(
        ours="`gcodesim lint`", differs="a word without number is a ValueError with its line"
    ),
    "GCodeProcessor.tool_path_to_g_code": Counterpart(ours="`ToolPath.to_gcode`, as text for a control"),
    "GCodeLogger": Counterpart(ours="`gcodesim export LOG --to csv`"),
    "GCodeSimplifier": Counterpart(),
    "GCodeSimplifier.apply_feedrate": Counterpart(),
    "JointPath": Counterpart(ours="`arm.follow_joints(vectors)` of a session"),
    "ToolPath": Counterpart(
        ours="`gcodesim.ToolPath`: moves with feed and arcs; `moves()` and `of_moves()` convert",
        differs="besides, `moves` and `of_moves`",
    ),
    "ToolPath.translate": Counterpart(ours="`ToolPath.translate`, which returns a new path"),
    "ToolPath.rotate": Counterpart(
        ours="`ToolPath.rotate`, which returns a new path",
        differs="in double precision; the original has single (1e-7)",
    ),
    "ToolPath.draw": Counterpart(ours="`ToolPath.draw`, for matplotlib"),
    "linear_interpolation": Counterpart(ours=_PATHS.format("linear_interpolation")),
    "circular_interpolation": Counterpart(
        ours=_PATHS.format("circular_interpolation") + ", about axis 1 by the right hand",
        differs=_ARC,
    ),
    "spline_interpolation": Counterpart(
        ours=_PATHS.format("spline_interpolation") + ', by length unless `by="number"`'
    ),
    "build_box_path": Counterpart(
        ours="`gcodesim.build_box_path`: `angles` after `dimensions`, counterclockwise, exactly `samples` points",
        differs="turned in double precision; the original has single (1e-7). Where a corner has one point, it is the "
        "end of the side; in the original it is no number",
    ),
    "slerp": Counterpart(),
    "build_circular_path": Counterpart(differs=_SINGLE_POINT),
    "planar_circular_interpolation": Counterpart(differs=_ARC),
    "Particle": Counterpart(),
    "Plastic": Counterpart(ours="beads in the stock, which is milled and touched afterwards"),
    "Paint": Counterpart(ours="`type: spray_gun`: a film with thickness on stock and parts"),
    "Paint.get_position": Counterpart(
        differs="turns with a body that stood turned when it was painted; a drop on nothing stays where it is"
    ),
    "MetalVoxel": Counterpart(ours="`stock:` of a cell: columns with exact ends rather than cubes"),
    "spawn_material_block": Counterpart(ours="`stock: {box: …}`"),
    "RobotBase": Counterpart(ours="`robots:` of a cell; inverse kinematics in closed form"),
    "RobotBase.set_joint_position": Counterpart(
        ours="`arm.set_joint_position` of a session", differs="nothing is driven if one of the joints is wrong"
    ),
    "RobotBase.reset_joint_position": Counterpart(differs="nothing is moved if one of the joints is wrong"),
    "draw_coordinate_system": Counterpart(ours="`cell.draw_frame` of a session"),
    "draw_path": Counterpart(ours="the path in `run.mcap` and in the report; `cell.draw` of a session"),
    "draw_point": Counterpart(ours="`cell.draw` of a session"),
    "draw_robot_frames": Counterpart(ours="the frames in `run.mcap`"),
    "get_object_id_from_mouse": Counterpart(ours="a click in `gcodesim run --gui`"),
    "EndeffectorTool.apply_tcp_force": Counterpart(ours="`tool.apply_tcp_force` of a session; `load:` of a tool"),
    "EndeffectorTool.apply_tcp_torque": Counterpart(ours="the same, by `torque`"),
    "RobotBase.get_joint_state": Counterpart(ours="`arm.joint_state`"),
    "RobotBase.get_endeffector_pose": Counterpart(ours="`arm.endeffector_pose`"),
    "RobotBase.set_endeffector_pose": Counterpart(ours="`arm.set_endeffector_pose`"),
    "ToolPath.append": Counterpart(ours="`ToolPath.append`, which returns a new path"),
    "ToolPath.prepend": Counterpart(ours="`ToolPath.prepend`, which returns a new path"),
    "JOINT_KEY": Counterpart(),
    "BASE_LINK": Counterpart(),
    "MAX_DISTANCE_INTERNAL": Counterpart(),
}


def public_names() -> list[str]:
    """All names of the module: classes, functions, constants, and methods as `Class.method`; by module."""
    return [name for name, _ in _named()]


def page() -> str:
    """The table of all names, in Markdown."""
    lines = ["| PyBullet Industrial 1.0.4 | module | in gcodesim itself | what differs |", "|---|---|---|---|"]
    for name, module in _named():
        own = COUNTERPARTS.get(name, Counterpart())
        lines.append(f"| `{name}` | `{module}` | {own.ours} | {own.differs or 'nothing'} |")
    return "\n".join(lines)


def _named() -> Iterator[tuple[str, str]]:
    """Each name and its module. Sources are read, not imported: the page needs no pybullet."""
    for module, names in MODULES.items():
        tree = ast.parse(Path(__file__).with_name(f"{module}.py").read_text(encoding="utf-8"))
        classes = {node.name: node for node in tree.body if isinstance(node, ast.ClassDef)}
        for name in (*names, *OWN_MODULE_NAMES.get(module, ())):
            yield name, module
            if name in classes:
                yield from (
                    (f"{name}.{method}", module) for method in (*_methods(classes, name), *INHERITED.get(name, ()))
                )


def _methods(classes: dict[str, ast.ClassDef], name: str) -> list[str]:
    """Public methods of a class and of those above it in the same file, its own first."""
    own = classes[name]
    found = [node.name for node in own.body if isinstance(node, ast.FunctionDef) and not node.name.startswith("_")]
    for base in own.bases:
        if isinstance(base, ast.Name) and base.id in classes:
            found += [method for method in _methods(classes, base.id) if method not in found]
    return found


if __name__ == "__main__":
    rewrite(Path(sys.argv[1]), page())
