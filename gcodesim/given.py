"""What a caller gives: numbers, lists of numbers and quaternions, checked where they come in and told in words."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

_LONGEST = 60  # letters of a value in a message


def number(value: object, what: str, *, above: float | None = None, least: float | None = None) -> float:
    """A finite number, greater than `above` and not below `least`; ValueError, which names `what`, for others."""
    try:
        found = float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        raise ValueError(f"{what} is a number; {_shown(value)} is given") from None
    if isinstance(value, (str, bytes)) or not np.isfinite(found):
        raise ValueError(f"{what} is a finite number; {_shown(value)} is given")
    if above is not None and not found > above:
        raise ValueError(f"{what} is more than {above:g}; {found:g} is given")
    if least is not None and not found >= least:
        raise ValueError(f"{what} is at least {least:g}; {found:g} is given")
    return found


def numbers(value: object, shape: Sequence[int | None], what: str) -> NDArray[np.float64]:
    """Finite numbers of a shape, in which None stands for any length; ValueError, which names `what`, for others."""
    try:
        found = np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        found = None
    fits = found is not None and len(shape) == found.ndim
    if found is None or not fits or any(n not in (None, m) for n, m in zip(shape, found.shape, strict=True)):
        raise ValueError(f"{what} has {_shape_in_words(shape)}; {_shown(value)} is given")
    if not np.isfinite(found).all():
        raise ValueError(f"{what} has finite numbers; {_shown(value)} is given")
    return found


def quaternions(value: object, shape: Sequence[int | None], what: str) -> NDArray[np.float64]:
    """Quaternions x y z w of a shape that ends with 4, none of them all zero; ValueError as of `numbers`."""
    found = numbers(value, shape, what)
    if not found.any(axis=-1).all():
        raise ValueError(f"{what} is a quaternion x y z w, which is not all 0; {_shown(value)} is given")
    return found


def _shape_in_words(shape: Sequence[int | None]) -> str:
    *outer, last = ("" if n is None else f"{n} " for n in shape)
    return "".join([*(f"{n}rows of " for n in outer), f"{last}numbers"])


def _shown(value: object) -> str:
    text = " ".join(repr(value).split())
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 1]}…"
