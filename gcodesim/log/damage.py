"""Parts of a log that cannot be read: where they are, and which time they covered."""

from __future__ import annotations

from gcodesim.frozen import frozen


@frozen
class Damage:
    """A part of a log that cannot be read: the record at byte `offset`, and why.

    `what` is `chunk`, the name of an attachment, or `record` for anything
    between those. A chunk held messages from `first_ns` to `last_ns`; if its
    own times are lost, those of its neighbours are used.
    """

    offset: int
    what: str
    reason: str
    first_ns: int | None = None
    last_ns: int | None = None

    @property
    def span(self) -> str:
        """`13.240 to 14.800 s`, empty for what is not about a time."""
        if self.first_ns is None or self.last_ns is None:
            return ""
        return f"{self.first_ns * 1e-9:.3f} to {self.last_ns * 1e-9:.3f} s"

    def __str__(self) -> str:
        if self.what == "chunk":
            return f"{self.span}: the chunk at byte {self.offset} {self.reason}"
        if self.what == "record":
            return f"a record at or behind byte {self.offset} {self.reason}"
        return f"{self.what}, attached at byte {self.offset}, {self.reason}"
