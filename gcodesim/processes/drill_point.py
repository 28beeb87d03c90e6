"""What a law says of the edges of a drill: of its lips, and of the chisel edge between them."""

from __future__ import annotations

from typing import Final

import numpy as np

from gcodesim.arithmetic.elementary import cos, power
from gcodesim.frozen import frozen
from gcodesim.processes.laws import Array, Law
from gcodesim.processes.uneven import split_pieces
from gcodesim.tools.chisel_edge import push_factor
from gcodesim.tools.cutter import Cutter
from gcodesim.tools.teeth import helices_of
from gcodesim.units import MM

_USUAL_FEED: Final = 0.015
"""Feed of a turn over the diameter at which the constant K is that of the law; others hardly change it."""


@frozen(kw_only=False)
class SquareEdges:
    """A law without force along the edge: lips of drills stand nearly square to their way.

    Constants of mills for that direction belong to the helix of their flanks.
    """

    law: Law

    @property
    def packed(self) -> Array:
        rows = np.array(self.law.packed)
        rows[2, 0], rows[2, 2] = 0.0, 0.0
        return rows


@frozen(kw_only=False)
class LeftHand:
    """A law of edges with a left-hand helix: along the edge they are pushed where others are pulled.

    In oblique cutting that force has the sign of the inclination (Altintas 2012, sec. 2.8.2); constants are those of
    the usual right-hand edges, which lift the chips.
    """

    law: Law

    @property
    def packed(self) -> Array:
        rows = np.array(self.law.packed)
        rows[2, 0], rows[2, 2] = -rows[2, 0], -rows[2, 2]
        return rows


def edge_law(cutter: Cutter, law: Law) -> Law:
    """The law of the edges of a cutter."""
    if cutter.axial:
        return SquareEdges(law)
    return LeftHand(law) if helices_of(cutter)[0] < 0.0 else law


def edge_pieces(cutter: Cutter, law: Law | None) -> Array:
    """The outline (k, 10) of an edge with the push of each piece [N/m], see `edge_kernels`: that of a chisel edge."""
    from gcodesim.processes.edge_kernels import LENGTH, WEIGHT

    pieces = split_pieces(cutter, cutter.edge)
    push = np.zeros(len(pieces))
    if cutter.chisel_length > 0.0 and law is not None:
        push[0] = chisel_push(cutter, law) / (cutter.flutes * pieces[0, LENGTH] * pieces[0, WEIGHT])
    return np.column_stack([pieces, push])


def chisel_push(cutter: Cutter, law: Law) -> float:
    """Thrust [N] by which a chisel edge is pressed into the material, besides what it cuts.

    J K d², with the constant K of the material from the torque M that lips alone would bear at the feed f of a turn
    (Machinery's Handbook, 31st ed. 2020, "Machining Power": 0.007 K d² J and M = 0.000025 K f^0.8 d^1.8 in N, N·m and
    mm).
    """
    from gcodesim.processes.edge_kernels import KAPPA

    d, slope = cutter.point_diameter, cos(float(cutter.edge[0, KAPPA]))
    feed = _USUAL_FEED * d
    factor, exponent, rub = law.packed[0].tolist()
    pressure = factor * power(feed / cutter.flutes * slope, exponent) + rub
    torque = cutter.flutes * (0.5 * d / slope) * pressure * 0.25 * d
    constant = torque / (2.5e-5 * power(feed / MM, 0.8) * power(d / MM, 1.8))
    return float(0.007 * constant * (d / MM) * (d / MM) * push_factor(cutter.chisel_length / d))
