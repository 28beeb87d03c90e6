"""Variants of a test of which some run with `make test-slow` only."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import pytest


def some_slow(values: Iterable[Any], *slow: Any) -> list[Any]:
    """The values for `parametrize`, of which those that are `slow` are left to the slow suite."""
    return [pytest.param(value, marks=pytest.mark.slow) if value in slow else value for value in values]
