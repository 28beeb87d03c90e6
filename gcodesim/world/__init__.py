"""Worlds: they move the robot and say what effort that takes; `kinematic` and `bullet` behind one protocol."""

from __future__ import annotations

from typing import Any, Final

import numpy as np

from gcodesim.controllers.controller import Controller
from gcodesim.controllers.flexible import Flexible
from gcodesim.controllers.ideal import Ideal
from gcodesim.family import Family, object_at
from gcodesim.frames import Array
from gcodesim.world.body import RobotBody, ToolBody, tool_body
from gcodesim.world.falling import fall_of
from gcodesim.world.protocol import STANDARD_GRAVITY, Couple, NotAtOnce, World, WorldSteps, WorldUnavailable

WORLDS = Family(
    "worlds",
    kinematic="gcodesim.world.kinematic:KinematicWorld",
    bullet="gcodesim.world.bullet:BulletWorld",
)


DRIVEN: Final = {
    "kinematic": "gcodesim.world.driven:DrivenWorld",
    "bullet": "gcodesim.world.driven_bullet:DrivenBulletWorld",
}
"""The same worlds where motors obey a controller."""

_PLACES_ALONE: Final = "gcodesim.world.commanded:CommandedWorld"


def open_world(
    name: str,
    robot: RobotBody,
    step_ns: int,
    *,
    gravity: tuple[float, float, float] = STANDARD_GRAVITY,
    efforts: bool = True,
) -> World:
    """Open the world `name` of WORLDS around one robot or machine; the caller closes it.

    `step_ns` is the fixed step in whole nanoseconds, `gravity` [m/s²] in W. What stands around the machine is no part
    of a world: `checks` find what it runs into. Without `efforts`, a kinematic world whose motors keep to their command
    tells places alone. Raises `WorldUnavailable` when the world
    needs something that is not installed, KeyError for an unknown name.
    """
    if step_ns <= 0:
        raise ValueError(f"the step is {step_ns} ns; it has to be positive")
    if robot.controller.law != "ideal":
        kind: Any = object_at(DRIVEN[name])
    elif name == "kinematic" and not efforts:
        kind = object_at(_PLACES_ALONE)
    else:
        kind = WORLDS[name]
    world: World = kind(robot, step_ns, gravity=gravity)
    return world


def usual_controller(name: str, stiffness: Array | None) -> Controller:
    """The controller of a robot with gears of `stiffness` (j,) in the world `name`, where its cell names none.

    In `bullet` gears are what they are: springs on which links swing by the process. Its control feeds its own motion
    forward, so that what is asked of joints is the same as in the kinematic world.
    """
    if name != "bullet" or stiffness is None or not np.isfinite(stiffness).any():
        return Ideal()
    return Flexible(feed_forward=True)


def require_world(name: str) -> None:
    """Raise `WorldUnavailable` when the world `name` of WORLDS needs something that is not installed."""
    require = getattr(WORLDS[name], "require", None)
    if require is not None:
        require()


__all__ = [
    "DRIVEN",
    "STANDARD_GRAVITY",
    "WORLDS",
    "Couple",
    "NotAtOnce",
    "RobotBody",
    "ToolBody",
    "World",
    "WorldSteps",
    "WorldUnavailable",
    "fall_of",
    "open_world",
    "require_world",
    "tool_body",
    "usual_controller",
]
