"""Cells of the stock that are too large for a tool."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Final

from gcodesim.arithmetic.distinct import distinct
from gcodesim.diagnostics import Diagnostic
from gcodesim.motion.tool_path import HOME, RAPID
from gcodesim.units import MM

if TYPE_CHECKING:
    from gcodesim.planning.plan import Plan
    from gcodesim.shop import Shop

FEWEST: Final = 2.0  # columns across a cutter; with fewer it may pass between them and cut nothing
_WELL: Final = 20.0  # columns across a cutter with which volumes are good to about 1 %


def coarse_findings(shop: Shop, plan: Plan) -> Iterator[Diagnostic]:
    """GS412 for each stock whose cells are more than half as wide as the thinnest cutter that feeds on the plan."""
    path = plan.path
    feeding = distinct(path.state[(path.kind != RAPID) & (path.kind != HOME)])
    tools = [shop.tool(number) for number in sorted({path.states[k].tool for k in feeding})]
    cutters = [(width, tool) for tool in tools if tool is not None and (width := getattr(tool, "diameter", None))]
    if not cutters:
        return
    thinnest, tool = min(cutters, key=lambda cutter: cutter[0])
    for name, placed in shop.stocks.items():
        cell = placed.stock.cell
        if FEWEST * cell <= thinnest * (1.0 + 1e-9):
            continue
        yield Diagnostic(
            code="GS412",
            span=shop.cell.span("stock", name, "resolution"),
            message=f"stock `{name}` has cells of {cell / MM:.4g} mm; {tool.name} is {thinnest / MM:.4g} mm wide, "
            "so its cuts may fall between them",
            hint=f"`resolution: {thinnest / FEWEST / MM:.3g} mm` at the most; "
            f"{thinnest / _WELL / MM:.2g} mm gives volumes to about 1 %",
            value=cell / MM,
            limit=thinnest / FEWEST / MM,
            unit="mm",
        )
