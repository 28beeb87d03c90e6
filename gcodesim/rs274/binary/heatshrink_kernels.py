"""Heatshrink: single bytes and repetitions of what came before, in a stream of bits, the highest of a byte first.

A 1 and eight bits are a byte; a 0, `window` bits and `look_ahead` bits are how far back, less one, and how many, less
one (heatshrink 0.4, README.md and heatshrink_decoder.c).
"""

from __future__ import annotations

from gcodesim.compiled import kernel
from gcodesim.rs274.plain.columns import Column

_BYTE = 8


@kernel
def expand(packed: Column, out: Column, window: int, look_ahead: int) -> bool:
    """Fill `out` from `packed`, both uint8; false if that is not what the bits have.

    Behind the last bits, less than two bytes may be left: the encoder fills its last byte, and may begin another.
    """
    waiting, known, at, done = 0, 0, 0, 0
    while done < len(out):
        while known < 24 and at < len(packed):
            waiting = (waiting << _BYTE) | packed[at]
            known += _BYTE
            at += 1
        if known < 1:
            return False
        known -= 1
        if (waiting >> known) & 1:
            if known < _BYTE:
                return False
            known -= _BYTE
            out[done] = (waiting >> known) & 255
            done += 1
        else:
            if known < window + look_ahead:
                return False
            known -= window
            back = ((waiting >> known) & ((1 << window) - 1)) + 1
            known -= look_ahead
            count = ((waiting >> known) & ((1 << look_ahead) - 1)) + 1
            if done + count > len(out):
                return False
            for _ in range(count):
                # before the first byte are zeros
                out[done] = out[done - back] if done >= back else 0
                done += 1
        waiting &= (1 << known) - 1
    return known + (len(packed) - at) * _BYTE < 2 * _BYTE
