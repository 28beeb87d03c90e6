"""Bodies that spray may coat, and their skins."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Final

import numpy as np

from gcodesim.cell.placement import STOCK
from gcodesim.scene import Body
from gcodesim.scene.coated import Coated, Shading
from gcodesim.shop.shop import Shop
from gcodesim.solids import triangles_of
from gcodesim.solids.mesh_file import Triangles

if TYPE_CHECKING:
    from gcodesim.material.stock import Stock

COATED_COLUMNS: Final = 400_000
"""Columns of a stock whose surface is coated: as fine as a film can be, within a second."""

_IN_THE_WAY: Final = ("fixture", "stock", "part", "obstacle")
"""Roles of bodies that may stand between a gun and what it coats."""


def coated_bodies(shop: Shop) -> dict[str, Coated]:
    """The bodies that a spray gun may coat, all standing in each other's way."""
    coats = shop.cell.coats
    if not coats:
        return {}
    from gcodesim.processes.spray_pattern import finest

    usual = finest(shop.cell.tools.values())
    sizes = {frame: spec.resolution or usual for frame, spec in coats.items()}
    skins = {placed.frame: _stock_skin(placed.stock) for placed in shop.stocks.values()}
    solids = {body.name: partial(skin_of, body) for body in shop.scene.bodies if body.role in _IN_THE_WAY}
    skins = {**skins, **{frame: skin for frame, skin in solids.items() if frame not in skins}}
    shading = Shading([*skins.items()])
    found = {}
    for frame, size in sizes.items():
        placed = shop.stocks.get(frame.rpartition("/")[2]) if frame.startswith(f"{STOCK}/") else None
        if placed is not None:
            stock = placed.stock
            found[frame] = Coated(
                frame, skins[frame], size, shading, volume=partial(getattr, stock, "volume"), in_part=stock.in_part
            )
        elif frame in skins:
            found[frame] = Coated(frame, skins[frame], size, shading)
    return found


def _stock_skin(stock: Stock) -> Callable[[], Triangles]:
    """The surface of a stock as it is when it is asked for."""

    def skin() -> Triangles:
        surface = stock.surface(stock.spacing_for(COATED_COLUMNS))
        return Triangles(points=surface.vertices, faces=surface.faces.astype(np.int32, copy=False))

    return skin


def skin_of(body: Body) -> Triangles:
    """The skins of all solids of a body, in its frame."""
    parts = [(placed.X, triangles_of(placed.solid)) for placed in body.solids]
    if not parts:
        raise ValueError("a body without a shape")
    starts = np.cumsum([0, *(len(skin.points) for _, skin in parts)])
    return Triangles(
        points=np.concatenate([X.apply(skin.points) for X, skin in parts]),
        faces=np.concatenate([skin.faces + at for (_, skin), at in zip(parts, starts[:-1], strict=True)]).astype(
            np.int32
        ),
    )
