"""Roots by + − * / alone: the same bits on every processor."""

from __future__ import annotations

from gcodesim.compiled import kernel


@kernel
def cube_root(x: float) -> float:
    """The cube root of `x` >= 0, to two units in the last place (Newton's method from above)."""
    if x <= 0.0:
        return 0.0
    scale = 1.0
    while x > 8.0:
        x *= 0.125
        scale *= 2.0
    while x < 1.0:
        x *= 8.0
        scale *= 0.5
    root = 2.0
    while True:
        better = (2.0 * root + x / (root * root)) / 3.0
        if better >= root:
            return root * scale
        root = better
