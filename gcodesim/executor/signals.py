"""Signals row by row: what the words of a program come to for the processes that read them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import pi
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.canon import Action, Output
from gcodesim.cell.signal_values import SIGNAL, value_of_action
from gcodesim.cell.signals import SignalSource, SignalWord
from gcodesim.motion.tool_path import PathEvent, ToolPath
from gcodesim.processes.loading import LOAD_IN_TOOL, PUSHES
from gcodesim.processes.signal import (
    ACTIVE,
    BEAD_HEIGHT,
    BEAD_WIDTH,
    FEED,
    LASER_MODE,
    PITCH,
    SPINDLE,
    SURFACE_SPEED,
    Signal,
)
from gcodesim.units import RPM

Array = NDArray[np.float64]

THREADS: Final = frozenset(("G33", "G76", "G32", "G34", "G92"))
"""Motion words of moves that keep step with the spindle, where they are feeds."""


def signals_of_rows(
    path: ToolPath,
    sources: Mapping[str, SignalSource] | None = None,
    read: Mapping[str, Signal] | None = None,
    laser_mode: float | None = None,
) -> dict[str, NDArray[Any]]:
    """The signals (n,) of the n rows of `path`, in SI; a path without rows has one at rest.

    `sources` are those of the cell, `read` the signals that processes of the cell read, `laser_mode` the S that means
    full power in a control that drives a laser itself. Whatever is switched on the way
    holds from the row on before which it stands. M62, M63 and M67 take effect with the next move, M64, M65 and M68 at
    once: both at the same border of rows, since the machine stands still for the second kind. S gives its number while
    the spindle turns, either way, and 0 while it stands. An output that was never set is 0, as is a code.
    """
    state = path.state if len(path) else np.zeros(1, dtype=np.int64)
    spindle = np.array([each.spindle for each in path.states], dtype=float)[state]
    active = path.active.astype(bool) if len(path) else np.zeros(1, dtype=bool)
    found: dict[str, NDArray[Any]] = {SPINDLE.name: spindle, ACTIVE.name: active}
    found |= _of_lathes(path, state, spindle, read or {})
    if FEED.name in (read or {}):
        found[FEED.name] = path.feed if len(path) else np.zeros(1)
    if laser_mode is not None:
        found[LASER_MODE.name] = np.full(len(spindle), laser_mode * RPM)
    if LOAD_IN_TOOL.name in (read or {}):
        found |= _pushes(path, state)
    if path.extrude.any():
        sections = [each.section for each in path.states]
        for signal, size in ((BEAD_WIDTH, "width"), (BEAD_HEIGHT, "height")):
            found[signal.name] = np.array([0.0 if s is None else getattr(s, size) for s in sections])[state]
    heard = [event for event in path.events if isinstance(event.event, (Output, Action))]
    actions = [(each.row, each.event) for each in heard if isinstance(each.event, Action)]
    by_name = {action.verb for _, action in actions if action.target == SIGNAL}
    for name, signal in (read or {}).items():
        if name != ACTIVE.name and (signal.set_by or name in by_name):
            changes = ((row, value_of_action(action, signal)) for row, action in actions)
            found[name] = _held(changes, len(spindle), signal.default)
    for name, source in (sources or {}).items():
        found[name] = source.factor * _numbers(source.word, heard, spindle) + source.zero
    return found


def _pushes(path: ToolPath, state: NDArray[Any]) -> dict[str, NDArray[Any]]:
    """What a script exerts at the tip (n,), for the process of loads."""
    pushed = np.array([each.push or (0.0,) * 6 for each in path.states], dtype=float)[state]
    frame = np.array([float(each.push_in_tool) if each.push else np.nan for each in path.states])[state]
    return {LOAD_IN_TOOL.name: frame} | {signal.name: pushed[:, k] for k, signal in enumerate(PUSHES)}


def _of_lathes(
    path: ToolPath, state: NDArray[Any], spindle: Array, read: Mapping[str, Signal]
) -> dict[str, NDArray[Any]]:
    """Cutting speed and pitch (n,) for processes that read them."""
    found: dict[str, NDArray[Any]] = {}
    if SURFACE_SPEED.name in read:
        found[SURFACE_SPEED.name] = np.array([each.surface_speed for each in path.states], dtype=float)[state]
    if PITCH.name in read:
        threads = np.array([each.word in THREADS for each in path.states], dtype=bool)[state]
        turns = np.abs(spindle) / (2.0 * pi)
        feed = path.feed if len(path) else np.zeros(1)
        line = threads & np.isfinite(feed) & (turns > 0.0)
        found[PITCH.name] = np.where(line, np.where(line, feed, 0.0) / np.where(turns > 0.0, turns, 1.0), 0.0)
    return found


def _numbers(word: SignalWord, heard: list[PathEvent], spindle: Array) -> Array:
    """The numbers (n,) that a word gives, as the program writes them."""
    if word.type == "speed":
        speed: Array = np.abs(spindle) / RPM
        return speed
    if word.type == "turning":
        turning: Array = (spindle != 0.0).astype(float)
        return turning
    return _held(((each.row, word.number_of(each.event)) for each in heard), len(spindle), 0.0)


def _held(changes: Iterable[tuple[int, float | None]], rows: int, start: float) -> Array:
    """Values (rows,): `start`, and from each row of `changes` on its value, the last of a row; None changes nothing."""
    kept = [(row, value) for row, value in changes if value is not None]
    at = np.array([row for row, _ in kept], dtype=np.int64)
    values = np.array([start, *(value for _, value in kept)])
    held: Array = values[np.searchsorted(at, np.arange(rows), side="right")]
    return held
