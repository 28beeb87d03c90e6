"""A tool's body as kernels take it: slabs across its axis, from an outline of lines and arcs or from a `Shape`."""

from __future__ import annotations

from math import ceil, pi, sqrt
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.elementary import acos, atan2, cos_sin
from gcodesim.material.sweep_kernels import BALL, BULL_NOSE, CONE, Shape
from gcodesim.solids.turned import Outline, OutlineArc

Array = NDArray[np.float64]

JOINED: Final = 1.0e-9
"""Slabs overlap by so much [m], so that rounding leaves no skin of material between them."""

FACET_SHARE: Final = 0.01
"""Share of a cell that a facet of a rounded corner may lie inside of its arc."""

_THINNEST: Final = 1.0e-12

_CHORDS: Final = 32


def slabs_of_outline(outline: Outline, cell: float) -> Array:
    """The body that `outline` encloses as slabs (m, 6), see `Slab`, for stock with cells of the size `cell` [m].

    Arcs about a point of the axis are balls and exact; others become facets, inside by less than a hundredth of a
    cell. ValueError where the outline comes back down.
    """
    rows: list[tuple[float, ...]] = []
    at = outline[0]
    assert not isinstance(at, OutlineArc)
    r, h = at
    for piece in outline[1:]:
        if not isinstance(piece, OutlineArc):
            rows += _frustum(r, h, *piece)
            r, h = piece
            continue
        rows += _of_arc(r, h, piece, cell)
        r, h = piece.to
    return _joined(rows)


def slabs_of_shape(shape: Shape, cell: float) -> Array:
    """The same for one of the shapes that upright kernels know."""
    flat, radius, bottom, corner = shape.flat, shape.radius, shape.bottom, shape.corner
    outline: list[tuple[float, float] | OutlineArc] = [(0.0, bottom), (flat, bottom)]
    if shape.kind in (BALL, BULL_NOSE):
        outline.append(OutlineArc(to=(radius, bottom + corner), centre=(flat, bottom + corner), ccw=True))
    elif shape.kind == CONE:
        outline.append((radius, bottom + (radius - flat) * shape.rise))
    outline += [(radius, shape.top), (0.0, shape.top)]
    return slabs_of_outline(outline, cell)


def outline_of_slabs(slabs: Array) -> Array:
    """One half of the section (k, 2) [m] (across, along) of a body, closed along its axis; balls have 32 chords."""
    side: list[tuple[float, float]] = []
    for is_ball, h0, h1, k, g, _ in slabs.tolist():
        if not is_ball:
            side += [(k + g * h0, h0), (k + g * h1, h1)]
            continue
        begin, end = (acos(min(1.0, max(-1.0, (g - h) / k))) for h in (h0, h1))
        for share in range(_CHORDS + 1):
            c, s = cos_sin(begin + (end - begin) * share / _CHORDS)
            side.append((k * s, g - k * c))
    return np.array([(0.0, side[0][1]), *side, (0.0, side[-1][1])])


def _frustum(r0: float, h0: float, r1: float, h1: float) -> list[tuple[float, ...]]:
    if h1 < h0 - JOINED:
        raise ValueError(f"an outline that comes back down, from the height {h0} m to {h1} m")
    if h1 - h0 < _THINNEST or max(r0, r1) <= 0.0:
        return []
    growth = (r1 - r0) / (h1 - h0)
    return [(0.0, h0, h1, r0 - growth * h0, growth, max(r0, r1))]


def _of_arc(r0: float, h0: float, arc: OutlineArc, cell: float) -> list[tuple[float, ...]]:
    (r1, h1), (rc, hc) = arc.to, arc.centre
    radius = sqrt((r1 - rc) * (r1 - rc) + (h1 - hc) * (h1 - hc))
    begin, end = atan2(h0 - hc, r0 - rc), atan2(h1 - hc, r1 - rc)
    turn = (end - begin) % (2.0 * pi) if arc.ccw else -((begin - end) % (2.0 * pi))
    if abs(rc) <= JOINED and arc.ccw:
        if h1 < h0 - JOINED:
            raise ValueError(f"an outline that comes back down, from the height {h0} m to {h1} m")
        widest = radius if h0 <= hc <= h1 else max(r0, r1)
        return [(1.0, h0, h1, radius, hc, widest)]
    least = min(1.0, FACET_SHARE * cell / radius)
    pieces = max(1, ceil(abs(turn) / (2.0 * acos(1.0 - least))))
    rows: list[tuple[float, ...]] = []
    r, h = r0, h0
    for k in range(1, pieces + 1):
        c, s = cos_sin(begin + turn * k / pieces)
        to = (rc + radius * c, hc + radius * s) if k < pieces else (r1, h1)
        rows += _frustum(r, h, *to)
        r, h = to
    return rows


def _joined(rows: list[tuple[float, ...]]) -> Array:
    """Slabs of which each begins a little below the end of the one under it."""
    slabs = np.array(rows, dtype=float).reshape(-1, 6)
    slabs[1:, 1] -= JOINED
    return slabs
