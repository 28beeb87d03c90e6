"""Posing of machine tools with rotary axes whose program commands the tip: tool centre point control.

Rows in which the axes are commanded are those of `AxisPosing`. In the others the tip runs along the row in the frame of
the work while the rotary axes turn evenly; the linear axes follow on curves. The path is joined and timed at the tip,
and cut into segments so short that joints bend evenly in each, which then has caps by the limits of the joints.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import greatest
from gcodesim.canon import Axes
from gcodesim.frames import Array, Pose
from gcodesim.frozen import frozen
from gcodesim.kinematics.tool_point import ToolPoint
from gcodesim.motion.blend import along_limits, blend
from gcodesim.motion.blend_kernels import NORMAL_SHARE
from gcodesim.motion.curve_kernels import ROUND
from gcodesim.motion.curves import Curves
from gcodesim.motion.pieces import OVERLAP, Pieces
from gcodesim.motion.printer_law import is_printed
from gcodesim.motion.timing import Caps
from gcodesim.motion.tool_path import Commanded, ToolPath
from gcodesim.motion.trajectory import Samples
from gcodesim.planning.arm_kernels import JointCaps, SegmentRates, joint_caps
from gcodesim.planning.axis_posing import AxisPosing, axes_at, limits_of_axes, offsets
from gcodesim.planning.bent_ways import report_bent_rapids, report_jumps
from gcodesim.planning.feeds import report_fast_feeds
from gcodesim.planning.jerk import softer
from gcodesim.planning.kinks import Kinks
from gcodesim.planning.moments import PathFindings
from gcodesim.planning.plan import JointExtremes, JointPath
from gcodesim.planning.posing import Posed
from gcodesim.planning.reach import report_slow_joints
from gcodesim.planning.surface_axis import AxisLack, SurfaceAxis, Tipped, WordsAlong
from gcodesim.planning.travel import TravelEnds, axis_ranges, report_missing_axes, report_travel

if TYPE_CHECKING:
    from gcodesim.kinematics.protocol import Kinematics

_SPACING: Final = 5e-3  # [m] of the tip in a segment
_STEP: Final = 0.04  # [rad] of a rotary axis in a segment: a joint leaves its parabola by less than 1e-5 of its arm
_BEND: Final = 0.1  # [rad] of direction in a segment of an arc
_PROBE: Final = 1e-5  # [m, rad] over which a slope is taken
_SHARE: Final = 0.99  # of each limit; the rest is for the change of q'' within a segment
_EVEN: Final = 1e-7  # [-] of the greatest rate by which rates may differ along which joints go evenly


@frozen(kw_only=False, eq=False)
class TipWay:
    """Pieces of which those of the rows `held` (n,) command the tip, with rotary axes by `turning` (None: as said)."""

    pieces: Pieces
    tool: ToolPoint
    held: NDArray[np.bool_]
    turning: WordsAlong | None = None

    def joints(self, piece: NDArray[np.int64], s: Array, position: Array) -> Array:
        """Joints (n, j) at `s` (n,) of `piece` (n,), with the controlled point at `position` (n, 6)."""
        if self.turning is not None:
            words = self.turning.at(piece, s, position[:, 3:])
            position = np.concatenate([position[:, :3], words], axis=1)
        row = self.pieces.row_first[piece]  # while the machine stands, a sample is already of the next row
        offset = offsets(self.pieces.path, row)
        q: Array = np.ascontiguousarray((position + offset)[:, self.tool.columns])
        tip = self.held[row]
        if tip.any():
            q[tip] = _joints_of_tips(self.tool, position[tip], offset[tip])
        return q


@frozen(slots=False, kw_only=False, eq=False)
class AttitudeJoints:
    """Joints along a trajectory; `low` and `high` (n, 6) are the least and greatest axis values of each row."""

    way: TipWay
    start: Array
    low: Array
    high: Array

    def joints(self, samples: Samples) -> Array:
        """Joint values (n, j) [m, rad]."""
        if not len(self.way.pieces):
            return np.tile(self.start[self.way.tool.columns], (len(samples), 1))
        return self.way.joints(samples.piece, samples.s, samples.position)

    def extremes(self) -> JointExtremes:
        """How far each axis goes, in the segments that were looked at."""
        columns = self.way.tool.columns
        low, high = self.low[:, columns], self.high[:, columns]
        at = self.start[columns]
        low[0], high[0] = np.minimum(low[0], at), np.maximum(high[0], at)
        return JointExtremes(low.min(axis=0), high.max(axis=0), low.argmin(axis=0), high.argmax(axis=0))


@frozen(eq=False)
class AxisAttitude:
    """A machine tool with rotary axes; a program may command its axes, or the tip and the rotary axes.

    While the tip is commanded the tool may stand on the normal of a `surface`.
    """

    tool: ToolPoint
    independent_rapids: bool = False
    surface: SurfaceAxis | None = None

    @property
    def understands(self) -> frozenset[Commanded]:
        return frozenset((Commanded.AXES, Commanded.POINT))

    def start(self, kinematics: Kinematics, home: Array) -> Axes:
        """Where the control point stands at `home` (j,), without tool offset: a program begins by its axes."""
        return axes_at(kinematics.joints.names, home)

    def pose(self, path: ToolPath, kinematics: Kinematics, home: Array, findings: PathFindings) -> Posed:
        """Joints within their limits wherever the tip is commanded; positions outside the travel are reported."""
        held = np.array([state.control == Commanded.POINT for state in path.states])[path.state]
        soft = bool(np.isfinite(kinematics.joints.jerk).any())
        if is_printed(path, soft) or not (held.any() or soft):
            plain = AxisPosing(independent_rapids=self.independent_rapids)
            return plain.pose(path, kinematics, home, findings)
        tool, joints = self.tool, kinematics.joints
        limits = limits_of_axes(joints)
        report_missing_axes(path, tool.columns, findings)
        possible = np.where(held, np.inf, along_limits(Curves.of(path), limits)[0])
        report_fast_feeds(path, possible, limits.speed, findings)
        if held.any():
            ends = [_joints_of_tips(tool, points, offsets(path)) for points in (path.start, path.end)]
            report_jumps(path, tool, held, np.stack(ends), findings)
        independent = ~held if self.independent_rapids else False
        pieces = blend(path, limits, independent_rapids=independent, even=soft)
        way = TipWay(pieces, tool, held, self._turning(pieces, held, findings))
        segments = Segments.of(pieces, held | soft, way.turning)
        q0, q1 = (way.joints(segments.piece, s, segments.at(pieces, s)[0]) for s in segments.ends)
        low, high = _ranges(path, tool, held)
        for row in (pieces.row_first[segments.piece], pieces.row_last[segments.piece]):
            for q in (q0, q1):
                values = np.full((len(row), 6), np.nan)
                values[:, tool.columns] = q
                np.fmin.at(low, row, values)
                np.fmax.at(high, row, values)
        report_travel(path, tool.columns, TravelEnds.of(joints), findings, (low, high))
        report_bent_rapids(pieces, findings)
        caps = _caps(kinematics, way, segments, (q0, q1), findings)
        start = np.array(axes_at(joints.names, home))
        return Posed(pieces, AttitudeJoints(way, start, low, high), caps)

    def _turning(self, pieces: Pieces, held: NDArray[np.bool_], findings: PathFindings) -> WordsAlong | None:
        """Rotary axes along the pieces where a surface gives the tool axis."""
        if self.surface is None or not len(pieces):
            return None
        tipped = Tipped(rows=held, X_MB=Pose.identity(), joint_heads=False, lack=self._lack)
        return self.surface.along(pieces, tipped, self._turned, findings)

    def _turned(self, directions: Array, before: Array) -> Array:
        """Words a, b, c (n, 3) that point the tool along `directions` (n, 3), each as near as can be to those before.

        NaN where the machine cannot turn so.
        """
        tool, words = self.tool, np.full((len(directions), 3), np.nan)
        near = np.concatenate([np.zeros(3), before])[tool.columns]
        for row, direction in enumerate(directions):
            ways = (tool.within_travel(way, near) for way in tool.attitudes(direction, near))
            within = [way for way in ways if way is not None]
            if within:
                near = min(within, key=lambda way: float(np.abs(way - near).sum()))
                at = np.concatenate([np.zeros(3), before])
                at[tool.columns] = near
                words[row] = at[3:]
        return words

    def _lack(self, direction: Array, before: Array) -> AxisLack | None:
        """The axis that is beyond its travel where the tool points along `direction` (3,), by the nearer branch.

        None where no angles of the axes point it there.
        """
        tool, joints = self.tool, self.tool.kinematics.joints
        near = np.concatenate([np.zeros(3), before])[tool.columns]
        missing = [tool.beyond_travel(way) for way in tool.attitudes(direction, near)]
        if not missing:
            return None
        joint, value, limit = min(missing, key=lambda each: abs(each[1] - each[2]))
        return AxisLack(joints.names[joint], value, limit)

    def after(self, leg: JointPath, path: ToolPath, home: Array) -> AxisAttitude:
        """The same posing: rotary axes are commanded, so no choice would have to be kept."""
        return self


@frozen(kw_only=False, eq=False)
class Segments:
    """k stretches of pieces in the order of motion, from `begin` over `length`; only where the tip is commanded."""

    piece: NDArray[np.int64]
    begin: Array
    length: Array

    @staticmethod
    def of(pieces: Pieces, held: NDArray[np.bool_], turning: WordsAlong | None) -> Segments:
        """As many as the geometry requires, and as words that are `turning` do."""
        own = np.flatnonzero(held[pieces.row_first] & ~pieces.fixed).astype(np.int64)
        length, curve = pieces.length[own], pieces.curve[own]
        first, last = (pieces.points(own, s)[0] for s in (np.zeros(len(own)), length))
        turn = np.abs(last[:, 3:] - first[:, 3:]).max(axis=1, initial=0.0)
        round_ = pieces.curves.kind[curve] == ROUND
        bend = np.abs(pieces.curves.sweep[curve]) / np.maximum(pieces.curves.length[curve], 1e-300) * length
        wanted = np.maximum(np.maximum(length / _SPACING, turn / _STEP), np.where(round_, bend / _BEND, 0.0))
        if turning is not None:
            wanted = np.maximum(wanted, turning.parts(own, _STEP))
        count = np.maximum(np.ceil(wanted), np.where(pieces.kind[own] == OVERLAP, 4, 1)).astype(np.int64)
        index = np.repeat(np.arange(len(own)), count)
        number = np.arange(len(index)) - np.repeat(np.cumsum(count) - count, count)
        each = length[index] / count[index]
        return Segments(own[index], each * number, each)

    @property
    def ends(self) -> tuple[Array, Array]:
        """Where segments begin and end on their pieces."""
        return self.begin, self.begin + self.length

    def at(self, pieces: Pieces, s: Array) -> tuple[Array, Array]:
        """Points (k, 6) and their slopes at `s` (k,)."""
        return pieces.points(self.piece, s)


def _joints_of_tips(tool: ToolPoint, points: Array, offset: Array) -> Array:
    at = points.copy()
    at[:, 3:] += offset[:, 3:]
    return tool.joints(at, offset[:, :3])


def _ranges(path: ToolPath, tool: ToolPoint, held: NDArray[np.bool_]) -> tuple[Array, Array]:
    """Least and greatest axis values of rows (n, 6); where the tip is commanded, those at the row's end."""
    low, high = axis_ranges(path)
    if not held.any():
        return low, high
    q = _joints_of_tips(tool, path.end[held], offsets(path)[held])
    for table in (low, high):
        rows = table[held]
        rows[:, tool.columns] = q
        table[held] = rows
    return low, high


def _caps(
    kinematics: Kinematics, tips: TipWay, segments: Segments, q: tuple[Array, Array], findings: PathFindings
) -> Caps:
    """Caps of the segments where the tip is commanded, and of all other pieces as blending found them."""
    pieces, held = tips.pieces, tips.held
    joints, piece, length = kinematics.joints, segments.piece, segments.length
    start, end = (_slopes(tips, segments, s) for s in segments.ends)
    mean = (q[1] - q[0]) / length[:, None]
    feed = pieces.path.feed
    wanted = np.maximum(feed[pieces.row_first], feed[pieces.row_last])
    # where axes are commanded, blending knows what they can do along the piece
    wanted = np.where((pieces.kind == OVERLAP) | ~held[pieces.row_first], pieces.speed, wanted)[piece]
    lap, soft = pieces.kind[piece] == OVERLAP, bool(np.isfinite(joints.jerk).any())
    found = JointCaps(
        wanted=wanted.copy(),
        speed=np.empty(len(piece)),
        acceleration=np.where(lap, np.inf if soft else 0.0, pieces.acceleration[piece]),
        joint=np.empty(len(piece), dtype=np.int64),
        unresolved=np.empty(len(piece)),
    )
    rates, acceleration = SegmentRates(start, end, mean), _SHARE * np.minimum(joints.acceleration, 1e6)
    allowed = found.acceleration.copy()
    joint_caps(rates, length, NORMAL_SHARE, _SHARE * np.minimum(joints.speed, 1e6), acceleration, found)
    if soft:  # S-curves of straight moves are known in closed form
        even = greatest(np.maximum(np.abs(start - mean), np.abs(end - mean))) <= _EVEN * greatest(np.abs(mean))
        found.wanted[even] /= _SHARE
        found.speed[even] = np.minimum(wanted, found.wanted)[even]
        found.acceleration[even] = np.minimum(allowed, found.acceleration / _SHARE)[even]
    last = np.append(piece[1:] != piece[:-1], True)[: len(piece)]
    follows = np.diff(piece) == 1  # within a piece there are none
    junction = np.minimum(np.where(last, pieces.junction[piece], np.inf), found.speed)
    kinks = Kinks.between(rates, junction, pieces.ratio[piece], follows, acceleration)
    tip = held[pieces.row_first[piece]]
    places = (piece[tip], segments.begin[tip])
    report_slow_joints(kinematics, pieces, places, wanted[tip], found.wanted[tip], found.joint[tip], findings)
    others = np.setdiff1d(np.arange(len(pieces)), piece)
    junction = np.minimum(junction, kinks.cap)
    order = np.argsort(np.concatenate([piece, others]), kind="stable")
    eased = None
    if soft:
        after = np.append(np.diff(piece), 2)[: len(piece)]  # pieces to the next segment
        lower = softer(rates, length, after <= 1, after == 0, joints.jerk, found, junction)
        found, junction, eased = lower.found, lower.junction, lower.soft.with_fixed(len(others), order)
    columns = (
        (piece, others),
        (segments.begin, np.zeros(len(others))),
        (length, pieces.length[others]),
        (found.speed, pieces.speed[others]),
        (found.acceleration * kinks.left, pieces.acceleration[others]),
        (junction, pieces.junction[others]),
    )
    segment, start, way, speed, acceleration, end = (np.concatenate(pair)[order] for pair in columns)
    return Caps(segment, start, way, speed, acceleration, end, eased)


def _slopes(way: TipWay, segments: Segments, s: Array) -> Array:
    """dq/ds (k, j) at `s` (k,), by the difference of two neighbours on the tangent."""
    points, slope = segments.at(way.pieces, s)
    step = _PROBE / np.maximum(greatest(np.abs(slope)), 1e-12)
    ahead, behind = (way.joints(segments.piece, s + d, points + d[:, None] * slope) for d in (step, -step))
    slopes: Array = (ahead - behind) / (2.0 * step)[:, None]
    return slopes
