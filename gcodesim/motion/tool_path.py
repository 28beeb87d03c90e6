"""`ToolPath`: the moves of a program as columns, with the state of the tool in which each one happens."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import field, fields, replace
from enum import StrEnum
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.elementary import asin, atan2, cos_sin, hypot
from gcodesim.arithmetic.matrices import dots, multiplied, norms
from gcodesim.canon import Axes, Event, Point
from gcodesim.canon.printing import MotionLimits, Section
from gcodesim.diagnostics import Span
from gcodesim.diagnostics.span_table import SpanTable, join
from gcodesim.frames import Array, Pose, quaternion_from_rotation, rotation_from_quaternion
from gcodesim.frozen import frozen
from gcodesim.given import number, numbers, quaternions

# kinds of rows
RAPID: Final = 0
LINE: Final = 1
ARC: Final = 2
HOME: Final = 3  # to the machine's own home (G28, G30 without a stored position); joint space on an arm

# path modes
EXACT_STOP: Final = 0
EXACT_PATH: Final = 1
BLEND: Final = 2

ZERO: Final[Axes] = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
_NOWHERE: Final = Span("")


class Commanded(StrEnum):
    """What a program commands.

    AXES: the control point, each letter by itself, as in every program until it says otherwise. POINT: the tip in
    the work and the attitude of the tool, by rotary words or a vector (tool-centre-point control). JOINTS: the joints.
    """

    AXES = "axes"
    POINT = "point"
    JOINTS = "joints"


@frozen
class ToolState:
    """What holds while a row is run.

    `offset` is the active length offset (axes stand at end + offset), `spindle`
    [rad/s] is positive for M3 and 0 when stopped, `surface_speed` [m/s] is set
    under G96 (then `spindle` is its cap). `system` (`canon.systems`: 1 is G54) with
    its offset, G92 and rotation [rad], and `axes`, the rows of a rotation where it leans (`canon.WorkSystem`). `word`
    is the motion word, as G1; `control` what the words command.
    In programs of printers `limits` are those of the firmware's planner, and `section` is what is being printed.
    `push` (6,) is a force [N] and torque [N·m] that a script exerts at the tip, in axes of the world or the tool.
    """

    tool: int = 0
    offset: Axes = ZERO
    spindle: float = 0.0
    surface_speed: float = 0.0
    flood: bool = False
    mist: bool = False
    system: int = 1
    system_offset: Axes = ZERO
    g92: Axes = ZERO
    rotation: float = 0.0
    axes: tuple[Point, Point, Point] | None = None
    word: str = ""
    control: Commanded = Commanded.AXES
    limits: MotionLimits | None = None
    section: Section | None = None
    push: tuple[float, ...] = ()
    push_in_tool: bool = False

    @property
    def X_MP(self) -> Pose:
        """The work system in force in M, without its G92."""
        cosine, sine = cos_sin(self.rotation)
        R = np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
        p = np.array(self.system_offset[:3], dtype=float)
        return Pose(p, R if self.axes is None else multiplied(np.array(self.axes), R))


@frozen(kw_only=False)
class PathEvent:
    """`event` happens before row `row` begins (row n: after the last one).

    `turns` are the speeds of the spindle before and after it [rad/s], signed, where it changes them.
    """

    row: int
    event: Event
    turns: tuple[float, float] | None = None


@frozen(slots=False, kw_only=False, eq=False)
class ToolPath:
    """n moves of the controlled point in the machine frame M, tool length offset not included.

    Columns: `kind` (n,) RAPID, LINE, ARC, HOME; `start`, `end` (n, 6) [m, rad];
    `center`, `normal` (n, 3) and `sweep` (n,) [rad], signed about the normal, of
    arcs; `feed` (n,) [m/s; rad/s where `rotary_feed`; inf for rapids]; `mode`
    EXACT_STOP, EXACT_PATH, BLEND with `tolerance` and merge tolerance `naive`
    [m]; `state`, `source` index `states` and `spans`; `block` counts program
    blocks; `active` says whether a process tool is switched on; where `stop` is set
    the row ends at rest. `extrude` (n,) [m] is the filament that goes along.
    """

    kind: NDArray[np.uint8]
    start: Array
    end: Array
    center: Array
    normal: Array
    sweep: Array
    feed: Array
    rotary_feed: NDArray[np.bool_]
    mode: NDArray[np.uint8]
    tolerance: Array
    naive: Array
    state: NDArray[np.int32]
    source: NDArray[np.int32]
    block: NDArray[np.int32]
    active: NDArray[np.bool_]
    stop: NDArray[np.bool_]
    states: tuple[ToolState, ...] = (ToolState(),)
    spans: Sequence[Span] = (_NOWHERE,)
    events: tuple[PathEvent, ...] = ()
    extrude: Array = field(default_factory=lambda: np.zeros(0))

    def __post_init__(self) -> None:
        if len(self.extrude) != len(self.kind):
            object.__setattr__(self, "extrude", np.zeros(len(self.kind)))

    @staticmethod
    def from_points(
        positions: Array, orientations: Array | None = None, active: Iterable[bool] | bool = False, feed: float = np.inf
    ) -> ToolPath:
        """Lines through `positions` (n + 1, 3) [m].

        `orientations` (n + 1, 4), x y z w, are kept as rotations about A, B, C:
        extrinsic X, Y, Z angles [rad]. `feed` [m/s]; inf makes rapids. ValueError for what is no path.
        """
        positions = _given_points(positions)
        points = np.zeros((len(positions), 6))
        points[:, :3] = positions
        if orientations is not None:
            shape = (4,) if np.ndim(orientations) == 1 else (len(points), 4)
            points[:, 3:] = angles_of_quaternions(quaternions(orientations, shape, "an orientation of a path"))
        if feed != np.inf:
            feed = number(feed, "the feed of a path", above=0.0)
        n = max(len(points) - 1, 0)
        flags = np.asarray(active, dtype=bool)
        if flags.shape not in ((), (n,)):
            raise ValueError(f"a path of {n} moves is switched by one flag or {n} of them; {flags.size} are given")
        on = np.broadcast_to(flags, (n,)).copy()
        return ToolPath(
            kind=np.full(n, LINE if np.isfinite(feed) else RAPID, dtype=np.uint8),
            start=points[:-1].copy(),
            end=points[1:].copy(),
            center=np.zeros((n, 3)),
            normal=np.zeros((n, 3)),
            sweep=np.zeros(n),
            feed=np.full(n, feed),
            rotary_feed=np.zeros(n, dtype=bool),
            mode=np.full(n, BLEND, dtype=np.uint8),
            tolerance=np.zeros(n),
            naive=np.zeros(n),
            state=np.zeros(n, dtype=np.int32),
            source=np.zeros(n, dtype=np.int32),
            block=np.arange(n, dtype=np.int32),
            active=on,
            stop=np.zeros(n, dtype=bool),
        )

    def __len__(self) -> int:
        return len(self.kind)

    def __iter__(self) -> Iterator[tuple[Array, Array, bool]]:
        """The start of the path, then the end of every row: position (3,), orientation (4,) x y z w, active."""
        if not len(self):
            return
        points = np.concatenate([self.start[:1], self.end])
        quaternions = quaternions_of_angles(points[:, 3:])
        yield points[0, :3], quaternions[0], False
        for point, quaternion, on in zip(points[1:], quaternions[1:], self.active, strict=True):
            yield point[:3], quaternion, bool(on)

    @property
    def positions(self) -> Array:
        """Start of the path and end of every row (n + 1, 3) [m]."""
        return np.concatenate([self.start[:1, :3], self.end[:, :3]])

    @property
    def orientations(self) -> Array:
        """Orientations x y z w (n + 1, 4) at these positions."""
        return quaternions_of_angles(np.concatenate([self.start[:1, 3:], self.end[:, 3:]]))

    @property
    def length(self) -> Array:
        """Programmed length of each row (n,) in XYZ [m]."""
        straight = self.end[:, :3] - self.start[:, :3]
        length: Array = norms(straight)
        arc = self.kind == ARC
        if arc.any():
            n = self.normal[arc]
            lift = dots(straight[arc], n)
            radius0 = norms(_across(self.start[arc, :3] - self.center[arc], n))
            radius1 = norms(_across(self.end[arc, :3] - self.center[arc], n))
            length[arc] = hypot(0.5 * (radius0 + radius1) * np.abs(self.sweep[arc]), lift)
        return length

    def span(self, row: int) -> Span:
        """The place of row `row` in the program."""
        return self.spans[int(self.source[row])]

    def state_of(self, row: int) -> ToolState:
        """The tool state of row `row`."""
        return self.states[int(self.state[row])]

    def __add__(self, other: ToolPath) -> ToolPath:
        """`self`, then `other`, each in its own coordinates; where they do not meet the first one ends at rest."""
        if not isinstance(other, ToolPath):
            return NotImplemented
        if not len(self) and not self.events:
            return other
        moved = replace(other, stop=other.stop.copy(), block=other.block.copy())
        if len(self) and len(other):
            moved.block[:] += self.block[-1] + 1 - min(other.block[0], 0)
        joined = self.then(moved)
        if len(self) and len(other) and not np.array_equal(self.end[-1], other.start[0]):
            joined.stop[len(self) - 1] = True
        return joined

    def then(self, leg: ToolPath) -> ToolPath:
        """`self`, then `leg` of the same program, whose block numbers continue and which begins from rest."""
        states = dict.fromkeys(self.states)
        states |= dict.fromkeys(leg.states)
        numbers = {state: number for number, state in enumerate(states)}
        columns: dict[str, Any] = {}
        for column in _columns():
            columns[column] = np.concatenate([getattr(self, column), getattr(leg, column)])
        for path, rows in ((self, slice(0, len(self))), (leg, slice(len(self), None))):
            own = np.array([numbers[state] for state in path.states], dtype=columns["state"].dtype)
            columns["state"][rows] = own[path.state]
        columns["source"][len(self) :] += len(self.spans)
        moved = tuple(replace(e, row=e.row + len(self)) for e in leg.events)
        return ToolPath(
            **columns,
            states=tuple(states),
            spans=join([SpanTable.of(self.spans), SpanTable.of(leg.spans)]),
            events=self.events + moved,
        )

    def translate(self, vector: Iterable[float]) -> ToolPath:
        """A copy shifted by `vector` (3,) [m]; ValueError for what is none."""
        return self.transform(Pose(numbers(_listed(vector), (3,), "a translation"), np.eye(3)))

    def rotate(self, quaternion: Iterable[float]) -> ToolPath:
        """A copy turned about the origin by a quaternion x y z w; ValueError for what is none."""
        turn = quaternions(_listed(quaternion), (4,), "a rotation")
        return self.transform(Pose(np.zeros(3), rotation_from_quaternion(turn)))

    def transform(self, X: Pose) -> ToolPath:
        """A copy whose points are moved by `X`; angles of A, B, C turn along when any is used."""
        if not isinstance(X, Pose):
            raise TypeError(f"a path is moved by a `gcodesim.frames.Pose`; {type(X).__name__} is given")
        start, end = self.start.copy(), self.end.copy()
        for points in (start, end):
            points[:, :3] = X.apply(points[:, :3])
            if np.any(points[:, 3:]) or (np.any(self.end[:, 3:]) and not np.allclose(X.R, np.eye(3))):
                R = multiplied(X.R, rotation_from_quaternion(quaternions_of_angles(points[:, 3:])))
                points[:, 3:] = angles_of_quaternions(quaternion_from_rotation(R))
        return replace(self, start=start, end=end, center=X.apply(self.center), normal=X.rotate(self.normal))

    def at_feed(self, feed: float) -> ToolPath:
        """A copy all of whose moves have `feed` [m/s]; rapids become lines. ValueError for what is no feed."""
        feed = number(feed, "the feed of a path", above=0.0)
        kind = np.where(self.kind == RAPID, LINE, self.kind).astype(np.uint8)
        return replace(self, kind=kind, feed=np.full(len(self), feed), rotary_feed=np.zeros(len(self), dtype=bool))

    def append(self, other: ToolPath) -> ToolPath:
        """A path that goes on with `other`; the same as ``self + other``."""
        return self + other

    def prepend(self, other: ToolPath) -> ToolPath:
        """A path that begins with `other`; the same as ``other + self``."""
        return other + self

    def to_gcode(self, dialect: str = "linuxcnc", switch: tuple[str, str] | None = None) -> str:
        """The text of a program with these moves; see `gcodesim.motion.gcode_text.gcode_of`."""
        from gcodesim.motion.gcode_text import gcode_of

        return gcode_of(self, dialect, switch)

    def polyline(self, chord: float = 1e-5) -> Array:
        """Points (m, 3) [m] along the programmed path; arcs as chords not more than `chord` [m] off."""
        from gcodesim.motion.curves import Curves

        return Curves.of(self).polyline(chord)

    def draw(self, axes: Any = None, chord: float = 1e-5, **style: Any) -> Array:
        """The polyline (m, 3) [m], drawn too when `axes` is given: anything with `plot(x, y, z)`."""
        points = self.polyline(chord)
        if axes is not None:
            axes.plot(points[:, 0], points[:, 1], points[:, 2], **style)
        return points


def _given_points(positions: Any) -> Array:
    """Points (n, 3) that a caller gives, or one (3,); ValueError for others."""
    try:
        found = np.atleast_2d(np.asarray(positions, dtype=float))
    except (TypeError, ValueError):
        found = positions
    if isinstance(found, np.ndarray) and not found.size:
        return np.zeros((0, 3))
    return numbers(found, (None, 3), "a path")


def _listed(values: Any) -> Any:
    """What may be given as an iterator, as a list."""
    return list(values) if isinstance(values, Iterator) else values


def _columns() -> list[str]:
    return [f.name for f in fields(ToolPath) if f.name not in ("states", "spans", "events")]


def _across(vectors: Array, n: Array) -> Array:
    across: Array = vectors - dots(vectors, n)[:, None] * n
    return across


def quaternions_of_angles(angles: Array) -> Array:
    """Quaternions (n, 4), x y z w, of rotations by angles (n, 3) [rad] about the fixed X, then Y, then Z axis."""
    half = 0.5 * np.asarray(angles, dtype=float)
    cosine, sine = cos_sin(half)
    cx, cy, cz = cosine.T
    sx, sy, sz = sine.T
    from gcodesim.frames import canonical_quaternion

    return canonical_quaternion(
        np.stack(
            [
                sx * cy * cz - cx * sy * sz,
                cx * sy * cz + sx * cy * sz,
                cx * cy * sz - sx * sy * cz,
                cx * cy * cz + sx * sy * sz,
            ],
            axis=-1,
        )
    )


def angles_of_quaternions(quaternions: Array) -> Array:
    """Inverse of `quaternions_of_angles`, pitch within a quarter turn; (n, 3) [rad]."""
    R = rotation_from_quaternion(quaternions)
    pitch = asin(np.clip(-R[..., 2, 0], -1.0, 1.0))
    upright = np.abs(R[..., 2, 0]) < 1.0 - 1e-12
    roll = np.where(upright, atan2(R[..., 2, 1], R[..., 2, 2]), 0.0)
    yaw = np.where(upright, atan2(R[..., 1, 0], R[..., 0, 0]), atan2(-R[..., 0, 1], R[..., 1, 1]))
    return np.stack([roll, pitch, yaw], axis=-1)
