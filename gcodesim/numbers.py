"""Numbers as files show them: no NaN, no infinity, no -0, shortest text that reads back the same."""

from __future__ import annotations

import json
import math
from typing import Any, NoReturn


def clean(value: Any) -> Any:
    """`value` ready for JSON, inside too: numpy scalars become Python's, NaN and infinities null, -0 becomes 0."""
    if type(value) is float:  # by far the most, so first
        return _clean_float(value)
    if isinstance(value, dict):
        return {key: clean(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [clean(item) for item in value]
    if hasattr(value, "item") and not isinstance(value, (str, bytes)):
        value = value.item()
    return _clean_float(value) if isinstance(value, float) else value


def _clean_float(value: float) -> float | int | None:
    if not math.isfinite(value):
        return None
    return int(value) if value.is_integer() and abs(value) < 1e15 else value


def rounded(value: float, digits: int = 9) -> float:
    """`value` to `digits` significant digits, so that files do not carry the last bits of a sum."""
    if value == 0.0 or not math.isfinite(value):
        return value
    return float(f"{value:.{digits - 1}e}")


def read_json(text: str | bytes) -> Any:
    """The JSON value of a text, without NaN and infinities, which Python would accept.

    ValueError if it is not JSON, or nested deeper than Python reads.
    """
    try:
        return json.loads(text, parse_constant=_refuse)
    except RecursionError:
        raise ValueError("nested too deeply") from None


def _refuse(name: str) -> NoReturn:
    raise ValueError(f"{name} is no number of JSON")
