"""Where the frames of a cell stand, and which bodies stand in them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np

from gcodesim.canon.systems import SYSTEMS
from gcodesim.cell import Cell, Placement
from gcodesim.cell.part import PartSpec
from gcodesim.cell.placement import DEVICE, FIXTURE, PART, SENSOR, STOCK
from gcodesim.cell.placing import MACHINE
from gcodesim.cell.stock import solid_of
from gcodesim.frames import WORLD, Pose
from gcodesim.kinematics import Cartesian
from gcodesim.scene import WORK, Body, Mover, Scene, Stand
from gcodesim.shop.movers import mover_of
from gcodesim.solids import Hulls, Placed, Solid
from gcodesim.tools.body import STEEL_DENSITY

BODIES: Final = "bodies"
"""The world as it is with all axes at zero, carried by the table if there is one: here fixtures and stocks rest."""

WORK_FRAME: Final = "G54"
"""Where the log draws the frame `stock` of a cell without one."""


def scene_of(cell: Cell, mover: Mover, placement: Placement) -> Scene:
    """The frames of a cell. Whatever names no link stands on the side that carries the work, with all axes at zero."""
    frames = {
        WORK_FRAME: _system_stand(cell, mover, placement),
        BODIES: work_stand(mover, Pose.identity()),
        **{f"{STOCK}/{name}": work_stand(mover, X_WS) for name, X_WS in placement.stocks.items()},
        **{f"{FIXTURE}/{name}": work_stand(mover, X_W) for name, X_W in placement.fixtures.items()},
        **{f"{PART}/{name}": work_stand(mover, X_W) for name, X_W in placement.parts.items()},
        **{f"{SENSOR}/{name}": _sensor_stand(cell, name, mover, X_W) for name, X_W in placement.sensors.items()},
        **{f"{DEVICE}/{name}": Stand(WORLD, X_W) for name, X_W in placement.devices.items()},
        **{name: Stand(on.link, on.X) for name, on in placement.carried.items()},
    }
    movers = {mover.name: mover}
    for link in (*(on.link for on in placement.carried.values()), *placement.borne.values()):
        name = link.partition("/")[0]
        if name not in movers:
            movers[name] = mover_of(cell.machine if name == MACHINE and cell.machine else cell.robots[name])
    return Scene(movers=movers, frames=frames, bodies=(*_links(mover), *_standing(cell)))


def _system_stand(cell: Cell, mover: Mover, placement: Placement) -> Stand:
    """The stand of G54; on what an external axis carries it moves with that."""
    link = placement.platforms.get(1) or placement.borne.get(1)
    if link is None:
        return work_stand(mover, placement.X_W("G54"))
    return Stand(link, cell.platforms[link].inverse() @ placement.X_W("G54"))


def work_stand(mover: Mover, X_W: Pose) -> Stand:
    """The stand of something at `X_W` in the world while the axes are at zero; it moves with a moving table."""
    if isinstance(mover.kinematics, Cartesian) and mover.moves(WORK):
        own = mover.own_table
        if own is None:
            return Stand(f"{mover.name}/{WORK}", mover.X_WB.inverse() @ X_W)
        if mover.moves(own):
            still = np.zeros((1, len(mover.kinematics.joints)))
            X_WT = mover.X_WB @ Pose.from_matrix(mover.seen_from_base(own, still)[0])
            return Stand(f"{mover.name}/{own}", X_WT.inverse() @ X_W)
    return Stand(WORLD, X_W)


def _sensor_stand(cell: Cell, name: str, mover: Mover, X_W: Pose) -> Stand:
    """A sensor moves with a moving table only if it stands in a work system."""
    in_work = cell.sensors[name].mount.place.frame in SYSTEMS
    return work_stand(mover, X_W) if in_work else Stand(WORLD, X_W)


def _links(mover: Mover) -> Iterator[Body]:
    """The links of a mover that have a shape; the root is its base."""
    shapes: dict[int, list[Placed]] = {}
    for shape in mover.kinematics.link_shapes:
        shapes.setdefault(shape.link, []).append(shape.placed)
    for index, solids in sorted(shapes.items()):
        link = mover.kinematics.link_names[index] if index else mover.kinematics.chain.base_name
        yield Body(name=f"{mover.name}/{link}", solids=tuple(solids), role="link")


def _standing(cell: Cell) -> Iterator[Body]:
    """Stocks, in their shape at the start, fixtures, devices, and parts."""
    for name, stock in cell.stocks.items():
        solid = solid_of(stock.shape)
        yield Body(name=f"{STOCK}/{name}", solids=() if solid is None else (Placed(solid),), role="stock")
    for name, fixture in cell.fixtures.items():
        solid = solid_of(fixture.shape)
        yield Body(name=f"{FIXTURE}/{name}", solids=() if solid is None else (Placed(solid),), role="fixture")
    for name, device in cell.devices.items():
        solid = solid_of(device.shape)
        yield Body(name=f"{DEVICE}/{name}", solids=() if solid is None else (Placed(solid),), role="obstacle")
    for name, part in cell.parts.items():
        solid = solid_of(part.shape)
        solids = () if solid is None else (Placed(solid),)
        yield Body(name=f"{PART}/{name}", solids=solids, role="part", mass=_mass(part, solid), friction=part.friction)


def _mass(part: PartSpec, solid: Solid | None) -> float:
    """[kg] of a part; of steel where the cell does not say it."""
    if part.mass is not None or solid is None or isinstance(solid, Hulls):
        return part.mass or 0.0
    return STEEL_DENSITY * abs(solid.volume)
