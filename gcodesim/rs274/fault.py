"""A fault of the program, on its way from where it is detected to where it becomes a finding."""

from __future__ import annotations

from gcodesim.diagnostics import Span
from gcodesim.rs274.block import ColumnRange


class Fault(Exception):  # noqa: N818  (a fault of the user's, never seen outside this package)
    """Raised while a block is read or executed, and turned into a `Diagnostic` by the run.

    `at` says where: a place, a word's letter (`"x"`), a code as written in
    `gcodes` (`"g43"`), or None for the whole block. `span` is the line that is
    at fault, if that is not the line at which the control stops.
    """

    def __init__(
        self,
        code: str,
        message: str,
        *,
        at: ColumnRange | str | None = None,
        hint: str = "",
        value: float | None = None,
        limit: float | None = None,
        unit: str | None = None,
        span: Span | None = None,
        lacks: str = "",
    ) -> None:
        super().__init__(message)
        self.code = code
        self.message = message
        self.at = at
        self.hint = hint
        self.value = value
        self.limit = limit
        self.unit = unit
        self.span = span
        self.lacks = lacks
