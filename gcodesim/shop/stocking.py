"""Stocks come into a shop, each in its place."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from gcodesim.arithmetic.matrices import applied, multiplied
from gcodesim.cell import Cell
from gcodesim.cell.placement import STOCK
from gcodesim.cell.stock import solid_of
from gcodesim.diagnostics import Diagnostic
from gcodesim.frames import Pose
from gcodesim.scene import Stand
from gcodesim.shop.blanks import blank, blank_left
from gcodesim.shop.coats import coated_bodies
from gcodesim.shop.shop import PlacedStock, Shop
from gcodesim.shop.unfit import idle_on_lathe, undrawn
from gcodesim.solids import room_of

if TYPE_CHECKING:
    from gcodesim.material.stock import Stock
    from gcodesim.processes.materials import Material


def with_stock(shop: Shop, left: Mapping[str, Path] | None = None) -> tuple[Shop, list[Diagnostic]]:
    """The shop with its workpieces; a finding for each that does not fit into memory or cannot be read.

    `left` are files with the stocks of the cell as the first part of the program has left them.
    """
    left = left or {}
    stocks: dict[str, PlacedStock] = {}
    stands: dict[str, Stand] = {}
    findings = [*undrawn(shop), *idle_on_lathe(shop)]
    fresh: dict[str, Stock] = {}
    for name, spec in shop.cell.stocks.items():
        made = blank_left(shop, name, left[name], name, spec) if name in left else blank(shop, name, spec)
        if isinstance(made, Diagnostic):
            findings.append(made)
        else:
            fresh[name] = made
    findings += _fitted(shop, fresh) if not left else ()
    for name, made in fresh.items():
        spec = shop.cell.stocks[name]
        material = shop.cell.material(spec)
        if material is None and made.material:
            material = _material_named(shop.cell, made.material)
        frame = f"{STOCK}/{name}"
        X_WS = _rest_of(shop, name)
        if not shop.mover.lathe:
            made = _upright(shop, made, X_WS)
        turn = Pose(np.zeros(3), made.turn)
        stand = shop.scene.frames[frame]
        stands[frame] = Stand(stand.parent, stand.X @ turn)
        stocks[name] = PlacedStock(
            name=name, frame=frame, spec=spec, stock=made, X_WS=X_WS @ turn, material=material, initial=made.volume
        )
    stocked = replace(shop, stocks=stocks, scene=shop.scene.with_frames(stands))
    return replace(stocked, coated=coated_bodies(stocked)), findings


def _rest_of(shop: Shop, name: str) -> Pose:
    """Where a stock is at the start, in the world."""
    return shop.placement.stocks[name] if name in shop.placement.stocks else shop.scene.at_rest(f"{STOCK}/{name}")


def _fitted(shop: Shop, fresh: Mapping[str, Stock]) -> list[Diagnostic]:
    """Take the room of each part out of the stock that it is inside of, and out of the parts before it there.

    GS413 for a part that takes nothing of them. What an earlier run left has its holes already.
    """
    findings: list[Diagnostic] = []
    specs = shop.cell.stocks
    for name, spec in specs.items():
        solid = solid_of(spec.shape)
        if spec.inside is None or solid is None or name not in fresh:
            continue
        from gcodesim.material.embedded import take_out

        room, taken = room_of(solid), 0.0
        for other in fresh:
            if other == name:
                break
            if spec.inside in (other, specs[other].inside) and solid_of(specs[other].shape) is not None:
                points = (_rest_of(shop, other).inverse() @ _rest_of(shop, name)).apply(room.points)
                taken += take_out(fresh[other], points, room.faces)
        if taken <= 0.0:
            findings.append(
                Diagnostic(
                    code="GS413",
                    span=shop.cell.span("stock", name),
                    message=f"`{name}` is not inside of `{spec.inside}`: no place is common to them",
                    hint="look at `xyz`, which counts from the frame of that stock",
                )
            )
    return findings


def _upright(shop: Shop, stock: Stock, X_WS: Pose) -> Stock:
    """The stock with its columns along the axis of S that points to the spindle; most stocks are like that anyway."""
    from gcodesim.material.turning import turn_for, turned

    own = shop.cell.channels[shop.channel].orientation
    retreat = shop.mover.retreat
    up = -shop.placement.tool_axis(own) if retreat is None else applied(shop.placement.X_WM.R, retreat)
    R = turn_for(applied(multiplied(X_WS.R, stock.turn).T, up))
    return stock if np.array_equal(R, np.eye(3)) else turned(stock, R)


def _material_named(cell: Cell, name: str) -> Material | None:
    """The material named by an earlier run's stock, if this cell or the library knows it."""
    from gcodesim.processes.materials import LIBRARY

    return cell.materials.get(name) or LIBRARY.get(name)
