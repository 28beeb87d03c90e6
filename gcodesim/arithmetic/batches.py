"""Rows of long tables a few at a time, so that what is worked out of them stays near the processor."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

AT_ONCE: Final = 4096
"""Rows; poses of so many are half a megabyte."""


def batches(count: int) -> Iterator[slice]:
    """All of `count` rows in order, none twice."""
    for begin in range(0, count, AT_ONCE):
        yield slice(begin, min(begin + AT_ONCE, count))
