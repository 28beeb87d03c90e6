"""A printer that has executed all lines before one."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from gcodesim.frozen import frozen
from gcodesim.rs274.entry.halted import Halted

if TYPE_CHECKING:
    from gcodesim.rs274.marlin.printer import Printer


@frozen(eq=False)
class HaltedPrint(Halted):
    """With the `printer` as it is then: its filament, its settings and what it has said."""

    printer: Printer

    def own_obstacles(self, line: int) -> Iterator[str]:
        if self.file.decides:
            yield "the program has variables, conditions or loops, and knows them only from its beginning"
