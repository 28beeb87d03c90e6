"""Messages of fixed length, filled row by row."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from gcodesim.compiled import kernel

UNIT = 1.0e-6
"""How far the square of a quaternion's length may be from 1."""

NOT_FINITE, NOT_UNIT, NOT_CANONICAL = 1, 2, 3


class RowSlots(NamedTuple):
    """What is filled in at which places of a row.

    Doubles at `number_at` (s,) from the columns `number_from` (s,), likewise flags; stamps (12 bytes, both integers
    in five), times (8) and sequences (4).
    """

    number_at: Any
    number_from: Any
    flag_at: Any
    flag_from: Any
    stamp_at: Any
    time_at: Any
    sequence_at: Any


@kernel(lean=True)
def put_integer(value: int, count: int, at: int, out: Any) -> None:
    """The first `count` bytes of an integer, low byte first, from place `at` on in `out`."""
    for byte in range(count):
        out[at + byte] = value >> 8 * byte & 255


@kernel(lean=True)
def fill_rows(
    template: Any, slots: RowSlots, values: Any, value_bytes: Any, t_ns: Any, sequence: Any, at: Any, data: Any
) -> None:
    """Copy `template` (w,) to each place of `at` (n,) in `data` and fill its slots.

    They come from `values` (n, c), which are `value_bytes` (n, 8 c) too, `t_ns` (n,) and `sequence` (n,).
    """
    number_at, number_from, flag_at, flag_from, stamp_at, time_at, sequence_at = slots
    width = len(template)
    for i in range(len(at)):
        room, given = data[at[i] : at[i] + width], value_bytes[i]
        for c in range(width):
            room[c] = template[c]
        for s in range(len(number_at)):
            to, start = room[number_at[s] : number_at[s] + 8], given[8 * number_from[s] : 8 * number_from[s] + 8]
            for byte in range(8):
                to[byte] = start[byte]
        for s in range(len(flag_at)):
            room[flag_at[s]] = 1 if values[i, flag_from[s]] != 0.0 else 0
        seconds, nanos = t_ns[i] // 1_000_000_000, t_ns[i] % 1_000_000_000
        for s in range(len(stamp_at)):
            stamp = room[stamp_at[s] : stamp_at[s] + 12]
            stamp[0], stamp[6] = 8, 16  # fields 1 and 2
            for group in range(5):
                more = 128 if group < 4 else 0
                stamp[1 + group] = seconds >> 7 * group & 127 | more
                stamp[7 + group] = nanos >> 7 * group & 127 | more
        for s in range(len(time_at)):
            put_integer(t_ns[i], 8, time_at[s], room)
        for s in range(len(sequence_at)):
            put_integer(sequence[i], 4, sequence_at[s], room)


@kernel(lean=True)
def fault_of(values: Any, quaternion_from: Any) -> int:
    """What is wrong with `values` (n, c), in which quaternions begin at the columns `quaternion_from`.

    0, or the first of these: a number is not finite, a quaternion is not of unit length, a quaternion has w ≤ 0.
    """
    fault = 0
    for i in range(values.shape[0]):
        wild = 0
        for c in range(values.shape[1]):
            wild += not abs(values[i, c]) < np.inf
        if wild > 0:
            return NOT_FINITE
        for q in range(len(quaternion_from)):
            c = quaternion_from[q]
            x, y, z, w = values[i, c], values[i, c + 1], values[i, c + 2], values[i, c + 3]
            if not abs(x * x + y * y + z * z + w * w - 1.0) < UNIT:
                fault = NOT_UNIT
            elif not w > 0.0 and fault == 0:
                fault = NOT_CANONICAL
    return fault
