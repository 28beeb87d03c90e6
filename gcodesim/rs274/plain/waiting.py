"""With cutter compensation: the move that waits for the next corner, into the arrays of the lane and back."""

from __future__ import annotations

from collections.abc import Callable

from gcodesim.diagnostics import Span
from gcodesim.diagnostics.span_table import Origin
from gcodesim.rs274.compensation import Held
from gcodesim.rs274.plain import layout_kernels as at
from gcodesim.rs274.plain.columns import Column
from gcodesim.rs274.state import ModalState, Vector

_KINDS = ("rapid", "line", "arc")


def is_known(state: ModalState) -> bool:
    """Whether exactly one move waits, of a kind that the kernels know, and the tool is not one of a lathe."""
    if state.comp_first or len(state.held) != 1 or state.feed_mode == 930:
        return False
    (move,) = state.held
    if type(move) is not Held or not (move.kind == "arc" or move.direction != (0.0, 0.0)):
        return False
    if state.plane == 180 and state.comp_orientation:
        return False
    return move.kind == "rapid" or (move.feed_unit in ("m/rev", "rad/rev")) == (state.feed_mode == 950)


def write(state: ModalState, numbers: Column, modes: Column, index: int, origin: int) -> None:
    """What the kernels have to know of the move that waits, in the line with `index`, and of the one before."""
    (move,) = state.held
    assert type(move) is Held
    endpoint = state.comp_endpoint
    numbers[at.RADIUS : at.NEXT_START] = (
        state.comp_radius, *state.comp_normal, *(endpoint or (0.0, 0.0)), *state.comp_emitted[:6],
        *move.end[:6], *move.direction, *move.centre, move.sweep, move.feed,
    )  # fmt: skip
    kind = _KINDS.index(move.kind) + (move.turns > 0)
    modes[at.HAS_ENDPOINT : at.WANTED] = (
        endpoint is not None, kind, move.turns, move.feed_unit in ("rad/s", "rad/rev"),
        index, move.span.column, move.span.end_column, move.block, origin,
    )  # fmt: skip


def take_over(
    state: ModalState, numbers: Column, modes: Column, origin_of: Callable[[int], tuple[Origin, int]]
) -> None:
    """What waits after a run of lines; `origin_of` a number gives file and callers, and the index of line 0."""

    def point(first: int) -> Vector:
        x, y, z, a, b, c = numbers[first : first + 6].tolist()
        return (x, y, z, a, b, c, *state.comp_programmed[6:])

    def pair(first: int) -> tuple[float, float]:
        a, b = numbers[first : first + 2].tolist()
        return a, b

    kind, turns, rotary, index, column, end_column, block, origin = modes[at.HELD_KIND : at.WANTED].tolist()
    (file, callers), base = origin_of(origin)
    line = index - base
    per_revolution = kind > 0 and state.feed_mode == 950
    state.held = (
        Held(
            span=Span(file, line, column, line, end_column, callers),
            kind=_KINDS[min(kind, 2)],
            end=point(at.HELD_END),
            direction=pair(at.HELD_DIRECTION),
            centre=pair(at.HELD_CENTRE),
            turns=turns,
            sweep=float(numbers[at.HELD_SWEEP]),
            feed=float(numbers[at.HELD_FEED]),
            feed_unit=("rad" if rotary else "m") + ("/rev" if per_revolution else "/s"),  # type: ignore[arg-type]
            block=block,
            word=f"G{kind}",
        ),
    )
    state.current = state.held[0].end
    state.comp_programmed = point(at.CURRENT)
    state.comp_normal = pair(at.NORMAL)
    state.comp_endpoint = pair(at.ENDPOINT) if modes[at.HAS_ENDPOINT] else None
    if modes[at.ROWS]:
        state.comp_emitted = point(at.EMITTED)
