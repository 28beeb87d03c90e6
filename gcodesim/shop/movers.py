"""Machine tools and robots of a cell as movers of the scene."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from gcodesim.cell.machine import MachineTool
from gcodesim.cell.placing import MACHINE
from gcodesim.cell.robot import Payload, Robot
from gcodesim.kinematics import Cartesian, Chain, Inertial, Kinematics, Link, kinematics_of, model_path
from gcodesim.scene import Mover

if TYPE_CHECKING:
    from gcodesim.controllers import Controller


def mover_of(description: MachineTool | Robot) -> Mover:
    return _machine(description) if isinstance(description, MachineTool) else _robot(description)


def _machine(tool: MachineTool) -> Mover:
    """A machine tool as a mover of the scene; it counts as rigid."""
    kinematics = kinematics_of(tool.chain)
    homes = {axis.letter: axis.home for axis in tool.axes}
    return Mover(
        name=MACHINE,
        kinematics=kinematics,
        X_WB=tool.X_WB,
        home=np.array([homes[letter] for letter in kinematics.joints.names]),
        joints_are_axes=True,
        rapids=tool.rapids,
        retreat=np.array([0.0, 0.0, 1.0]),
        timed_only=tuple(axis.letter for axis in tool.axes if axis.rotary and axis.at is None),
        seen_whole=False,
        lathe=tool.lathe,
        own_table=tool.own_table,
        description=None if tool.model is None else model_path(tool.model),
    )


def _robot(robot: Robot) -> Mover:
    """A robot as a mover of the scene."""
    kinematics = kinematics_of(_loaded(robot.chain, robot.payload))
    home = np.array(robot.home)
    stiffness = None if robot.stiffness is None else np.array(robot.stiffness)
    outside: tuple[str, ...] = ()
    if robot.externals:
        from gcodesim.kinematics.assembly import Assembly

        assembly = Assembly.of(kinematics, [external.carrier(robot.X_WB) for external in robot.externals])
        outside = tuple(assembly.joints.names[i] for i in assembly.externals)
        homes = {
            f"{external.name}/{letter}": at
            for external in robot.externals
            for letter, at in zip(external.axes, external.homes, strict=True)
        }
        home = assembly.together(home[None], np.array([[homes[name] for name in outside]]))[0]
        if stiffness is not None:  # carriages and tables count as rigid
            stiffness = assembly.together(stiffness[None], np.full((1, len(outside)), np.inf))[0]
        kinematics = assembly
    return Mover(
        name=robot.name,
        kinematics=kinematics,
        X_WB=robot.X_WB,
        home=home,
        stiffness=stiffness,
        externals=outside,
        seen_whole=not isinstance(kinematics, Cartesian),
        description=robot.description,
        controller=controller_of(robot.controller, kinematics),
        may_meet=robot.allow_collisions,
    )


def controller_of(controller: Controller | None, kinematics: Kinematics) -> Controller | None:
    """The same for all joints that move, external axes among them: it has no values for those. None stays None."""
    from gcodesim.kinematics.assembly import Assembly

    if controller is None or not isinstance(kinematics, Assembly):
        return controller
    return controller.of_joints(kinematics.own, len(kinematics.joints))


def _loaded(chain: Chain, payload: Payload | None) -> Chain:
    """The chain together with what hangs on its flange besides the tool."""
    if payload is None:
        return chain
    flange = next(link for link in chain.links if link.name == chain.flange)
    if flange.inertial is not None and flange.inertial.mass > 0.0:
        raise AssertionError("a flange with a mass of its own cannot take a payload")
    carried = Inertial(mass=payload.mass, com=np.array(payload.xyz), inertia=np.zeros((3, 3)))
    links = tuple(
        Link(name=link.name, inertial=carried, visuals=link.visuals, collisions=link.collisions)
        if link is flange
        else link
        for link in chain.links
    )
    return replace(chain, links=links)
