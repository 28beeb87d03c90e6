"""Copying many short stretches of bytes to where they belong."""

from __future__ import annotations

from typing import Any

from gcodesim.compiled import kernel


@kernel(lean=True)
def place(at: Any, out: Any, source: Any, begin: Any, size: Any) -> None:
    """Copy `size` (n,) bytes from `begin` (n,) on in `source` to `at` (n,) and further in `out`, both uint8."""
    for i in range(len(at)):
        # in slices the index counts from 0: an index that might be negative would be checked at every byte
        to, start = out[at[i] : at[i] + size[i]], source[begin[i] : begin[i] + size[i]]
        for k in range(size[i]):
            to[k] = start[k]
