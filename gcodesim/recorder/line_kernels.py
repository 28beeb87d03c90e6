"""Program lines without the blanks around them, as places in the bytes of the file."""

from __future__ import annotations

from typing import Any

from gcodesim.compiled import kernel


@kernel(lean=True)
def trim(begin: Any, end: Any, data: Any, plain: Any) -> None:
    """Move `begin` and `end` (n,) past what `str.strip` removes; `plain` (n,) says whether a line is all ASCII."""
    for i in range(len(begin)):
        a, b = begin[i], end[i]
        plain[i] = True
        for k in range(a, b):
            if data[k] > 127:
                plain[i] = False
                break
        while a < b and (data[a] == 32 or 9 <= data[a] <= 13 or 28 <= data[a] <= 31):
            a += 1
        while a < b and (data[b - 1] == 32 or 9 <= data[b - 1] <= 13 or 28 <= data[b - 1] <= 31):
            b -= 1
        begin[i], end[i] = a, b
