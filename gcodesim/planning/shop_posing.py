"""Which posing the machine of a shop needs."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gcodesim.arithmetic.matrices import applied, dot, norm
from gcodesim.cell.arm_point import attitude_of
from gcodesim.cell.externals import columns_of
from gcodesim.cell.signal_values import value_after
from gcodesim.frames import Array, Pose
from gcodesim.kinematics.attitude import WordTurns
from gcodesim.kinematics.branch_names import branches_named
from gcodesim.kinematics.cartesian import Cartesian
from gcodesim.kinematics.dynamics import GRAVITY
from gcodesim.kinematics.tool_point import ToolPoint
from gcodesim.planning.axis_attitude import AxisAttitude
from gcodesim.planning.axis_posing import AxisPosing
from gcodesim.planning.posing import Posing
from gcodesim.shop import Shop
from gcodesim.solids import triangles_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from gcodesim.kinematics.attitude import AttitudeLaw
    from gcodesim.planning.bearers import Bearers
    from gcodesim.planning.borne_work import BorneWork
    from gcodesim.planning.fixed_attitude import FixedAttitude
    from gcodesim.planning.grips import Grips
    from gcodesim.planning.guide import Outside
    from gcodesim.planning.loads import Loads, Motors, TipPush
    from gcodesim.planning.obstacles import Obstacles
    from gcodesim.planning.plan import Plan
    from gcodesim.planning.stands import Stands
    from gcodesim.planning.surface_axis import SurfaceAxis
    from gcodesim.tools.tool import Tool


def posing_of(shop: Shop, obstacles: Obstacles | None = None, borne: BorneWork | None = None) -> Posing:
    """A machine whose joints are the axes is commanded by them; an arm holds the tool as the cell says.

    What an arm chooses keeps clear of `obstacles`. Work that others move is where `borne` says, else as at the start.
    """
    if shop.mover.joints_are_axes:
        independent = shop.mover.rapids == "independent"
        tool = ToolPoint.of(shop.kinematics)
        if tool is None and isinstance(shop.kinematics, Cartesian) and np.isfinite(shop.kinematics.joints.jerk).any():
            tool = ToolPoint(shop.kinematics)  # which cuts the path into segments; the tip is never commanded
        if tool is None:
            return AxisPosing(independent_rapids=independent)
        return AxisAttitude(tool=tool, independent_rapids=independent, surface=_surface(shop))
    return _fixed_attitude(shop, obstacles, borne)


def _fixed_attitude(shop: Shop, obstacles: Obstacles | None, borne: BorneWork | None) -> FixedAttitude:
    """The frame O for every work system, in base axes: T's Z is along the axis that the cell names."""
    from gcodesim.planning.fixed_attitude import FixedAttitude

    own = shop.cell.channels[shop.channel].orientation
    R_BW = shop.X_WB.inverse().R
    frames = {
        system: _upright(applied(R_BW, shop.placement.tool_axis(own, system)), shop, system)
        for system in shop.placement.work_offsets
    }
    law = attitude_of(shop.cell, shop.channel, shop.placement)
    words = isinstance(law, WordTurns)
    surface = _surface(shop)
    X_BP = {system: shop.X_BM @ X_MP for system, X_MP in shop.placement.work_offsets.items()}
    spin = None if own is None else own.spin
    if spin is None and isinstance(law, WordTurns) and len(law.turns) == len("ABC"):
        spin = 0.0
    outside = _outside(shop, law)
    names = [] if outside is None else [f"{shop.name}/{link}" for link in outside.assembly.platforms]
    return FixedAttitude(
        frames=frames,
        upright=frames[1],
        spin=spin,
        X_BM=shop.X_BM,
        branches=_branches(shop),
        law=law,
        words_lean=words or surface is not None,
        surface=surface,
        axes={system: X.R if words else shop.X_BM.R for system, X in X_BP.items()},
        outside=outside,
        loads=loads_of(shop),
        platforms={system: names.index(link) for system, link in shop.placement.platforms.items()},
        bends={n: X.inverse().matrix for n, tool in shop.cell.tools.items() if (X := tool.X_FN) is not None},
        stands=_stands(shop, outside),
        obstacles=obstacles,
        grips=_grips(shop),
        borne=borne or _borne_at_home(shop),
    )


def bearers_of(shop: Shop, plans: Mapping[str, Plan]) -> Bearers | None:
    """What bears the work systems of a shop that others move, by their plans; None where there is nothing like that."""
    borne = shop.placement.borne
    if not borne:
        return None
    from gcodesim.planning.bearers import Bearers

    return Bearers(scene=shop.scene, links=borne, zero=shop.cell.platforms, plans=plans)


def _borne_at_home(shop: Shop) -> BorneWork | None:
    bearers = bearers_of(shop, {})
    return None if bearers is None else bearers.after_waits((), shop.X_WB)


def _grips(shop: Shop) -> Grips | None:
    """What the grippers of the arm may hold; None where there is none, or no part."""
    from gcodesim.processes.gripping import GRIP
    from gcodesim.tools.gripper import Gripper

    grippers = {number: tool for number, tool in shop.cell.tools.items() if isinstance(tool, Gripper)}
    if not grippers or not shop.cell.parts:
        return None
    from gcodesim.planning.grips import Grips

    return Grips(
        scene=shop.scene,
        mover=shop.name,
        flange=f"{shop.name}/{shop.kinematics.chain.flange_name}",
        grippers=grippers,
        words=lambda event: value_after(event, GRIP, shop.signal_sources),
    )


def _surface(shop: Shop) -> SurfaceAxis | None:
    """The surface on whose normal the tool stands; None without one."""
    from gcodesim.cell.surfaces import surface_of

    own = shop.cell.channels[shop.channel].orientation
    found = surface_of(shop.cell, shop.placement, shop.channel)
    if own is None or found is None:
        return None
    from gcodesim.material.mesh import outward
    from gcodesim.material.skin_normals import SkinNormals
    from gcodesim.planning.surface_axis import SurfaceAxis

    solid, X_MS = found
    mesh = triangles_of(solid)
    points, faces = outward(X_MS.apply(mesh.points), mesh.faces)
    return SurfaceAxis(
        name=str(own.tool_axis.surface),
        skin=SkinNormals.of(points, faces),
        lead=own.lead,
        tilt=own.tilt,
        smooth=own.smooth,
        within=own.within,
    )


def _stands(shop: Shop, outside: Outside | None) -> Stands | None:
    """The stands of the magazine, seen from the base; None where there are none."""
    from gcodesim.planning.stands import StandPlace, Stands

    places = {}
    for number, spec in shop.cell.magazine.stands.items():
        X_BF = shop.X_WB.inverse() @ shop.stand(number)
        slide = applied(shop.X_WB.R.T, shop.stand_axes(number, np.array(spec.slide)))
        back = X_BF @ Pose.from_xyz_rpy((0.0, 0.0, -spec.approach))
        places[number] = StandPlace(coupled=X_BF.matrix, back=back.matrix, out=Pose(X_BF.p + slide, X_BF.R).matrix)
    loaded = shop.cell.channels[shop.channel].loaded_tool or 0
    return Stands(places=places, mounted=loaded, away=frozenset({loaded}), outside=outside) if places else None


def loads_of(shop: Shop) -> Loads:
    """What the motors of the shop's robot bear: its links, its payload, each of the tools and what acts on it."""
    from gcodesim.planning.loads import Loads
    from gcodesim.world.body import tool_body
    from gcodesim.world.payload import payload_of

    return Loads(
        chain=shop.kinematics.chain,
        gravity=applied(shop.X_WB.inverse().R, np.array(GRAVITY)),
        tools={number: payload_of(tool_body(tool)) for number, tool in shop.cell.tools.items()},
        pushes={number: push for number, tool in shop.cell.tools.items() if (push := _push_of(tool, shop)) is not None},
        motors=_motors_of(shop),
    )


def _push_of(tool: Tool, shop: Shop) -> TipPush | None:
    """What acts on the tip of `tool`: its constant load, and the force that its work is expected to make."""
    from gcodesim.planning.loads import TipPush

    if tool.load is None and tool.expected_force is None:
        return None
    force = tool.expected_force or 0.0
    if tool.load is None:
        return TipPush(X_FT=tool.X_FT, force=force)
    own = np.array([*tool.load.force, *tool.load.torque])
    turns = tool.load.frame == "tool"
    R_BW = shop.X_WB.inverse().R
    wrench = own if turns else np.concatenate([applied(R_BW, own[:3]), applied(R_BW, own[3:])])
    return TipPush(X_FT=tool.X_FT, wrench=wrench, turns=turns, force=force)


def _motors_of(shop: Shop) -> Motors | None:
    """Friction and rotors that the controller of the robot says; None of an ideal one, and where there is none."""
    from gcodesim.planning.loads import Motors
    from gcodesim.world.driven import friction_of, rotors_of

    own, joints = shop.mover.controller, shop.kinematics.chain.driven_joints
    if own is None or own.law == "ideal":
        return None
    coulomb, viscous = friction_of(own, joints)
    return Motors(coulomb=coulomb, viscous=viscous, rotor=rotors_of(own, joints.effort))


def _outside(shop: Shop, law: AttitudeLaw | None) -> Outside | None:
    """The external axes of the robot; None without any."""
    from gcodesim.kinematics.assembly import Assembly
    from gcodesim.planning.guide import CHOSEN, Outside

    assembly = shop.kinematics
    if not isinstance(assembly, Assembly):
        return None
    leaning = [turn.word for turn in law.turns] if isinstance(law, WordTurns) else []
    columns = columns_of(shop.cell.robots[shop.name].externals, leaning)
    names = [assembly.joints.names[joint] for joint in assembly.externals]
    return Outside(
        assembly=assembly,
        columns=np.array([columns.get(name.rpartition("/")[2], CHOSEN) for name in names], dtype=np.int64),
        rest=shop.home[assembly.externals],
    )


def _branches(shop: Shop) -> tuple[int, ...] | None:
    """Those that `configuration` of the robot allows; None where it says nothing."""
    from gcodesim.kinematics.assembly import Assembly
    from gcodesim.kinematics.closed_form import ClosedForm

    robot = shop.cell.robots.get(shop.name)
    arm = shop.kinematics.arm if isinstance(shop.kinematics, Assembly) else shop.kinematics
    if robot is None or not robot.configuration or not isinstance(arm, ClosedForm):
        return None
    return branches_named(arm.arm, robot.configuration)


def _upright(axis_B: Array, shop: Shop, system: int) -> Array:
    """Axes of the frame O (3, 3) whose −Z is the tool axis; its X is as near as possible to that of the work system."""
    z = -axis_B / norm(axis_B)
    R_BP = (shop.X_BM @ shop.placement.work_offsets[system]).R
    x = R_BP[:, 0] - dot(R_BP[:, 0], z) * z
    if norm(x) < 1e-6:
        x = R_BP[:, 1] - dot(R_BP[:, 1], z) * z
    x = x / norm(x)
    return np.column_stack([x, np.cross(z, x), z])
