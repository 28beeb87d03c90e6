"""Sizes that are compared with each other: what only rounding sets apart is the same.

3 in are 76.19999999999999 mm, 0.4 times 7 mm are 2.8000000000000003 mm: neither is a fault of the one who wrote them.
"""

from __future__ import annotations

from typing import Final

ROUNDING: Final = 1.0e-9
"""Share of a size [-] by which it may differ from an equal one: far above rounding, far below any tolerance."""


def exceeds(size: float, most: float) -> bool:
    """Whether a size is more than `most` (not negative, of the same unit) by more than rounding."""
    return not size <= most * (1.0 + ROUNDING)
