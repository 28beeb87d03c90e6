"""One move out of the target point: where the machine goes, and the row that says so."""

from __future__ import annotations

from gcodesim.compiled import kernel
from gcodesim.rs274.plain.columns import Column
from gcodesim.rs274.plain.layout_kernels import (
    COS,
    CURRENT,
    DEG,
    FEED,
    FEED_MODE,
    FEED_UNIT,
    G92,
    KIND,
    MINUTE,
    ORIGIN,
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
def append(numbers: Column, modes: Column, moves: Column, facts: Column, kind: int, word: int, linear: bool) -> None:
    """A move of `kind` (as in `canon.MoveBatch`) to the target, which becomes the current point."""
    row = modes[ROWS]
    for axis in range(6):
        numbers[CURRENT + axis] = numbers[TARGET + axis]
    to_machine(numbers, modes, TARGET)
    for axis in range(3):
        moves[row, axis] = numbers[TARGET + axis] * numbers[UNIT]
        moves[row, axis + 3] = numbers[TARGET + axis + 3] * numbers[DEG]
    moves[row, 6] = 0.0
    if kind > 0:
        size = numbers[FEED] * (numbers[FEED_UNIT] if linear else numbers[DEG])
        moves[row, 6] = size if modes[FEED_MODE] == 950 else size / numbers[MINUTE]
    facts[row, KIND] = kind
    facts[row, ROTARY] = kind > 0 and not linear
    facts[row, WORD] = word
    modes[ROWS] = row + 1
