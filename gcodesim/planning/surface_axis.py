"""The tool axis from a surface: along feeds the tool stands on the normal of a part, with a lead and a tilt.

Along the way directions are averaged, so that the tool turns over an edge instead of jumping at it, and words a, b, c
run along splines through them; the rows of the path stay as they are.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.distinct import distinct
from gcodesim.arithmetic.elementary import cos_sin
from gcodesim.arithmetic.matrices import dots, norms
from gcodesim.diagnostics import Diagnostic
from gcodesim.frames import Array, Pose
from gcodesim.frozen import frozen
from gcodesim.motion.pieces import Pieces
from gcodesim.motion.tool_path import ARC, LINE
from gcodesim.planning.moments import OnBlock, OnPiece, PathFindings
from gcodesim.planning.spin_along import SpinAlong
from gcodesim.units import DEG, MM

if TYPE_CHECKING:
    from gcodesim.material.skin_normals import SkinNormals

Numbers = NDArray[np.int64]
WordsOf = Callable[[Array, Array], Array]
"""Words (n, 3) of directions (n, 3) from tip to holder in M, one after the other from words (3,) on; NaN: cannot be."""

_SAMPLES: Final = 6  # in the length over which directions are averaged
_OPEN: Final = 0.5  # of the mean of unit vectors: below, they face more than 120 deg apart
_SAME: Final = 1e-12  # [m, rad] between words that count as not written
_STEEP: Final = 1e-3  # of a unit tangent: less of it along the surface is no way to lean by
_APART: Final = 1e-9  # [m] between two knots
_STILL: Final = 1e-6  # [rad] on a piece that are no turn
_HALVINGS: Final = 30  # of a turn between two knots, for where the travel of an axis ends
_NEAR_TRAVEL: Final = 0.5  # of the way between two knots, within which the end of a travel takes the place of one
_OWN: Final = 8  # knots on a piece whose words the program says


@frozen(eq=False)
class WordsAlong:
    """Words a, b, c along pieces: those of the path, on the pieces that are `led` (m,) those of `splines`.

    `lengths` (m,) [m] are those of the pieces.
    """

    splines: tuple[SpinAlong, ...]
    led: NDArray[np.bool_]
    lengths: Array

    def at(self, piece: Numbers, s: Array, said: Array) -> Array:
        """Words (k, 3) at `s` (k,) of `piece` (k,), where the path has those that are `said` (k, 3)."""
        words = said.copy()
        here = self.led[piece]
        for column, spline in enumerate(self.splines):
            words[here, column] = spline.at(piece[here], s[here])[0]
        return words

    def parts(self, piece: NDArray[np.int64], step: float) -> Array:
        """How many parts (k,) of each `piece` (k,) words turn in: twice as many as there are knots where they turn,
        and so many that none turns by more than `step` [rad]."""
        turn, knots = np.zeros(len(self.led)), np.zeros(len(self.led))
        for spline in self.splines:
            on = np.clip(np.searchsorted(spline.begin, spline.way, side="right") - 1, 0, len(turn) - 1)
            fastest = np.zeros(len(turn))
            np.maximum.at(fastest, on, np.abs(spline.slope))
            turn = np.maximum(turn, fastest * self.lengths)
            knots = np.bincount(on, minlength=len(turn)).astype(np.float64)
        return np.where(self.led[piece] & (turn[piece] > _STILL), np.maximum(turn / step, 2.0 * knots)[piece], 0.0)


@frozen(eq=False)
class Tipped:
    """Where the tip is commanded along pieces: on which rows (n,), and X_MB of the frame in which the path is given.

    With `joint_heads` every chain begins with a joint move, which already ends in the attitude of the first feed; else
    the words before and after are those that the program says.

    Where a machine cannot point its tool along a direction (3,) from words (3,) on, `lack` tells why.
    """

    rows: NDArray[np.bool_]
    X_MB: Pose
    joint_heads: bool
    lack: Callable[[Array, Array], AxisLack | None] | None = None


@frozen(kw_only=False)
class AxisLack:
    """A rotary axis would have to be at `value`, beyond the end of its travel at `limit` [rad]."""

    letter: str
    value: float
    limit: float


@frozen(eq=False)
class SurfaceAxis:
    """The surface of `name` in M.

    `lead` [rad] leans the holder along the feed, `tilt` to its right, both seen from outside. Over `smooth` [m] of the
    way to both sides directions are averaged; farther than `within` [m] a feed should not be from the surface.
    """

    name: str
    skin: SkinNormals
    lead: float
    tilt: float
    smooth: float
    within: float

    def directions(self, points: Array) -> Array:
        """Normals (k, 3) beside `points` (k, 3) in M; upright where these are away from the surface."""
        distance, normal = self.skin.nearest(points)
        return np.where((distance <= self.within)[:, None], normal, [0.0, 0.0, 1.0])

    def along(self, pieces: Pieces, tipped: Tipped, words_of: WordsOf, findings: PathFindings) -> WordsAlong:
        """Words along `pieces` that lean the tool wherever the tip is commanded.

        Feeds whose block has words of its own keep them. Between feeds the tool turns evenly, and stands as the
        program says where a rapid ends away from the surface.
        """
        path = pieces.path
        led: NDArray[np.bool_] = tipped.rows[pieces.row_first] & ~pieces.fixed
        own: NDArray[np.bool_] = np.any(np.abs(path.end[:, 3:] - path.start[:, 3:]) > _SAME, axis=1)
        feeds = ~own & ((path.kind == LINE) | (path.kind == ARC))
        knots = _Knots(self, pieces, tipped, words_of, findings)
        begins = np.flatnonzero(led & ~np.concatenate([[False], led[:-1]])[: len(led)])
        for begin in begins.tolist():
            end = begin + int(np.argmin(np.append(led[begin:], False)))
            knots.chain(begin, end, feeds, own)
            if tipped.joint_heads and begin:
                led[begin - 1] = True  # a joint move, which ends there
        return WordsAlong(splines=knots.splines(), led=led, lengths=pieces.length)

    def leant(self, normal: Array, points: Array) -> Array:
        """Directions (k, 3) from tip to holder on `normal` (k, 3) along the way through `points` (k, 3)."""
        if not (self.lead or self.tilt) or len(points) < 2:
            return normal
        way = np.concatenate([points[1:2] - points[:1], np.diff(points, axis=0)])
        size = norms(way)
        way = way / np.maximum(size, 1e-300)[:, None]
        along = way - dots(way, normal)[:, None] * normal
        flat = norms(along)
        known = (size > 0.0) & (flat > _STEEP)
        along = np.where(known[:, None], along / np.maximum(flat, _STEEP)[:, None], 0.0)
        right = np.cross(along, normal)
        (cl, sl), (ct, st) = cos_sin(self.lead), cos_sin(self.tilt)
        leaning = ct * (cl * normal + sl * along) + st * right
        found: Array = np.where(known[:, None], leaning, normal)
        return found

    def report_far(self, pieces: Pieces, row: NDArray[np.intp], distance: Array, findings: PathFindings) -> None:
        """GS217 for rows that are nowhere within reach of the surface."""
        path = pieces.path
        least = np.full(len(path), np.inf)
        np.minimum.at(least, row, distance)
        far = np.flatnonzero(np.isfinite(least) & (least > self.within))
        if not len(far):
            return
        most = float(least[far].max())
        findings.add(
            Diagnostic(
                code="GS217",
                message=f"the feed is {most / MM:.1f} mm away from `{self.name}`, whose normal is the tool axis",
                span=path.span(int(far[0])),
                hint=f"up to {self.within / MM:g} mm are expected (`within` of `orientation`); look at where it stands",
                count=len(distinct(path.block[far])),
                value=most,
                limit=self.within,
                unit="m",
            ),
            at=OnBlock(int(path.block[far[0]])),
        )

    def report_open(self, pieces: Pieces, place: tuple[Numbers, Array], size: Array, findings: PathFindings) -> None:
        """GS218 where the surface faces so many ways that their mean says little: at s (k,) of a piece (k,)."""
        vague = size < _OPEN
        if not vague.any():
            return
        row, first = pieces.row_first[place[0]], int(np.argmax(vague))
        findings.add(
            Diagnostic(
                code="GS218",
                message=f"`{self.name}` leaves the tool axis open: its normal turns by more than 120 deg within "
                f"{self.smooth / MM:g} mm of the way",
                span=pieces.path.span(int(row[first])),
                hint="go round the edge with a rapid, or say the axis in the block (I J K)",
                count=len(distinct(pieces.path.block[row[vague]])),
                value=float(size.min()),
                limit=_OPEN,
                unit="",
            ),
            at=OnPiece(int(place[0][first]), float(place[1][first])),
        )

    def report_lost(
        self, pieces: Pieces, lost: Numbers, at: OnPiece, why: tuple[Array, AxisLack | None], findings: PathFindings
    ) -> None:
        """GS219 on the pieces `lost` (k,), begun `at` a place: the machine cannot turn so, least of all along the
        direction (3,) of `why`.
        """
        row, ((x, y, z), lack) = pieces.row_first[lost], why
        needs = ""
        if lack is not None:
            needs = (
                f": {lack.letter} would be at {lack.value / DEG:.2f} deg, its travel ends at {lack.limit / DEG:g} deg"
            )
        findings.add(
            Diagnostic(
                code="GS219",
                message=f"the machine cannot bring the tool upright on `{self.name}`, along "
                f"X{x:.3f} Y{y:.3f} Z{z:.3f}{needs}; it stays as near as it can",
                span=pieces.path.span(int(row[0])),
                hint="its rotary axes do not turn so far: clamp the work otherwise, or change `lead` and `tilt`",
                count=len(distinct(pieces.path.block[row])),
                value=None if lack is None else lack.value,
                limit=None if lack is None else lack.limit,
                unit=None if lack is None else "rad",
            ),
            at=at,
        )


class _Knots:
    """Words at places of the pieces, chain by chain, through which splines go."""

    def __init__(
        self, surface: SurfaceAxis, pieces: Pieces, tipped: Tipped, words_of: WordsOf, findings: PathFindings
    ) -> None:
        self.surface, self.pieces, self.tipped = surface, pieces, tipped
        self.words_of, self.findings = words_of, findings
        self.places: list[Numbers] = []
        self.ways: list[Array] = []
        self.words: list[Array] = []

    def splines(self) -> tuple[SpinAlong, ...]:
        """One for each of a, b, c."""
        if not self.words:
            return ()
        columns = ([words[:, axis] for words in self.words] for axis in range(3))
        return tuple(SpinAlong.through(self.pieces, self.places, self.ways, each, soft=True) for each in columns)

    def chain(self, begin: int, end: int, feeds: NDArray[np.bool_], own: NDArray[np.bool_]) -> None:
        """The knots from piece `begin` to the one before `end`."""
        pieces, path = self.pieces, self.pieces.path
        found: list[tuple[Numbers, Array, Array]] = []
        words = path.start[pieces.row_first[begin], 3:]
        if not self.tipped.joint_heads:
            found.append((np.array([begin]), np.zeros(1), words[None]))
        at = begin
        while at < end:
            row = int(pieces.row_first[at])
            if feeds[row]:
                after = at + int(np.argmin(np.append(feeds[pieces.row_first[at:end]], False)))
                found.append(self._feeds(np.arange(at, after), words))
                at = after
            else:
                knots = self._said(at) if own[row] else self._away(at)
                found += [] if knots is None else [knots]
                at += 1
            words = found[-1][2][-1] if found else words
        if not self.tipped.joint_heads:
            last = path.end[pieces.row_last[end - 1], 3:]
            found.append((np.array([end - 1]), pieces.length[end - 1 : end], last[None]))
        elif begin and pieces.fixed[begin - 1]:
            first = found[0] if found else (np.array([begin]), np.zeros(1), words[None])
            if first[0][0] > begin or first[1][0] > 0.0 or not found:
                found.insert(0, (np.array([begin - 1]), np.zeros(1), first[2][:1]))
        if found:
            place, way, words = (np.concatenate(column) for column in zip(*found, strict=True))
            ends = np.cumsum(pieces.length[place[0] : end])
            along = ends[place - place[0]] - pieces.length[place] + way
            # of two at one place the later one counts: a rapid ends as the feed begins, and last is what is said
            kept = np.append(np.diff(along) > _APART, True)
            self.places.append(place[kept].astype(np.int64))
            self.ways.append(way[kept])
            self.words.append(words[kept])

    def _said(self, piece: int) -> tuple[Numbers, Array, Array]:
        """Where the program says words itself."""
        s = self.pieces.length[piece] * np.arange(1, _OWN + 1) / _OWN
        place = np.full(len(s), piece)
        return place, s, self.pieces.points(place, s)[0][:, 3:]

    def _away(self, piece: int) -> tuple[Numbers, Array, Array] | None:
        """The end of a move that is no feed, if that is away from the surface."""
        place, s = np.array([piece]), self.pieces.length[piece : piece + 1]
        point = self.pieces.points(place, s)[0]
        if self.surface.skin.nearest(self.tipped.X_MB.apply(point[:, :3]))[0][0] <= self.surface.within:
            return None
        return place, s, point[:, 3:]

    def _feeds(self, run: NDArray[np.intp], before: Array) -> tuple[Numbers, Array, Array]:
        """Feeds one after the other on the surface."""
        pieces, surface = self.pieces, self.surface
        length = pieces.length[run]
        count = np.maximum(np.ceil(length * _SAMPLES / surface.smooth), 1.0).astype(np.int64)
        index = np.repeat(np.arange(len(run)), count)
        share = (np.arange(len(index)) - np.repeat(np.cumsum(count) - count, count) + 1.0) / count[index]
        index, share = np.concatenate([[0], index]), np.concatenate([[0.0], share])
        place, s = run[index].astype(np.int64), length[index] * share
        points = self.tipped.X_MB.apply(pieces.points(place, s)[0][:, :3])
        distance, normal = surface.skin.nearest(points)
        way = np.concatenate([[0.0], np.cumsum(norms(np.diff(points, axis=0)))])
        direction, size = _averaged(way, surface.leant(normal, points), surface.smooth)
        row = pieces.row_first[place].astype(np.intp)
        surface.report_far(pieces, row, distance, self.findings)
        surface.report_open(pieces, (place, s), size, self.findings)
        words = self.words_of(direction, before)
        lost = np.isnan(words).any(axis=1)
        if lost.any():
            begin = self._lost_from(place, s, direction, words)
            why = self._why(direction[lost], before)
            surface.report_lost(pieces, place[lost], begin, why, self.findings)
            place, s, words = self._up_to_travel(place, s, direction, words)
        return place, s, _held(words, before)

    def _lost_from(self, place: Numbers, s: Array, direction: Array, words: Array) -> OnPiece:
        """Where the machine comes to the end of its travel first."""
        k = int(np.argmax(np.any(np.isnan(words), axis=1)))
        if k == 0:
            return OnPiece(int(place[0]), float(s[0]))
        share, _ = self._last_known(direction[k - 1], direction[k], words[k - 1])
        begin = s[k - 1] if place[k - 1] == place[k] else 0.0
        return OnPiece(int(place[k]), float(begin + share * (s[k] - begin)))

    def _why(self, directions: Array, before: Array) -> tuple[Array, AxisLack | None]:
        """The one of the directions (k, 3) that an axis misses by most, and by how much it does."""
        lack = self.tipped.lack
        found = [] if lack is None else [(lack(direction, before), direction) for direction in directions]
        known = [(each, direction) for each, direction in found if each is not None]
        if not known:
            return directions[0], None
        worst, direction = max(known, key=lambda pair: abs(pair[0].value - pair[0].limit))
        return direction, worst

    def _up_to_travel(self, place: Numbers, s: Array, direction: Array, words: Array) -> tuple[Numbers, Array, Array]:
        """The knots with those where the machine comes to the end of its travel, or can turn again.

        One of these takes the place of a knot that is near to it: braking takes its way.
        """
        lost: NDArray[np.bool_] = np.any(np.isnan(words), axis=1)
        kept: NDArray[np.bool_] = np.ones(len(words), dtype=bool)
        at = np.flatnonzero(lost[1:] != lost[:-1])
        new: list[tuple[int, float, Array]] = []
        for k in at.tolist():
            known, other = (k + 1, k) if lost[k] else (k, k + 1)
            share, there = self._last_known(direction[known], direction[other], words[known])
            kept[known] &= share > _NEAR_TRAVEL
            on = place[k] == place[k + 1]
            begin = s[k] if on else 0.0
            way = 1.0 - share if lost[k] else share
            new.append((int(place[k + 1]), float(begin + way * (s[k + 1] - begin)), there))
        order = np.argsort(np.concatenate([np.flatnonzero(kept), at + 0.5]), kind="stable")
        columns = (
            (place[kept], np.array([each[0] for each in new], dtype=np.int64)),
            (s[kept], np.array([each[1] for each in new])),
            (words[kept], np.array([each[2] for each in new]).reshape(-1, 3)),
        )
        first, second, third = (np.concatenate(pair)[order] for pair in columns)
        return first, second, third

    def _last_known(self, known: Array, other: Array, words: Array) -> tuple[float, Array]:
        """How much of the turn from the direction `known`, with its `words`, to the `other` can be had; words there."""
        low, high = 0.0, 1.0
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            between = known + middle * (other - known)
            found = self.words_of(between[None] / norms(between[None])[:, None], words)[0]
            if np.isnan(found).any():
                high = middle
            else:
                low, words = middle, found
        return low, words


def _averaged(way: Array, directions: Array, reach: float) -> tuple[Array, Array]:
    """Means of `directions` (k, 3) at `way` (k,) over twice `reach` [m], as unit vectors, and their sizes (k,).

    A box of a third of the width, three times: so the turn begins and ends softly, and facets leave no steps.
    """
    if way[-1] <= 0.0:
        return directions, np.ones(len(way))
    mean = directions
    for _ in range(3):
        steps = np.diff(way)[:, None] * 0.5 * (mean[1:] + mean[:-1])
        sums = np.concatenate([np.zeros((1, 3)), np.cumsum(steps, axis=0)])
        low, high = np.maximum(way - reach / 3.0, 0.0), np.minimum(way + reach / 3.0, way[-1])
        known = np.concatenate([[True], np.diff(way) > 0.0])  # rows without a length do not count
        ends = [np.stack([np.interp(at, way[known], sums[known, k]) for k in range(3)], axis=1) for at in (low, high)]
        mean = (ends[1] - ends[0]) / (high - low)[:, None]
    size = norms(mean)
    return mean / np.maximum(size, 1e-300)[:, None], size


def _held(words: Array, before: Array) -> Array:
    """`words` (n, 3) where they are known; elsewhere those beside, or from one side evenly to the other.

    Where none is known, they are those `before` (3,).
    """
    held = words.copy()
    known = np.flatnonzero(~np.isnan(words).any(axis=1))
    if not len(known):
        held[:] = before
        return held
    held[: known[0]], held[known[-1] :] = words[known[0]], words[known[-1]]
    for last, first in pairwise(known.tolist()):
        share = np.linspace(0.0, 1.0, first - last - 1)[:, None]
        held[last + 1 : first] = words[last] + share * (words[first] - words[last])
    return held
