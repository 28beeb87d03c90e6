"""The error of a session."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager


class MisuseError(ValueError):
    """A call that the cell, as it stands, cannot obey; the text says why and what to do. Nothing has changed."""


@contextmanager
def as_misuse() -> Iterator[None]:
    """What is wrong with values that a script gives is misuse, in the words of `gcodesim.given`."""
    try:
        yield
    except ValueError as fault:
        raise fault if isinstance(fault, MisuseError) else MisuseError(str(fault)) from None
