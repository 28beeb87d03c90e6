"""A cell becomes a shop; those of several channels share one scene."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from gcodesim.cell import Cell, place
from gcodesim.cell.cell import MAIN
from gcodesim.cell.placing import MACHINE
from gcodesim.shop.movers import mover_of
from gcodesim.shop.shop import Shop
from gcodesim.shop.stands import BODIES, WORK_FRAME, scene_of, work_stand


def open_shop(cell: Cell, channel: str = MAIN) -> Shop:
    """Kinematics and places of a cell, without stock."""
    if channel not in cell.channels:
        channel = next(iter(cell.channels))
    placement = place(cell, channel)
    mover = mover_of(cell.machine_of(channel))
    return Shop(
        cell=cell,
        channel=channel,
        mover=mover,
        placement=placement,
        X_BM=mover.X_WB.inverse() @ placement.X_WM,
        scene=scene_of(cell, mover, placement),
    )


def side_by_side(first: Shop, others: Sequence[Shop]) -> list[Shop]:
    """The shops of several channels in one scene, `first` first: with its stocks, fixtures and their places.

    What names no link stands on the table of the machine tool if one of the channels moves it, else on that of
    `first`. The other shops are those of the same cell without stock.
    """
    shops = [first, *others]
    movers = {name: mover for shop in reversed(shops) for name, mover in shop.scene.movers.items()}
    bearer = next((shop.mover for shop in shops if shop.mover.name == MACHINE), first.mover)
    stands = {name: first.scene.frames[name] for name in first.scene.frames if name not in (WORK_FRAME, BODIES)}
    if bearer is not first.mover:
        loose = [name for name in stands if name not in first.placement.carried]
        stands |= {name: work_stand(bearer, first.scene.at_rest(name)) for name in loose}
    return [
        replace(
            shop,
            scene=replace(shop.scene, movers=movers, frames={**shop.scene.frames, **stands}),
            stocks=first.stocks,
            coated=first.coated,
            beside=tuple(other.name for other in shops if other is not shop),
            placement=replace(
                shop.placement,
                stocks=first.placement.stocks,
                fixtures=first.placement.fixtures,
                parts=first.placement.parts,
                devices=first.placement.devices,
                target=first.placement.target,
                carried=first.placement.carried,
            ),
        )
        for shop in shops
    ]
