"""The error of a session."""

from __future__ import annotations


class MisuseError(ValueError):
    """A call that the cell, as it stands, cannot obey; the text says why and what to do. Nothing has changed."""
