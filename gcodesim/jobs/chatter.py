"""Tips that swing on the gears of their machine while they cut."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from gcodesim.diagnostics import Diagnostic, Span
from gcodesim.executor.tip_swings import TipSwings
from gcodesim.processes.rows import Rows
from gcodesim.units import MM


def chatter_findings(swings: TipSwings | None, rows: Rows, spans: Callable[[int], Span]) -> Iterator[Diagnostic]:
    """GS518: one for each tool, where it begins; `rows` are those of the path."""
    by_tool: dict[int, list[int]] = {}
    if swings is not None:
        for run in swings.chatter():
            by_tool.setdefault(int(rows.tool[swings.row[run.start]]), []).extend(range(run.start, run.stop))
    for stretches in by_tool.values():
        assert swings is not None
        worst, first = max(stretches, key=swings.widest.__getitem__), stretches[0]
        seconds = swings.dt * sum(swings.steps[k] for k in stretches)
        lines = {spans(swings.row[k]).line for k in stretches}
        yield Diagnostic(
            code="GS518",
            message=f"{rows.tool_name(swings.row[first])} chatters: its tip swings on the gears by up to "
            f"{swings.widest[worst] / MM:.3f} mm and goes back against the feed, in {seconds:.1f} s of cutting",
            span=spans(swings.row[first]),
            hint=f"cut less deep or less wide; it is worst in line {spans(swings.row[worst]).line}",
            count=len(lines),
            time=swings.time[first],
            value=swings.widest[worst] / MM,
            unit="mm",
        )
