"""The columns of a run: those that every run has, and those of the processes of the cell's tools."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from gcodesim.frozen import frozen
from gcodesim.processes.column import HOUSE, Column, Shown

if TYPE_CHECKING:
    from gcodesim.tools.tool import Tool


@frozen
class Sheet:
    """The kinds of process, "" (none) first, and the columns, both in the order in which they are shown.

    `columns` begins with `HOUSE` and has no name twice; columns that are shown nowhere are left out.
    """

    kinds: tuple[str, ...] = ("",)
    columns: tuple[Column, ...] = HOUSE

    @staticmethod
    def of(tools: Iterable[Tool], more: Iterable[str] = ()) -> Sheet:
        """The sheet of a cell with these tools, and with `more` kinds of process that their machine lets them do.

        ValueError when two processes use one name for different columns."""
        from gcodesim.processes import PROCESSES

        tools = list(tools)
        kinds = PROCESSES.in_order([*(kind for tool in tools for kind in tool.acts_by), *more])
        known = {column.name: column for column in HOUSE}
        owner = dict.fromkeys(known, "every run")
        for kind in kinds:
            users = [tool for tool in tools if kind in tool.acts_by]
            asked = (column for tool in users for column in PROCESSES[kind].columns_of(tool))
            for column in dict.fromkeys((*PROCESSES[kind].writes, *asked)):
                if column.shown_in is Shown.NOWHERE:
                    continue
                other = known.setdefault(column.name, column)
                if other != column:
                    raise ValueError(f"column `{column.name}` of {kind} is another one in {owner[column.name]}")
                owner.setdefault(column.name, kind)
        return Sheet(kinds=("", *kinds), columns=tuple(known.values()))

    def shown_in(self, where: Shown) -> tuple[Column, ...]:
        """The columns that are shown there."""
        return tuple(column for column in self.columns if column.shown_in & where)

    def own(self, where: Shown) -> tuple[Column, ...]:
        """The columns among them that only the processes of this cell have."""
        return tuple(column for column in self.shown_in(where) if column not in HOUSE)
