"""A tool that cuts although its length was never applied, so that it cuts where nobody programmed it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from itertools import product
from typing import TYPE_CHECKING, Final

import numpy as np

from gcodesim.canon import ToolChange
from gcodesim.cell.placement import bounds_of
from gcodesim.diagnostics import Diagnostic, Severity
from gcodesim.frames import Array
from gcodesim.shop import Shop
from gcodesim.units import MM

if TYPE_CHECKING:
    from gcodesim.planning import Plan

CODE: Final = "GS198"


def cutting_without_length(
    findings: Iterable[Diagnostic], plan: Plan, shop: Shop, removed: Array
) -> Mapping[Diagnostic, Diagnostic]:
    """Each GS198 of `findings` whose tool removes material, together with the error that it becomes.

    `removed` [m³] in each row of the path. If Z was touched off with the tool in the spindle, its length is part of
    the work offset and the tip is where it is meant to be; such a cut stays a note.
    """
    path, raised = plan.path, {}
    changes = [(timed.row, timed.event.span) for timed in path.events if isinstance(timed.event, ToolChange)]
    for finding in findings:
        if finding.code != CODE or finding.severity is not None:
            continue
        for (begin, span), (end, _) in zip(changes, [*changes[1:], (len(path), finding.span)], strict=True):
            cuts = begin + np.flatnonzero(removed[begin:end] > 0.0) if span == finding.span else np.zeros(0, np.int64)
            first = int(cuts[0]) if len(cuts) else -1
            if first >= 0 and not _has_length(shop, path.states[path.state[first]].system, (finding.value or 0.0) * MM):
                raised[finding] = replace(
                    finding,
                    severity=Severity.ERROR,
                    message=f"{finding.message}; it cuts from line {path.span(first).line} on, at the wrong depth",
                    time=float(plan.trajectory.row_start[first]),
                )
                break
    return raised


def _has_length(shop: Shop, system: int, length: float) -> bool:
    """Whether the zero of a work system named in the cell is above the stock by at least half of `length` [m]."""
    placement = shop.placement
    if placement.automatic or system not in placement.given:
        return False
    X_PW = (placement.X_WM @ placement.work_offsets[system]).inverse()
    corners = [
        (X_PW @ placement.stocks[name]).apply(np.array(list(product(*zip(*bounds_of(stock.shape), strict=True)))))
        for name, stock in shop.cell.stocks.items()
    ]
    return bool(corners) and -float(np.concatenate(corners)[:, 2].max()) >= 0.5 * length
