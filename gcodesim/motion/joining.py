"""Trajectories of the legs of one program, one after the other."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

import numpy as np

from gcodesim.canon import Event
from gcodesim.motion.curves import Curves
from gcodesim.motion.pieces import Pieces
from gcodesim.motion.tool_path import PathEvent, ToolPath
from gcodesim.motion.trajectory import Phases, TimedEvent, Trajectory


def standing_until(trajectory: Trajectory, end: float, event: Event) -> Trajectory:
    """`trajectory`, then the machine stands for `event` until `end` [s], which is not before the trajectory's own."""
    begin = trajectory.duration
    still = _last_place(trajectory.pieces)
    still |= {"time": begin, "duration": end - begin, "speed": 0.0, "acceleration": 0.0, "jerk": 0.0}
    still["event"] = len(trajectory.events)
    phases = Phases(*(np.append(getattr(trajectory.phases, name), still[name]) for name in Phases.names()))
    return _with_event(replace(trajectory, phases=phases), begin, end - begin, event)


def with_instant(trajectory: Trajectory, time: float, event: Event) -> Trajectory:
    """`trajectory` with an event at `time` [s] for which the machine does not stop, listed after all others."""
    return _with_event(trajectory, time, 0.0, event)


def _with_event(trajectory: Trajectory, time: float, duration: float, event: Event) -> Trajectory:
    path = trajectory.path
    row = len(path)
    path = replace(path, events=(*path.events, PathEvent(row, event)))
    timed = TimedEvent(time=time, duration=duration, row=row, event=event)
    return replace(trajectory, pieces=replace(trajectory.pieces, path=path), events=(*trajectory.events, timed))


def joined(before: Trajectory, after: Trajectory, path: ToolPath) -> Trajectory:
    """`before`, then `after`, which begins where and when the other ends; `path` is that of both."""
    begin, rows = before.duration, len(before.path)
    pieces = _joined_pieces(before.pieces, after.pieces, path)
    shifted = {name: getattr(after.phases, name) for name in Phases.names()}
    shifted["time"] = shifted["time"] + begin
    shifted["event"] = np.where(shifted["event"] < 0, -1, shifted["event"] + len(before.events))
    shifted["piece"] = shifted["piece"] + len(before.pieces)
    if not len(after.pieces):  # it only waits, where the machine stands already
        place = _last_place(before.pieces)
        shifted |= {name: np.full(len(shifted["time"]), value) for name, value in place.items()}
    phases = Phases(*(np.concatenate([getattr(before.phases, name), shifted[name]]) for name in Phases.names()))
    events = [replace(timed, time=timed.time + begin, row=timed.row + rows) for timed in after.events]
    return Trajectory(
        pieces,
        phases,
        (*before.events, *events),
        np.concatenate([before.row_start, after.row_start + begin]),
        np.concatenate([before.row_end, after.row_end + begin]),
    )


def _last_place(pieces: Pieces) -> dict[str, Any]:
    """The end of the last piece; without pieces, the beginning."""
    if not len(pieces):
        return {"piece": 0, "s": 0.0}
    return {"piece": len(pieces) - 1, "s": float(pieces.length[-1])}


def _joined_pieces(before: Pieces, after: Pieces, path: ToolPath) -> Pieces:
    """Numbers of curves and rows of `after` continue; both have the limits of one machine."""
    shift = {"curve": len(before.curves), "row_first": len(before.path), "row_last": len(before.path)}
    columns: dict[str, Any] = {}
    for field in fields(Pieces):
        if field.name in ("path", "limits", "curves"):
            continue
        own: Any = getattr(after, field.name)
        if field.name in shift:
            own = (own + shift[field.name]).astype(own.dtype)
        elif field.name == "second":  # -1 where there is none
            own = np.where(own < 0, own, own + len(before.curves)).astype(own.dtype)
        columns[field.name] = np.concatenate([getattr(before, field.name), own])
    both = (before.curves, after.curves)
    curves = Curves(**{f.name: np.concatenate([getattr(each, f.name) for each in both]) for f in fields(Curves)})
    return Pieces(path=path, limits=before.limits, curves=curves, **columns)
