"""At which angle contact of a row begins or ends at a wall, from where the wall really is.

Columns show a wall up to half a cell beside its place, and softly; a cut that is a cell wide may have no column of its
own. Where an upright tool has left a wall its place is known (`material.near_wall_kernels`), and contact ends exactly
there. Frame K and angles as in `edge_kernels`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.atan_kernels import acos
from gcodesim.compiled import kernel
from gcodesim.material.kernels import Field, ToColumns, wall_near, walled_at
from gcodesim.processes.edge_kernels import ANGLES, THIN, Circle, Clearance, Heading, along_way, off_way, on_way

Array = NDArray[np.float64]

PER_ANGLE = ANGLES / (2.0 * np.pi)
JUST_INSIDE = 1.0 - 1.0e-3  # of a radius, where the outermost wall is looked for
NO_LIMIT = -1.0
BASE = 4.0  # [cells] between two places of a wall that tell its slope
LEAN = 0.5  # of a slope at one place, by which the other is looked for: half of it may be a ripple
STEEPEST_TURN = 0.05  # least share of the radius of an arc at which a wall is from its centre
OWN_FRONT = 0.1  # [cells] outside the rim, up to which a wall ahead is taken for one that the tool has just cut
NEXT_TO = 1.0e-6  # [angles]
FULL = 1.0 - 1.0e-9  # from which on a share is all
SAME_SHARE = 0.02  # up to which the shares of two angles are the same but for what earlier cuts have left


class EdgeBand(NamedTuple):
    """A row as it meets a wall: its radius, its heights above S, and the least way ahead, all [m]."""

    radius: float
    bottom: float
    top: float
    least_way: float


class EdgeSpot(NamedTuple):
    """Where a row is asked for material, in S [m]."""

    x: float
    y: float
    bottom: float
    top: float


class ContactLimit(NamedTuple):
    """Where contact ends [angles from 0 to ANGLES / 2], or NO_LIMIT; and where its wall was seen.

    That is how far ahead and how far to the left [m], its slope to the left, and down to which height in S [m].
    """

    angle: float
    ahead: float
    aside: float
    slope: float
    foot: float


@kernel(lean=True, inlined=True)
def spot_at(tip: Array, heading: Heading, span: EdgeBand, px: float, py: float, way: float) -> EdgeSpot:
    """The place (px, py) in K, a `way` [m] ahead of the edge."""
    ux, uy, _, climb, _ = heading
    rise = climb * max(way, span.least_way)
    bottom = span.bottom + rise
    return EdgeSpot(tip[0] + ux * px - uy * py, tip[1] + uy * px + ux * py, bottom, max(span.top + rise, bottom + THIN))


@kernel(lean=True, inlined=True)
def spot_along(tip: Array, heading: Heading, span: EdgeBand, px: float, py: float, way: float) -> EdgeSpot:
    """The same of a place on a straight way that is as far from the tool, and off its way, on the way that it goes."""
    px, py = along_way(px, py, heading.turn)
    return spot_at(tip, heading, span, px, py, way)


class Walls(NamedTuple):
    """The limits of the highest row of a piece at the walls to the left and to the right of its axis."""

    left: ContactLimit
    right: ContactLimit


@kernel(lean=True, inlined=True)
def no_limit() -> ContactLimit:
    """No wall was seen."""
    return ContactLimit(NO_LIMIT, 0.0, 0.0, 0.0, 0.0)


@kernel(lean=True)
def angle_at(ahead: float, aside: float, slope: float, radius: float, turn: float) -> float:
    """Where contact of a row of this radius [m] ends at a wall that was seen there [angles].

    A wall that the tool follows keeps its distance, also on an arc: it is a circle around the same centre, which lies
    beside the axis. So its place and its slope ahead tell where it crosses the row, or, on a way that is known to turn
    so much [1/m], its place alone.
    """
    if turn != 0.0:
        off = off_way(ahead * ahead + aside * aside, aside, turn)
        return float(acos(min(max(on_way(radius * radius, off, turn) / radius, -1.0), 1.0)) * PER_ANGLE)
    inside = min(max(aside, -radius), radius)
    beyond = ahead * ahead - (radius * radius - inside * inside)
    at_edge, to_centre = aside, ahead + slope * aside
    if ahead > 0.0 and beyond > 0.0 and to_centre > 0.5 * ahead:
        at_edge = aside - 0.5 * slope * beyond / to_centre
    return float(acos(min(max(at_edge / radius, -1.0), 1.0)) * PER_ANGLE)


@kernel(lean=True, inlined=True)
def of_radius(limit: ContactLimit, radius: float, turn: float) -> ContactLimit:
    """The limit of a row of another radius [m] at the same wall; turn [1/m] of the way."""
    angle = angle_at(limit.ahead, limit.aside, limit.slope, radius, turn)
    return ContactLimit(angle, limit.ahead, limit.aside, limit.slope, limit.foot)


@kernel(lean=True, inlined=True)
def is_at(limit: ContactLimit, tip: Array, heading: Heading, clearance: Clearance, spot: EdgeSpot) -> bool:
    """Whether the wall of a limit passes not more than a cell beside a spot."""
    if limit.angle == NO_LIMIT or 0.5 * (spot.bottom + spot.top) < limit.foot:
        return False
    along_x, along_y = spot.x - tip[0], spot.y - tip[1]
    ahead, aside = heading.ux * along_x + heading.uy * along_y, heading.ux * along_y - heading.uy * along_x
    return bool(abs(aside - limit.aside - limit.slope * (ahead - limit.ahead)) <= clearance.aside)


class SeenWall(NamedTuple):
    """A wall that was seen: whether there is one, how far ahead and to the left of the axis [m], its slope and foot."""

    known: bool
    ahead: float
    aside: float
    slope: float
    foot: float


@kernel(lean=True)
def sight_at(field: Field, tip: Array, heading: Heading, spot: EdgeSpot, line: Array) -> SeenWall:
    """The wall near a spot, as it is seen from the tip (3,); line (4,) is room."""
    ux, uy, _, _, _ = heading
    along_x, along_y = spot.x - tip[0], spot.y - tip[1]
    ahead, aside = ux * along_x + uy * along_y, ux * along_y - uy * along_x
    if heading.turn == 0.0:
        near = wall_near(field, spot.x, spot.y, spot.bottom, spot.top, ux, uy, line)
        return SeenWall(near.known, ahead, aside + near.aside, near.slope, near.foot)
    t, s = 1.0 - heading.turn * aside, heading.turn * ahead  # along the way, as it goes there
    size = max(np.sqrt(t * t + s * s), STEEPEST_TURN)
    t, s = t / size, s / size
    near = wall_near(field, spot.x, spot.y, spot.bottom, spot.top, ux * t - uy * s, uy * t + ux * s, line)
    return SeenWall(near.known, ahead - s * near.aside, aside + t * near.aside, near.slope, near.foot)


@kernel(lean=True, inlined=True)
def is_own_front(seen: SeenWall, radius: float, clearance: Clearance) -> bool:
    """Whether what was seen is, at one of the columns, the front that the tool itself has just cut.

    No earlier wall is nearer than that, and what lies between it and such a wall tells the place of neither.
    """
    reach = radius + OWN_FRONT * clearance.aside
    return bool(seen.ahead > 0.0 and seen.ahead * seen.ahead + seen.aside * seen.aside < reach * reach)


@kernel(lean=True)
def limit_at(
    field: Field, tip: Array, heading: Heading, clearance: Clearance, radius: float, spot: EdgeSpot, line: Array
) -> ContactLimit:
    """The limit of a row of this radius [m] at the wall near a spot.

    The slope of a wall between two columns is that of its ripples; what the wall does as a whole is seen between two
    places a few cells apart, of which one is as near to the edge as nothing has been cut yet.
    """
    seen = sight_at(field, tip, heading, spot, line)
    if not seen.known or is_own_front(seen, radius, clearance):
        return no_limit()
    if heading.turn != 0.0:
        slope = heading.turn * seen.ahead / max(1.0 - heading.turn * seen.aside, STEEPEST_TURN)
        angle = angle_at(seen.ahead, seen.aside, slope, radius, heading.turn)
        return ContactLimit(angle, seen.ahead, seen.aside, slope, seen.foot)
    inside = min(abs(seen.aside), radius)
    nearest = float(np.sqrt(radius * radius - inside * inside)) + heading.level * clearance.ahead
    way = nearest - seen.ahead
    if way > -clearance.aside:
        way = BASE * clearance.aside
    ahead, aside = seen.ahead + way, seen.aside + LEAN * seen.slope * way
    ux, uy, _, _, _ = heading
    other_spot = EdgeSpot(tip[0] + ux * ahead - uy * aside, tip[1] + uy * ahead + ux * aside, spot.bottom, spot.top)
    other = sight_at(field, tip, heading, other_spot, line)
    slope = seen.slope
    if other.known and abs(other.ahead - seen.ahead) > 0.5 * abs(way):
        slope, between = (other.aside - seen.aside) / (other.ahead - seen.ahead), 0.5 * (other.ahead + seen.ahead)
        if way < 0.0:
            seen = other
        slope *= seen.ahead / between  # of an arc around a centre beside the axis, at its nearer place
    angle = angle_at(seen.ahead, seen.aside, slope, radius, 0.0)
    return ContactLimit(angle, seen.ahead, seen.aside, slope, seen.foot)


@kernel(lean=True, inlined=True)
def is_on_rim(limit: float) -> bool:
    """Whether a limit [angles] is that of a wall which the tool has left itself."""
    return limit <= NEXT_TO or limit >= ANGLES // 2 - NEXT_TO


@kernel(lean=True, inlined=True)
def outermost_ahead(radius: float, heading: Heading, clearance: Clearance) -> float:
    """How far ahead of the axis [m] a row is asked for a wall not far inside its rim."""
    inside = max(radius - clearance.aside, 0.0)
    return float(np.sqrt(radius * radius - inside * inside) + heading.level * clearance.ahead)


@kernel(lean=True)
def outermost(
    field: Field, tip: Array, heading: Heading, clearance: Clearance, span: EdgeBand, side: float, line: Array
) -> ContactLimit:
    """The limit at a wall not far inside the rim, on the left (1) or on the right (-1).

    It is between the columns around the rim, or between those a cell further inside; seen where the tool has not cut
    any of it yet. A wall that turns away from the tool, as that of a convex arc, is only seen as near to the axis as
    that goes.
    """
    radius, front = span.radius, span.radius + clearance.ahead
    inside = max(radius - clearance.aside, 0.0)
    px = outermost_ahead(radius, heading, clearance)
    spot = spot_along(tip, heading, span, px, side * JUST_INSIDE * radius, clearance.ahead)
    limit = limit_at(field, tip, heading, clearance, radius, spot, line)
    if limit.angle == NO_LIMIT:
        spot = spot_along(tip, heading, span, px, side * inside, clearance.ahead)
        limit = limit_at(field, tip, heading, clearance, radius, spot, line)
    for wide in (0.5 * (radius + inside), JUST_INSIDE * radius):
        if limit.angle == NO_LIMIT:
            px = heading.level * float(np.sqrt(front * front - wide * wide))
            spot = spot_along(tip, heading, span, px, side * wide, clearance.ahead)
            limit = limit_at(field, tip, heading, clearance, radius, spot, line)
    return limit


@kernel(lean=True)
def beside(
    field: Field, columns: ToColumns, tip: Array, heading: Heading, clearance: Clearance, span: EdgeBand, side: float,
    line: Array,
) -> ContactLimit:  # fmt: skip
    """The limit at the outermost wall on the left (1) or on the right (-1), between rim and axis, in front.

    The bottom of a falling tool has nothing else to go by, so that it is looked for twice a cell, lest it pass between
    two places.
    """
    radius, limit = span.radius, no_limit()
    falls_straight = heading.climb < 0.0 and heading.turn == 0.0
    step = 0.5 * clearance.aside if falls_straight else clearance.aside
    front = radius + clearance.ahead
    ahead, inside = outermost_ahead(radius, heading, clearance), JUST_INSIDE * radius
    while inside > 0.0 and limit.angle == NO_LIMIT:
        px, py = along_way(ahead, side * inside, heading.turn)
        if walled_at(field, columns, px, py):
            spot = spot_along(tip, heading, span, ahead, side * inside, clearance.ahead)
            limit = limit_at(field, tip, heading, clearance, radius, spot, line)
        inside -= step
        ahead = heading.level * np.sqrt(front * front - inside * inside)
    return limit


@kernel(lean=True)
def side_limit(
    field: Field, tip: Array, heading: Heading, clearance: Clearance, span: EdgeBand, share: float, at_left: bool,
    line: Array,
) -> ContactLimit:  # fmt: skip
    """The limit at a wall just inside the rim, of which the outermost angle says that not all is in material."""
    if share >= FULL or share < 0.0:
        return no_limit()
    limit = outermost(field, tip, heading, clearance, span, 1.0 if at_left else -1.0, line)
    return no_limit() if share == 0.0 and is_on_rim(limit.angle) else limit


@kernel(lean=True, inlined=True)
def at_row(
    limit: ContactLimit, tip: Array, heading: Heading, clearance: Clearance, span: EdgeBand, share: float, at_left: bool
) -> ContactLimit:  # fmt: skip
    """What `side_limit` says of a row if its wall is the one that another row of the piece has met."""
    if limit.angle == NO_LIMIT or share >= FULL or share < 0.0:
        return no_limit()
    side, middle = 1.0 if at_left else -1.0, max(span.radius - 0.5 * clearance.aside, 0.0)
    ahead = outermost_ahead(span.radius, heading, clearance)
    spot = spot_along(tip, heading, span, ahead, side * middle, clearance.ahead)
    if not is_at(limit, tip, heading, clearance, spot):
        return no_limit()
    own = of_radius(limit, span.radius, heading.turn)
    return no_limit() if share == 0.0 and is_on_rim(own.angle) else own


@kernel(lean=True, inlined=True)
def end_of_side(circle: Circle, inside: float, share: Array, at_left: bool) -> int:
    """The outermost angle whose `share` (n,) has nothing of a wall just inside the rim.

    inside: cosine of phi from which on all angles are asked at the same place.
    """
    n = share.shape[0]
    step = 1 if at_left else -1
    k = 0 if at_left else n - 1
    while 0 <= k + step < n and abs(circle.cosines[k]) >= inside:
        k += step
    while 0 < k < n - 1 and abs(share[k + step] - share[k]) > SAME_SHARE:
        k += step
    return k


@kernel(lean=True, inlined=True)
def spot_beyond(
    tip: Array, heading: Heading, span: EdgeBand, clearance: Clearance, limit: ContactLimit, at_left: bool
) -> EdgeSpot:
    """A cell outside the wall of a limit."""
    aside = limit.aside + (clearance.aside if at_left else -clearance.aside)
    return spot_at(tip, heading, span, limit.ahead, aside, clearance.ahead)
