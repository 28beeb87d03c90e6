"""PyBullet Industrial's own names, for scripts that move over: `import gcodesim.pybullet_industrial as pi`.

Names, argument order, shapes and defaults are those of its version 1.0.4, in modules of the same names. What differs is
listed for every name in `docs/coming-from-pybullet-industrial.md`. Robots and tools live in the client to which
the script has connected pybullet; paths need no pybullet. Names are imported on first use.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any, Final

MODULES: Final = {
    "agv_robots": ("AGVRobot", "DiffDriveAGV"),
    "collision_checker": ("CollisionChecker",),
    "endeffector_tool": ("EndeffectorTool",),
    "extruder": ("Extruder",),
    "g_code_logger": ("GCodeLogger",),
    "g_code_processor": ("GCodeProcessor",),
    "g_code_simplifier": ("GCodeSimplifier",),
    "gripper": ("Gripper", "SuctionGripper"),
    "interpolation": ("circular_interpolation", "linear_interpolation", "spline_interpolation"),
    "joint_path": ("JointPath",),
    "material": ("MetalVoxel", "Paint", "Particle", "Plastic", "spawn_material_block"),
    "milling_tool": ("MillingTool",),
    "path_builders": ("build_box_path",),
    "raycaster": ("RayCaster",),
    "remover": ("Remover",),
    "robot_base": ("RobotBase",),
    "sensors": ("Camera",),
    "toolpath": ("ToolPath",),
    "utility": ("draw_coordinate_system", "draw_path", "draw_point", "draw_robot_frames", "get_object_id_from_mouse"),
}
"""What each module gives to the package."""

_PLACES: Final = {name: module for module, names in MODULES.items() for name in names}

__all__ = sorted(_PLACES)


def __getattr__(name: str) -> Any:
    if name in MODULES:
        return import_module(f"{__name__}.{name}")
    if name not in _PLACES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_PLACES[name]}"), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *_PLACES, *MODULES})
