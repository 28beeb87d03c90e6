"""Numbers as they are written in a program."""

from __future__ import annotations


def number_text(text: str, *, keep_point: bool = False, digits: int = 1, decimals: int | None = None) -> str:
    """A number without zeros that say nothing: `.50` is 0.5, `007.` is 7.

    With `keep_point` a number keeps its point, 10.00 as 10., and gets none. A whole part has at least `digits`, and
    with `decimals` there is a point with at least so many digits behind it. The value is that of `text` to the last
    digit.
    """
    whole, point, fraction = text.partition(".")
    whole = (whole.lstrip("0") or "0").rjust(digits, "0")
    fraction = fraction.rstrip("0")
    if decimals is not None and (point or not keep_point):
        return f"{whole}.{fraction.ljust(decimals, '0')}"
    if fraction:
        return f"{whole}.{fraction}"
    return f"{whole}." if point and keep_point else whole


def is_zero(text: str) -> bool:
    """Whether a number without a sign is nothing."""
    return not text.strip("0.")
