"""The time law of printers: trapezoids under the firmware's limits, corners by jerk or deviation, a buffer of moves.

Grbl's is of the same kind: it follows the path as it is, and only slows down in corners.
"""

from __future__ import annotations

from dataclasses import replace
from math import sqrt
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.canon import Extrude
from gcodesim.frames import Array
from gcodesim.motion.pieces import Pieces
from gcodesim.motion.printer_kernels import JunctionLimits, Moves, junctions, within_buffer
from gcodesim.motion.tool_path import ARC, EXACT_PATH, ToolPath

_FAR: Final = 200  # moves from which on a planner counts as looking to the end


def is_printed(path: ToolPath, soft: bool = False) -> bool:
    """Whether the limits of the planner of a printer, or of grbl, hold for the path.

    `soft`: axes have a jerk, of which grbl's planner knows nothing; the control is another one then.
    """
    return any(state.limits is not None and not (soft and state.limits.plain) for state in path.states)


def without_blending(path: ToolPath) -> ToolPath:
    """The path as a printer follows it: exactly, without corner arcs or merged chords."""
    return replace(path, mode=np.full(len(path), EXACT_PATH, dtype=np.uint8))


def as_printed(pieces: Pieces) -> Pieces:
    """`pieces` of a path without blending, with the speeds, accelerations and corners of a printer's planner.

    What the machine itself cannot do stays in force. A move extrudes at the printing acceleration, filament drawn back
    on the way included; others have that of travel. Rapids go from rest to rest, but those of a plain planner, which
    gives lines all that their axes can.
    """
    path = pieces.path
    if not len(pieces):
        return pieces
    rows = pieces.row_first.astype(np.int64)
    limits = _Limits(path, rows)
    begin, end = _directions(pieces, path.extrude[rows])
    share = np.maximum(np.abs(begin), np.abs(end))
    arcs = path.kind[rows] == ARC
    share[arcs, :2] = 1.0  # its direction takes every value in between, or nearly so
    planned = (np.isfinite(path.feed[rows]) | (limits.plain > 0.0)) & limits.known
    with np.errstate(divide="ignore"):
        most = np.where(share > 1e-9, 1.0 / np.maximum(share, 1e-9), np.inf)
        speed = np.minimum(pieces.speed, np.min(limits.speed * most, axis=1))
        own = np.where(path.extrude[rows] != 0.0, limits.printing, limits.travel)
        axes = np.ascontiguousarray(pieces.limits.arrays[1, :3])
        whole = np.where((limits.plain > 0.0) & ~arcs, np.min(axes * most[:, :3], axis=1), pieces.acceleration)
        acceleration = np.minimum(np.minimum(whole, own), np.min(limits.acceleration * most, axis=1))
    speed = np.where(planned, speed, pieces.speed)
    acceleration = np.where(planned, acceleration, pieces.acceleration)
    rest = _rests(pieces)
    rest[:-1] |= ~planned[1:] | ~planned[:-1]
    moves = Moves(begin, end, pieces.length, speed, acceleration)
    corners = JunctionLimits(limits.jerk, limits.deviation, limits.corner, limits.plain, axes)
    junction = junctions(rest, moves, corners)
    if (limits.buffer < _FAR).any():
        junction = within_buffer(pieces.length, acceleration, junction, limits.buffer)
    return replace(pieces, speed=speed, acceleration=acceleration, junction=junction, ratio=np.ones(len(pieces)))


class _Limits:
    """The limits in force at each of m rows, as columns."""

    def __init__(self, path: ToolPath, rows: NDArray[np.int64]) -> None:
        state = path.state[rows]
        known = [each.limits for each in path.states]
        some = next(limits for limits in known if limits is not None)

        def column(name: str) -> Array:
            table = np.array([getattr(limits or some, name) for limits in known])
            return np.ascontiguousarray(table[state])

        self.known: NDArray[np.bool_] = np.array([limits is not None for limits in known])[state]
        self.speed, self.acceleration, self.jerk = column("speed"), column("acceleration"), column("jerk")
        self.printing, self.travel = column("printing"), column("travel")
        self.deviation, self.corner = column("deviation"), column("corner")
        self.plain = column("plain").astype(float)
        self.buffer = np.maximum(column("buffer").astype(np.int64), 2)


def _directions(pieces: Pieces, extrude: Array) -> tuple[Array, Array]:
    """Directions (m, 4) in which pieces begin and end, with the filament for each metre of way."""
    first, last = pieces.curves.end_tangents()[:2]
    filament = extrude / np.maximum(pieces.length, 1e-12)
    table = [np.ascontiguousarray(np.column_stack([tangent[pieces.curve, :3], filament])) for tangent in (first, last)]
    return table[0], table[1]


def _rests(pieces: Pieces) -> NDArray[np.bool_]:
    """Which pieces end at rest."""
    count = np.concatenate([[0], np.cumsum(pieces.path.stop)])
    following = np.append(pieces.row_first[1:], len(pieces.path)).astype(np.int64)
    rest: NDArray[np.bool_] = count[following] - count[pieces.row_last.astype(np.int64)] > 0
    rest[-1] = True
    return rest


def filament_time(event: Extrude) -> float:
    """How long filament alone takes [s]: a trapezoid that begins and ends with the jerk of the extruder."""
    limits, length = event.limits, abs(event.length)
    speed = min(event.feed, limits.speed[3])
    acceleration = min(limits.retracting, limits.acceleration[3])
    if length == 0.0:
        return 0.0
    begin = min(0.5 * limits.jerk[3], speed)
    peak = sqrt(begin * begin + acceleration * length)
    if peak <= speed:
        return 2.0 * (peak - begin) / acceleration
    return 2.0 * (speed - begin) / acceleration + (length - (speed * speed - begin * begin) / acceleration) / speed
