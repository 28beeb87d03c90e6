"""Cutters, shanks and holders as kernels take them: the bodies of revolution that are swept through a stock."""

from __future__ import annotations

from math import pi

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.elementary import cos, sin, tan
from gcodesim.material.sweep_kernels import BALL, BULL_NOSE, CONE, CYLINDER, Shape
from gcodesim.solids.turned import Outline, OutlineArc, end_of, steps_of

Array = NDArray[np.float64]

_FACETS = 24
_STEPS = 16

_CLOSE = 1e-9
"""[m]"""


def _shape(kind: float, radius: float, corner: float, flat: float, rise: float, bottom: float, top: float) -> Shape:
    """The shape in floating-point numbers, for which kernels are compiled."""
    return Shape(*map(float, (kind, radius, corner, flat, rise, bottom, top)))


def flat(diameter: float, length: float) -> Shape:
    """Flat end mill of `diameter` that cuts up to `length` above its tip [m]."""
    return cylinder(diameter, 0.0, length)


def cylinder(diameter: float, bottom: float, top: float) -> Shape:
    """A round section from `bottom` to `top` above the tip [m]: shank, holder, or a flat cutter (bottom 0)."""
    return _shape(CYLINDER, diameter / 2.0, 0.0, diameter / 2.0, 0.0, bottom, top)


def frustum(lower: float, upper: float, bottom: float, top: float) -> list[Shape]:
    """A section with radii `lower` and `upper` from `bottom` to `top` above the tip [m], from the tip up.

    The kernels know cones that widen upwards; one that narrows becomes steps, each as wide as it is in the middle.
    """
    if lower == upper:
        return [cylinder(2.0 * lower, bottom, top)]
    if lower < upper:
        return [_shape(CONE, upper, 0.0, lower, (top - bottom) / (upper - lower), bottom, top)]
    ends = [bottom + (top - bottom) * k / _STEPS for k in range(_STEPS + 1)]
    radii = [lower + (upper - lower) * (k + 0.5) / _STEPS for k in range(_STEPS)]
    return [cylinder(2.0 * r, a, b) for r, a, b in zip(radii, ends[:-1], ends[1:], strict=True)]


def ball(diameter: float, length: float) -> Shape:
    """Ball end mill: a half sphere below a cylinder; lengths [m]."""
    return _shape(BALL, diameter / 2.0, diameter / 2.0, 0.0, 0.0, 0.0, max(length, diameter / 2.0))


def bull_nose(diameter: float, corner_radius: float, length: float) -> Shape:
    """End mill with rounded corners; lengths [m]. No corner gives a flat, half the diameter a ball."""
    radius = diameter / 2.0
    if not 0.0 <= corner_radius <= radius * (1.0 + 1e-12):
        raise ValueError(f"corner radius {corner_radius} of a cutter of radius {radius}")
    if corner_radius == 0.0:
        return flat(diameter, length)
    if corner_radius >= radius:
        return ball(diameter, length)
    return _shape(BULL_NOSE, radius, corner_radius, radius - corner_radius, 0.0, 0.0, max(length, corner_radius))


def cone(diameter: float, point_angle: float, length: float, tip_diameter: float = 0.0) -> Shape:
    """Drill or chamfer mill: a cone of `point_angle` [rad, whole angle], from `tip_diameter` outwards [m]."""
    if point_angle >= pi - 1e-9 or tip_diameter >= diameter:
        return flat(diameter, length)
    rise = 1.0 / tan(point_angle / 2.0)
    height = (diameter - tip_diameter) / 2.0 * rise
    return _shape(CONE, diameter / 2.0, 0.0, tip_diameter / 2.0, rise, 0.0, max(length, height))


def shape_of_outline(outline: Outline) -> Shape | None:
    """The shape whose cutting part `outline` is, None where no shape is like it; ValueError: it does not begin at 0."""
    pieces = [piece for start, piece in steps_of(outline) if not _same(start, end_of(piece))]
    if not _same(end_of(outline[0]), (0.0, 0.0)):
        raise ValueError("an outline that does not begin at the tip")
    flat_radius = 0.0
    if pieces and not isinstance(pieces[0], OutlineArc) and abs(end_of(pieces[0])[1]) <= _CLOSE:
        flat_radius = end_of(pieces.pop(0))[0]
    if pieces and _same(end_of(pieces[-1]), (0.0, end_of(pieces[-1])[1])) and len(pieces) > 1:
        pieces.pop()  # the top, back to the axis
    if not pieces or len(pieces) > 2:
        return None
    top = end_of(pieces[-1])[1]
    if len(pieces) == 2 and (
        isinstance(pieces[1], OutlineArc) or abs(end_of(pieces[1])[0] - end_of(pieces[0])[0]) > _CLOSE
    ):
        return None
    first = pieces[0]
    radius, height = end_of(first)
    if isinstance(first, OutlineArc):
        corner = first.radius
        quarter = _same(first.centre, (flat_radius, corner)) and _same(first.to, (flat_radius + corner, corner))
        return bull_nose(2.0 * radius, corner, top) if first.ccw and quarter else None
    if abs(radius - flat_radius) <= _CLOSE and len(pieces) == 1:
        return flat(2.0 * radius, top)
    if radius < flat_radius - _CLOSE or height <= _CLOSE:
        return None
    return _shape(CONE, radius, 0.0, flat_radius, height / (radius - flat_radius), 0.0, top)


def _same(one: tuple[float, float], other: tuple[float, float]) -> bool:
    return abs(one[0] - other[0]) <= _CLOSE and abs(one[1] - other[1]) <= _CLOSE


def profile(shape: Shape) -> tuple[Array, Array]:
    """Radii (m,) and heights (m,) above the tip [m] of the body from its lowest point up; rounded corners as facets."""
    radius, corner, flat_radius, rise = shape.radius, shape.corner, shape.flat, shape.rise
    bottom, top = shape.bottom, shape.top
    radii, heights = [flat_radius], [bottom]
    if shape.kind in (BALL, BULL_NOSE):
        angles = np.arange(1, _FACETS + 1) * (pi / 2.0 / _FACETS)
        radii += [flat_radius + corner * float(sin(t)) for t in angles]
        heights += [bottom + corner * (1.0 - float(cos(t))) for t in angles]
    elif shape.kind == CONE:
        radii.append(radius)
        heights.append(bottom + (radius - flat_radius) * rise)
    if top > heights[-1]:
        radii.append(radius)
        heights.append(top)
    return np.array(radii), np.array(heights)
