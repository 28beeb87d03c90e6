"""A run row by row, as a process sees it when it looks for misuse."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gcodesim.diagnostics import Diagnostic, Span
from gcodesim.diagnostics.events import Flags, runs
from gcodesim.frozen import frozen

if TYPE_CHECKING:
    from gcodesim.tools.tool import Tool

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


@frozen(eq=False)
class Rows:
    """n rows of the path, all columns (n,).

    `rapid`: the row is a rapid; `tool`: number of the tool; `setting`: a number that changes whenever tool or spindle
    do; `changed`: a tool came into the spindle between the row before and this one; `retreat`: the row leads straight
    along the tool's axis away from the work; `time` [s] at which the row begins. `turns` says for each rotary axis
    of unknown place, by letter, in which rows it turns; `grain` [m³] is the volume of a cell of the coarsest
    stock. `columns` are those that the process wrote, as summed up by the executor: zero in rows of other processes.
    `span` is where a row stands in the program, `change_spans` where the program asks for the tool that comes before a
    row, `stay_spans` where it asks for a stay before a row, and `with_word` gives the rows whose motion word is one of
    some; `ended`: the program has run to its end.
    """

    rapid: Flags
    tool: Ints
    setting: Ints
    changed: Flags
    retreat: Flags
    time: Array
    columns: Mapping[str, Array]
    span: Callable[[int], Span]
    with_word: Callable[[frozenset[str]], Flags]
    tools: Mapping[int, Tool] = field(default_factory=dict)
    turns: Mapping[str, Flags] = field(default_factory=dict)
    change_spans: Mapping[int, Span] = field(default_factory=dict)
    stay_spans: Mapping[int, Span] = field(default_factory=dict)
    grain: float = 0.0
    ended: bool = False

    def __len__(self) -> int:
        return len(self.rapid)

    def __getitem__(self, column: str) -> Array:
        """A column; zeros when there is none of that name."""
        found = self.columns.get(column)
        return np.zeros(len(self)) if found is None else found

    def tool_name(self, row: int) -> str:
        """The name of a row's tool in messages."""
        number = int(self.tool[row])
        tool = self.tools.get(number)
        return f"T{number}" if tool is None else tool.name

    def events(self, fault: Flags, ends: Flags | None = None) -> Iterator[NDArray[np.intp]]:
        """The rows (k,) of each event at `fault`; an event lasts until tool or spindle change or a row is in `ends`.

        Without `ends` an event ends at the first row that is free of it.
        """
        return runs(fault, ends, self.setting)

    def told(
        self,
        event: NDArray[np.intp],
        code: str,
        message: str,
        hint: str,
        numbers: tuple[float, float, str] | None = None,
    ) -> Diagnostic:
        """The finding for the rows (k,) of one event, at the first of them; `numbers` are value, limit and unit."""
        first = int(event[0])
        value, limit, unit = numbers or (None, None, None)
        return Diagnostic(
            code=code,
            message=message,
            hint=hint,
            span=self.span(first),
            time=float(self.time[first]),
            count=len(event),
            value=value,
            limit=limit,
            unit=unit,
        )
