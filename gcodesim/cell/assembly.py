"""Stock of several materials or parts: layers become stocks of their own, and parts stand where their stock does.

A part takes its place from the stock that it is `inside` of, and from every other part of that stock before it. So
each is a stock like any other, with its own material, force, volume and files, and no two share a place.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

from gcodesim.arithmetic.elementary import asin, atan2
from gcodesim.cell.placing import Place
from gcodesim.cell.stock import StockShape, StockSpec
from gcodesim.declarations.reading import Path, Reading, suggestion
from gcodesim.frames import Pose
from gcodesim.solids import Box, Cylinder
from gcodesim.units import MM


def with_parts(stocks: Mapping[str, StockSpec], to: Reading) -> dict[str, StockSpec]:
    """The stocks of a cell with their layers, each behind its stock, and the places of parts; faults go to `to`."""
    layered: dict[str, StockSpec] = {}
    for name, stock in stocks.items():
        layered[name] = stock
        for layer in _layers(name, stock, stocks, to):
            layered[layer.name] = layer
    found: dict[str, StockSpec] = {}
    for name, stock in layered.items():
        host = stock.inside
        path: Path = ("stock", name, "inside")
        if host is None or stock.layer:
            found[name] = stock
        elif host not in stocks or host == name:
            to.fault("GS712", to.span(path), f"there is no other stock `{host}`", suggestion(host, [*stocks]))
        elif stocks[host].inside is not None:
            whole = stocks[host].inside
            to.fault("GS719", to.span(path), f"`{host}` is a part itself", f"write `inside: {whole}`")
        else:
            place = stock.place
            if place.frame is None:
                place = _composed(stocks[host].place, place)
            found[name] = replace(stock, place=place)
    return found


def _layers(name: str, stock: StockSpec, stocks: Mapping[str, StockSpec], to: Reading) -> Iterator[StockSpec]:
    """The layers of a stock as stocks, from the top down."""
    if not stock.layers:
        return
    shape, path = stock.shape, ("stock", name, "layers")
    if not isinstance(shape, Box | Cylinder):
        to.fault("GS719", to.key(path), "only a box or a cylinder has layers", "name other parts, with `inside`")
        return
    bottom, top = (shape.lower[2], shape.upper[2]) if isinstance(shape, Box) else (shape.bottom, shape.top)
    total = sum(layer.height for layer in stock.layers)
    if total > (top - bottom) * (1.0 + 1e-9):
        message = f"the layers are {total / MM:g} mm high, stock `{name}` is {(top - bottom) / MM:g} mm"
        to.fault("GS710", to.span(path), message, "the rest, below, is of its own `material`")
        return
    for index, layer in enumerate(stock.layers, start=1):
        own = f"{name}_layer_{index}"
        if own in stocks:
            to.fault("GS719", to.span(("stock", own)), f"`{own}` is what a layer of `{name}` is called")
            return
        low = max(top - layer.height, bottom)
        yield replace(
            stock,
            name=own,
            material=layer.material,
            layers=(),
            layer=True,
            inside=name,
            shape=_slab(shape, low, top),
        )
        top = low


def _slab(shape: Box | Cylinder, low: float, high: float) -> StockShape:
    if isinstance(shape, Cylinder):
        return replace(shape, bottom=low, top=high)
    return Box(lower=(*shape.lower[:2], low), upper=(*shape.upper[:2], high))


def _composed(outer: Place, inner: Place) -> Place:
    """The place of what stands at `inner` seen from what stands at `outer`."""
    X: Pose = outer.X @ inner.X
    rpy = outer.rpy
    if any(inner.rpy) and any(outer.rpy):
        R = X.R
        rpy = (atan2(R[2, 1], R[2, 2]), asin(-R[2, 0]), atan2(R[1, 0], R[0, 0]))
    elif any(inner.rpy):
        rpy = inner.rpy
    x, y, z = X.p.tolist()
    return replace(outer, xyz=(x, y, z), rpy=rpy)
