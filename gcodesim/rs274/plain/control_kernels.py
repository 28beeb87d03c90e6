"""Moves of `rs274/control.py` on arrays: where the machine goes from the target point, and the rows for that."""

from __future__ import annotations

from gcodesim.compiled import kernel
from gcodesim.rs274.plain.arc_kernels import plane_axes
from gcodesim.rs274.plain.columns import Column
from gcodesim.rs274.plain.layout_kernels import (
    ACTS,
    ARCS,
    COS,
    CURRENT,
    DEG,
    FEED,
    FEED_MODE,
    FEED_UNIT,
    G92,
    KIND,
    LINE,
    MIDDLE,
    MINUTE,
    ORIGIN,
    PLACE,
    PLANE,
    ROTARY,
    ROTATED,
    ROWS,
    SIN,
    TARGET,
    UNIT,
    WORD,
)


@kernel
def to_machine(numbers: Column, modes: Column, point: int) -> None:
    """`Control.tip` of the first six axes, in place; `point` says where in `numbers`."""
    for axis in range(6):
        numbers[point + axis] = numbers[point + axis] + numbers[G92 + axis]
    if modes[ROTATED]:
        x, y = numbers[point], numbers[point + 1]
        numbers[point] = x * numbers[COS] - y * numbers[SIN]
        numbers[point + 1] = x * numbers[SIN] + y * numbers[COS]
    for axis in range(6):
        numbers[point + axis] = numbers[point + axis] + numbers[ORIGIN + axis]


@kernel
def speed(numbers: Column, modes: Column, linear: bool) -> float:
    """The feed in force, as `Control.feed` says it."""
    size: float = numbers[FEED] * (numbers[FEED_UNIT] if linear else numbers[DEG])
    return size if modes[FEED_MODE] == 950 else size / numbers[MINUTE]


@kernel
def append(numbers: Column, modes: Column, moves: Column, facts: Column, kind: int, word: int, linear: bool) -> None:
    """A move of `kind` (as in `canon.MoveBatch`) to the target, which becomes the current point."""
    for axis in range(6):
        numbers[CURRENT + axis] = numbers[TARGET + axis]
    put(numbers, modes, moves, facts, kind, word, speed(numbers, modes, linear), not linear, PLACE)


@kernel
def put(
    numbers: Column,
    modes: Column,
    moves: Column,
    facts: Column,
    kind: int,
    word: int,
    feed: float,
    rotary: bool,
    place: int,
) -> None:
    """The row of a move to the target; `place` says where in `modes` the place of its line is."""
    row = modes[ROWS]
    to_machine(numbers, modes, TARGET)
    for axis in range(3):
        moves[row, axis] = numbers[TARGET + axis] * numbers[UNIT]
        moves[row, axis + 3] = numbers[TARGET + axis + 3] * numbers[DEG]
    for each in range(5):
        facts[row, LINE + each] = modes[place + each]
    moves[row, 6] = feed if kind > 0 else 0.0
    facts[row, KIND] = kind
    facts[row, ROTARY] = kind > 0 and rotary
    facts[row, WORD] = word
    modes[ROWS] = row + 1


@kernel
def act(modes: Column, acts: Column, what: int) -> None:
    """Something that happens before the next move."""
    acts[modes[ACTS], 0] = modes[ROWS]
    acts[modes[ACTS], 1] = what
    modes[ACTS] += 1


@kernel
def put_arc(
    numbers: Column, modes: Column, shapes: Column, centre: int, across_at: float, sweep: float, turns: int
) -> None:
    """The shape of the arc whose row comes next; `centre` says where in `numbers` it stands, of the active plane."""
    first, second, across = plane_axes(modes[PLANE])
    row = modes[ARCS]
    for axis in range(6):
        numbers[MIDDLE + axis] = 0.0
    numbers[MIDDLE + first], numbers[MIDDLE + second] = numbers[centre], numbers[centre + 1]
    numbers[MIDDLE + across] = across_at
    to_machine(numbers, modes, MIDDLE)
    for axis in range(3):
        shapes[row, axis] = numbers[MIDDLE + axis] * numbers[UNIT]
        shapes[row, axis + 3] = 0.0
    shapes[row, across + 3] = 1.0
    if modes[ROTATED] and across != 2:
        x, y = shapes[row, 3], shapes[row, 4]
        shapes[row, 3] = x * numbers[COS] - y * numbers[SIN]
        shapes[row, 4] = x * numbers[SIN] + y * numbers[COS]
    shapes[row, 6] = sweep
    shapes[row, 7] = abs(turns)
    modes[ARCS] = row + 1
