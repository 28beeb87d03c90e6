"""Bytes of a line."""

from __future__ import annotations

import numpy as np

from gcodesim.compiled import kernel
from gcodesim.rs274.plain.columns import Column


@kernel
def byte_at(text: Column, at: int) -> int:
    """One byte as a signed integer, so that sums with it stay integers."""
    byte: int = text[at] + np.int64(0)
    return byte


@kernel
def behind_blanks(text: Column, at: int, stop: int) -> int:
    while at < stop and (text[at] == 32 or text[at] == 9):
        at += 1
    return at
