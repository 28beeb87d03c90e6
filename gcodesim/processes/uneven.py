"""Teeth that are not all alike, as kernels take them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.elementary import acos, cos, power
from gcodesim.tools.cutter import Cutter
from gcodesim.tools.teeth import late_at, starts_of

if TYPE_CHECKING:
    from gcodesim.processes.uneven_kernels import Uneven

Array = NDArray[np.float64]


def packed_teeth(cutter: Cutter, exponent: Array) -> Uneven:
    """Teeth that differ, under a law with exponents (3,); none where all are alike."""
    from gcodesim.processes.uneven_kernels import Uneven

    if not cutter.uneven:
        none = np.zeros((0, 0))
        return Uneven(np.zeros(0), none, np.zeros(0), 0.0, 0.0, np.zeros(3), none.copy(), none.copy())
    teeth, heights = cutter.flutes, borders_of(cutter)
    return Uneven(
        heights=heights,
        late=np.ascontiguousarray(late_at(cutter, heights) - starts_of(cutter)[:, None]),
        senses=senses_of(cutter, 0.5 * (heights[:-1] + heights[1:])),
        offset=float(cutter.runout or 0.0),
        angle=float(cutter.runout_angle),
        grown=np.array([power(float(teeth), float(p)) for p in exponent]),
        gaps=np.zeros((teeth, teeth)),
        steps=np.zeros((teeth, teeth)),
    )


def borders_of(cutter: Cutter) -> Array:
    """Heights (k,) [m] between which the helix of a cutter goes one way."""
    top = cutter.edge_height
    inner = [] if cutter.up_cut is None or cutter.up_cut >= top else [cutter.up_cut]
    return np.array([0.0, *inner, top])


def senses_of(cutter: Cutter, z: Array) -> Array:
    """1 where the helix goes as at the tip (n,), at heights z (n,) [m], -1 where it goes back."""
    back = np.zeros(len(z), dtype=np.bool_) if cutter.up_cut is None else z >= cutter.up_cut
    return np.where(back, -1.0, 1.0)


def split_pieces(cutter: Cutter, pieces: Array) -> Array:
    """The outline (k, c) of an edge, see `Cutter.edge`, with pieces divided where the helix turns back."""
    from gcodesim.processes.edge_kernels import FOOT, HEAD

    border = cutter.up_cut
    if border is None:
        return pieces
    found: list[Array] = []
    for piece in pieces:
        low, high = sorted((float(piece[FOOT]), float(piece[HEAD])))
        found += _halves(piece, border) if low < border < high else [piece]
    return np.array(found)


def _halves(piece: Array, border: float) -> list[Array]:
    """The parts of a piece before and behind the height `border` [m]."""
    from gcodesim.processes.edge_kernels import ARC, AT_R, AT_Z, FOOT, HEAD, KAPPA, KAPPA_END, LENGTH, UPRIGHT

    first, second = piece.copy(), piece.copy()
    share = (border - piece[FOOT]) / (piece[HEAD] - piece[FOOT])
    if piece[ARC] > 0.0:
        kappa = acos(float((piece[AT_Z] - border) / piece[ARC]))
        share = (kappa - piece[KAPPA]) / (piece[KAPPA_END] - piece[KAPPA])
        first[KAPPA_END] = second[KAPPA] = kappa
    else:
        cosine = cos(float(piece[KAPPA]))
        second[AT_R] += 0.0 if abs(cosine) < UPRIGHT else share * piece[LENGTH] * cosine
        second[AT_Z] = border
    first[HEAD] = second[FOOT] = border
    first[LENGTH], second[LENGTH] = share * piece[LENGTH], (1.0 - share) * piece[LENGTH]
    return [first, second]
