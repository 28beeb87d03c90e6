"""Waits in a trajectory: the machine stands at events for as long as others need."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from gcodesim.frames import Array
from gcodesim.motion.trajectory import Phases, Trajectory


def with_waits(trajectory: Trajectory, seconds: Mapping[int, float]) -> Trajectory:
    """`trajectory` with a rest of so many seconds at events, which are given by their index.

    At each of them the machine is at rest already and stands for no time. What follows is later by the waits before it,
    and otherwise as it was.
    """
    lasting = [(index, wait) for index, wait in sorted(seconds.items()) if wait > 0.0]
    if not lasting:
        return trajectory
    wait = np.zeros(len(trajectory.events))
    wait[[index for index, _ in lasting]] = [value for _, value in lasting]
    until = np.cumsum(wait)  # the waits up to each event and its own
    rows = np.array([event.row for event in trajectory.events])
    late = np.concatenate([[0.0], until])[np.searchsorted(rows, np.arange(len(trajectory.path)), side="right")]
    events = tuple(
        replace(event, time=event.time + float(after - own), duration=event.duration + float(own))
        for event, after, own in zip(trajectory.events, until, wait, strict=True)
    )
    return Trajectory(
        trajectory.pieces,
        _phases(trajectory, [index for index, _ in lasting], wait, until),
        events,
        trajectory.row_start + late,
        trajectory.row_end + late,
    )


def _phases(trajectory: Trajectory, lasting: list[int], wait: Array, until: Array) -> Phases:
    """The phases with those of the waits between them."""
    phases, pieces = trajectory.phases, trajectory.pieces
    first = [int(np.searchsorted(pieces.row_first, trajectory.events[index].row)) for index in lasting]
    behind = np.array(
        [
            _first(np.where(phases.event >= 0, phases.event > index, phases.piece >= piece))
            for index, piece in zip(lasting, first, strict=True)
        ],
        dtype=np.intp,
    )
    held = np.maximum(np.array(first) - 1, 0)
    still = Phases(
        time=np.array([trajectory.events[index].time + until[index] - wait[index] for index in lasting]),
        duration=wait[lasting],
        piece=held.astype(np.int64),
        s=np.where(np.array(first) > 0, pieces.length[held], 0.0) if len(pieces) else np.zeros(len(lasting)),
        speed=np.zeros(len(lasting)),
        acceleration=np.zeros(len(lasting)),
        jerk=np.zeros(len(lasting)),
        event=np.array(lasting, dtype=np.int64),
    )
    late = np.zeros(len(phases.time) + 1)
    np.add.at(late, behind, wait[lasting])
    moved = replace(phases, time=phases.time + np.cumsum(late)[:-1])
    return moved.insert(behind, still)


def _first(true: Array) -> int:
    """The index of the first that is true; the length where none is."""
    return int(np.argmax(true)) if true.any() else len(true)
