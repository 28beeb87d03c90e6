"""Where contact of a row of a curved or slanted edge ends just inside its rim, from the exact heights of columns.

A row is asked for material where all four columns around are in front of the tool; that leaves out a strip one cell
wide on both sides. There the surface in front is read column by column, across the way. What it is to a row is told by
the radius that the edge has at its height: of a groove that a tool of the same shape has left, this radius is the
distance from the groove's middle, so that straight lines between columns are exact at any slope.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel
from gcodesim.material.column_kernels import index_at, middle_of, sides
from gcodesim.material.kernels import Field, highest_at, wall_near
from gcodesim.processes.edge_kernels import ARC, AT_R, AT_Z, FOOT, HEAD, LENGTH, THIN, Clearance, Heading, on_way
from gcodesim.processes.limit_kernels import BASE, STEEPEST_TURN, ContactLimit, angle_at, no_limit

Array = NDArray[np.float64]

SEEN = 7  # columns that are looked at across the way,
LINES = 4  # and what is kept of each
BEYOND = 2  # of these outside the rim
DEEPEST = 2.0  # [cells] inwards, up to which a limit is looked for at a time
# Where in the same line the slopes to the way of what is seen on both sides are kept: all rows of a piece see the same,
# so it is looked for once.
SLOPE_LEFT, SLOPE_RIGHT = LINES * SEEN + 8, LINES * SEEN + 9
UNSEEN = 1.0e9  # no slope
FRONT = LINES * SEEN + 10  # and how far from the axis columns begin that the tool has not cut [m]
STRAIGHT = 0.05  # slope of a surface to the way, from which on what is seen so far ahead says nothing of the rim
LOWEST = -1.0e9  # [m] below every column that is there
ON_RIM = 1.0e-4  # of a radius, up to which a place is the rim: the tool has left that surface itself


class RimRow(NamedTuple):
    """A row of the edge: its radius, the tip below it and the row itself, in heights above S, and its side, all [m].

    The side is 1 to the left and -1 to the right.
    """

    radius: float
    tip: float
    height: float
    side: float


class RimSight(NamedTuple):
    """Whether a surface crosses a row near its rim, how far outside of the axis [m]; whether material is outside it."""

    known: bool
    aside: float
    full: bool


class EdgeProfile(NamedTuple):
    """Columns (SEEN,) from the outside in: how far ahead of the axis and outside of it, heights, radii of the edge [m].

    Columns that are empty or outside the stock have heights of -inf. `line` (4,) is room.
    """

    aheads: Array
    asides: Array
    heights: Array
    radii: Array
    line: Array


@kernel(lean=True, inlined=True)
def profile_of(line: Array) -> EdgeProfile:
    """Room for a profile in a line of at least 4 SEEN + 4 numbers."""
    n = SEEN
    return EdgeProfile(
        line[:n], line[n : 2 * n], line[2 * n : 3 * n], line[3 * n : LINES * n], line[LINES * n : LINES * n + 4]
    )


@kernel(lean=True)
def radius_of_edge(pieces: Array, height: float) -> float:
    """Radius [m] of an edge at a height above its tip; beyond its ends that of the end."""
    radius = 0.0
    for piece in range(pieces.shape[0]):
        foot, head, arc = pieces[piece, FOOT], pieces[piece, HEAD], pieces[piece, ARC]
        if height < foot:
            break
        z = min(height, head)
        if arc > 0.0:
            up = z - pieces[piece, AT_Z]
            radius = pieces[piece, AT_R] + np.sqrt(max(arc * arc - up * up, 0.0))
        else:
            length, rise = pieces[piece, LENGTH], head - foot
            out = np.sqrt(max(length * length - rise * rise, 0.0))
            radius = pieces[piece, AT_R] + (out * (z - foot) / rise if rise > 0.0 else out)
    return float(radius)


@kernel(lean=True)
def widest_below(pieces: Array, height: float) -> float:
    """Largest radius [m] of an edge up to a height above its tip."""
    widest = 0.0
    for piece in range(pieces.shape[0]):
        foot, head = pieces[piece, FOOT], pieces[piece, HEAD]
        if foot < height:
            widest = max(widest, max(radius_of_edge(pieces, foot), radius_of_edge(pieces, min(head, height))))
    return widest


class RimLine(NamedTuple):
    """Columns (SEEN,) across the way, from one to the next `step` [m] inwards.

    (u, v) is where the line begins, counted in columns, `shift` columns inside of the first one whose centre it meets.
    (out_x, out_y) is the unit vector outwards, (dx, dy) the sides of a cell [m].
    """

    u: float
    v: float
    shift: float
    step: float
    out_x: float
    out_y: float
    dx: float
    dy: float


@kernel(lean=True, inlined=True)
def line_across_way(field: Field, tip: Array, heading: Heading, ahead: float, row: RimRow, about: float) -> RimLine:
    """The columns near the line across the way that is so far `ahead` [m] of the tip, from about there on inwards.

    It goes through centres of columns along one axis, and past the nearest ones along the other.
    """
    (dx, dy), ux, uy = sides(field), heading.ux, heading.uy
    out_x, out_y = -uy * row.side, ux * row.side
    along_x = abs(out_x) > abs(out_y)
    x, y = tip[0] + ux * ahead + out_x * about, tip[1] + uy * ahead + out_y * about
    u, v = index_at(field, x, y)
    across, onward = (u, out_x) if along_x else (v, out_y)
    step = (dx if along_x else dy) / abs(onward)
    shift = np.ceil(across) - across if onward > 0.0 else across - np.floor(across)
    return RimLine(u, v, float(shift), step, out_x, out_y, dx, dy)


@kernel(lean=True, inlined=True)
def column_on(line: RimLine, k: int) -> tuple[int, int]:
    """Column k of a line across the way."""
    way = (line.shift + (BEYOND - 1 - k)) * line.step
    return int(np.rint(line.u + way * line.out_x / line.dx)), int(np.rint(line.v + way * line.out_y / line.dy))


@kernel(lean=True, inlined=True)
def dips_between(heights: Array, k: int) -> bool:
    """Whether heights fall towards the columns k and k + 1 of a profile from both sides."""
    return bool(0 < k < SEEN - 2 and heights[k - 1] > heights[k] and heights[k + 2] > heights[k + 1])


@kernel(lean=True, inlined=True)
def may_cross(heights: Array, height: float) -> bool:
    """Whether a surface of these heights (SEEN,) [m] may cross a row, or have a furrow that is deeper.

    Nearly all rows are above what is there, or deep inside of it.
    """
    above, dips = 0, False
    for k in range(SEEN):
        above += 1 if heights[k] > height else 0
        dips |= dips_between(heights, k)
    return dips if above == SEEN else above > 0


@kernel(lean=True, inlined=True)
def read_heights(field: Field, line: RimLine, heights: Array) -> None:
    """The heights (SEEN,) of the columns of a line across the way [m]."""
    for k in range(SEEN):
        i, j = column_on(line, k)
        heights[k] = highest_at(field, i, j)


@kernel(lean=True, inlined=True)
def place_columns(field: Field, tip: Array, heading: Heading, line: RimLine, profile: EdgeProfile) -> None:
    """Where the columns of a line across the way are, seen from the tip; `read_heights` says how high."""
    for k in range(SEEN):
        i, j = column_on(line, k)
        x, y = middle_of(field, i, j)
        own_x, own_y = x - tip[0], y - tip[1]
        profile.aheads[k] = own_x * heading.ux + own_y * heading.uy
        profile.asides[k] = own_x * line.out_x + own_y * line.out_y


@kernel(lean=True, inlined=True)
def read_radii(pieces: Array, row: RimRow, k: int, profile: EdgeProfile) -> None:
    """Fill in the radii of the edge at the heights of the columns k and k + 1 and of those beside them."""
    for m in range(max(k - 1, 0), min(k + 3, SEEN)):
        profile.radii[m] = radius_of_edge(pieces, max(profile.heights[m] - row.tip, 0.0))


@kernel(lean=True, inlined=True)
def line_reaches(at: float, value: float, slope: float, target: float, never: float) -> float:
    """Where a straight line that rises reaches a value; `never` where it does not rise."""
    return at + (target - value) / slope if slope > 0.0 else never


class Rise(NamedTuple):
    """Two columns of a profile, the lower and the higher one, and how far from one to the other the higher end is [m].

    That end, where the surface has the height `top` [m], is the higher column or, before it, the foot of a wall.
    """

    low: int
    high: int
    gap: float
    top: float
    walled: bool


@kernel(lean=True)
def crossing_on(profile: EdgeProfile, values: Array, rise: Rise, end: float, target: float, least: float) -> float:
    """How far from the lower end [m] the surface of a rise has a value; `end`: that at its higher end.

    Lines on through the two columns on either side make a crest or a furrow between them, as edges of grooves are;
    columns below the height `least` [m] say nothing of a line.
    """
    at, (low, high, gap, _, walled) = profile.asides, rise
    before, behind = low + (low - high), high + (high - low)
    chord, grown = gap * (target - values[low]) / (end - values[low]), end - values[low]
    slope_low, slope_high, known_low, known_high = 0.0, 0.0, False, False
    if 0 <= before < SEEN and profile.heights[before] >= least:
        slope_low, known_low = (values[low] - values[before]) / abs(at[low] - at[before]), True
    if not walled and 0 <= behind < SEEN and profile.heights[behind] >= least:
        slope_high, known_high = (values[behind] - values[high]) / abs(at[behind] - at[high]), True
    way = chord
    if known_low and slope_low * gap > grown:  # a crest: the lower of both lines
        way = line_reaches(0.0, values[low], slope_low, target, 0.0)
        if known_high:
            way = max(way, line_reaches(gap, end, slope_high, target, 0.0))
    elif known_high and slope_high * gap > grown:  # a furrow: the higher one
        way = line_reaches(gap, end, slope_high, target, gap)
        if known_low:
            way = min(way, line_reaches(0.0, values[low], slope_low, target, gap))
    return float(min(max(way, 0.0), gap))


@kernel(lean=True, inlined=True)
def wall_in(
    field: Field, tip: Array, heading: Heading, profile: EdgeProfile, k: int, height: float, row: RimRow
) -> tuple[bool, float, float]:
    """The wall between columns k and k + 1 of a profile at a height: whether it is known, where, and its foot [m]."""
    ux, uy = heading.ux, heading.uy
    ahead = 0.5 * (profile.aheads[k] + profile.aheads[k + 1])
    aside = 0.5 * (profile.asides[k] + profile.asides[k + 1])
    x, y = tip[0] + ux * ahead - uy * aside * row.side, tip[1] + uy * ahead + ux * aside * row.side
    wall = wall_near(field, x, y, height - THIN, height, ux, uy, profile.line)
    return wall.known, aside + row.side * wall.aside, wall.foot


@kernel(lean=True)
def place_between(
    field: Field, pieces: Array, tip: Array, heading: Heading, profile: EdgeProfile, k: int, row: RimRow
) -> float:
    """Where the surface crosses a row between the columns k and k + 1 of a profile, one above it and one below [m]."""
    at, heights = profile.asides, profile.heights
    low, high = (k, k + 1) if heights[k] < heights[k + 1] else (k + 1, k)
    if heights[low] == -np.inf:
        return float(0.5 * (at[k] + at[k + 1]))
    known, place, foot = wall_in(field, tip, heading, profile, k, row.height, row)
    if known:
        return place
    onward, gap, walled = 1.0 if at[high] > at[low] else -1.0, abs(at[high] - at[low]), False
    top, radius = heights[high], profile.radii[high]
    known, place, foot = wall_in(field, tip, heading, profile, k, top - THIN, row)
    way = onward * (place - at[low])
    if known and row.height < foot < top and 0.0 < way < gap:
        gap, top, radius, walled = way, foot, radius_of_edge(pieces, foot - row.tip), True
    rise = Rise(low, high, gap, top, walled)
    if heights[low] < row.tip or radius <= profile.radii[low]:
        return float(at[low] + onward * crossing_on(profile, heights, rise, top, row.height, LOWEST))
    return float(at[low] + onward * crossing_on(profile, profile.radii, rise, radius, row.radius, row.tip))


@kernel(lean=True, inlined=True)
def furrow_at(profile: EdgeProfile, k: int, row: RimRow) -> tuple[float, float]:
    """Between which places, outer and inner [m], a furrow is deeper than a row that no column k or k + 1 shows.

    Not in order where there is none.
    """
    at, heights, radii, target = profile.asides, profile.heights, profile.radii, row.radius
    if min(heights[k - 1], heights[k + 2]) < row.tip:
        return 0.0, 1.0
    slope_outer, slope_inner = radii[k - 1] - radii[k], radii[k + 2] - radii[k + 1]
    if slope_outer <= 0.0 or slope_inner <= 0.0:
        return 0.0, 1.0
    outer = at[k] - (radii[k] - target) / slope_outer * (at[k - 1] - at[k])
    return float(outer), float(at[k + 1] + (radii[k + 1] - target) / slope_inner * (at[k + 1] - at[k + 2]))


@kernel(lean=True)
def see_rim(
    field: Field, pieces: Array, tip: Array, heading: Heading, clearance: Clearance, ahead: float, row: RimRow,
    about: float, profile: EdgeProfile,
) -> RimSight:  # fmt: skip
    """The outermost place up to about there, inside the rim, where the surface of a profile crosses a row.

    The profile is that so far `ahead` [m] of the tip, and has its heights already.
    """
    place_columns(field, tip, heading, line_across_way(field, tip, heading, ahead, row, about), profile)
    radius, at, heights = row.radius, profile.asides, profile.heights
    for k in range(SEEN - 1):
        if at[k + 1] >= about:
            continue
        if at[k] < about - DEEPEST * clearance.aside:
            break
        outer, inner = heights[k] > row.height, heights[k + 1] > row.height
        if outer and inner and dips_between(heights, k):
            read_radii(pieces, row, k, profile)
            begin, end = furrow_at(profile, k, row)
            if begin > end and about > end:
                return RimSight(True, begin, True) if about > begin else RimSight(True, end, False)
        if outer == inner:
            continue
        read_radii(pieces, row, k, profile)
        place = place_between(field, pieces, tip, heading, profile, k, row)
        if place >= radius * (1.0 - ON_RIM):
            continue
        return RimSight(True, place, outer)
    return RimSight(False, 0.0, False)


@kernel(lean=True, inlined=True)
def ahead_of(row: RimRow, heading: Heading, ahead: float) -> RimRow:
    """The row so far ahead, where it is higher or lower."""
    rise = heading.climb * ahead
    return RimRow(row.radius, row.tip + rise, row.height + rise, row.side)


@kernel(lean=True)
def rim_on_arc(
    field: Field, pieces: Array, tip: Array, heading: Heading, clearance: Clearance, row: RimRow, front: float,
    about: float, line: Array,
) -> tuple[ContactLimit, bool]:  # fmt: skip
    """`rim_limit` on a way that turns: seen where the tool will be, across its way there."""
    ux, uy, level, climb, turn = heading
    profile, place = profile_of(line), line[LINES * SEEN + 4 : LINES * SEEN + 7]
    inner = row.side * max(about - DEEPEST * clearance.aside, 0.0)
    outer = row.side * (about + clearance.aside)
    if min(1.0 - turn * inner, 1.0 - turn * outer) < STEEPEST_TURN:
        return no_limit(), False
    half = 0.25 * turn * turn * (front * front - inner * inner) / (1.0 - turn * inner)  # squared sine of half the angle
    if half >= 1.0:
        return no_limit(), False
    cosine, sine = 1.0 - 2.0 * half, 2.0 * np.sqrt(half * (1.0 - half)) * (1.0 if turn > 0.0 else -1.0)
    ahead, aside = sine / turn, 2.0 * half / turn
    place[0], place[1], place[2] = tip[0] + ux * ahead - uy * aside, tip[1] + uy * ahead + ux * aside, tip[2]
    there = Heading(ux * cosine - uy * sine, uy * cosine + ux * sine, level, climb, turn)
    at_rim = ahead_of(row, heading, np.sqrt(front * front - inner * inner))
    read_heights(field, line_across_way(field, place, there, 0.0, at_rim, about), profile.heights)
    if not may_cross(profile.heights, at_rim.height):
        return no_limit(), False
    seen = see_rim(field, pieces, place, there, clearance, 0.0, at_rim, about, profile)
    if not seen.known:
        return no_limit(), False
    off = row.side * seen.aside
    left = on_way(row.radius * row.radius, off, turn)
    return ContactLimit(angle_at(0.0, left, 0.0, row.radius, 0.0), 0.0, left, 0.0, row.tip), seen.full


@kernel(lean=True, inlined=True)
def may_have_rim(
    field: Field, tip: Array, heading: Heading, clearance: Clearance, row: RimRow, front: float, about: float,
    heights: Array,
) -> bool:  # fmt: skip
    """Whether `rim_limit` may find a limit, by the heights (SEEN,) that it looks at first; most rows have none."""
    if heading.turn != 0.0:
        return True
    inner = max(about - DEEPEST * clearance.aside, 0.0)
    near = heading.level * np.sqrt(front * front - inner * inner)
    at_rim = ahead_of(row, heading, near)
    read_heights(field, line_across_way(field, tip, heading, near, at_rim, about), heights)
    return may_cross(heights, at_rim.height)


@kernel(lean=True)
def rim_limit(
    field: Field, pieces: Array, tip: Array, heading: Heading, clearance: Clearance, row: RimRow, front: float,
    about: float, line: Array,
) -> tuple[ContactLimit, bool]:  # fmt: skip
    """The limit of a row at a surface not far inside of about there, and whether material is outside it.

    Columns as far as `front` [m] from the axis have not been cut by the tool. On a straight way `may_have_rim` has
    been asked before, which leaves in `line` the heights that are looked at first.
    """
    profile, inner = profile_of(line), max(about - DEEPEST * clearance.aside, 0.0)
    if heading.turn != 0.0:
        return rim_on_arc(field, pieces, tip, heading, clearance, row, front, about, line)
    near = heading.level * np.sqrt(front * front - inner * inner)
    at_rim = ahead_of(row, heading, near)
    seen = see_rim(field, pieces, tip, heading, clearance, near, at_rim, about, profile)
    if not seen.known:
        return no_limit(), False
    aside, side = row.side * seen.aside, SLOPE_LEFT if row.side > 0.0 else SLOPE_RIGHT
    if line[side] != UNSEEN:
        angle = angle_at(near, aside, line[side], row.radius, 0.0)
        return ContactLimit(angle, near, aside, line[side], row.tip), seen.full
    far = near + BASE * clearance.aside
    at_rim = ahead_of(row, heading, far)
    read_heights(field, line_across_way(field, tip, heading, far, at_rim, about), profile.heights)
    if not may_cross(profile.heights, at_rim.height):
        return no_limit(), False
    other = see_rim(field, pieces, tip, heading, clearance, far, at_rim, about, profile)
    slope = row.side * (other.aside - seen.aside) / (far - near)
    if not other.known or other.full != seen.full or abs(slope) > STRAIGHT:
        return no_limit(), False
    slope *= near / (0.5 * (near + far))  # of an arc around a centre beside the axis, at the nearer place
    line[side] = slope
    return ContactLimit(angle_at(near, aside, slope, row.radius, 0.0), near, aside, slope, row.tip), seen.full
