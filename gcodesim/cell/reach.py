"""Stock that the machine cannot reach whatever the program: most often a slip of units or of a sign."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from gcodesim.arithmetic.matrices import norm, norms
from gcodesim.cell.cell import Cell
from gcodesim.cell.placement import Bounds, Placement, bounds_of
from gcodesim.diagnostics import Diagnostic
from gcodesim.frames import Pose
from gcodesim.units import MM

if TYPE_CHECKING:
    from gcodesim.cell.machine_axes import MachineAxis
    from gcodesim.kinematics.chain import Tree


def reach_findings(cell: Cell, channel: str, placement: Placement) -> Iterator[Diagnostic]:
    """GS734 for each stock that no tool of the cell can touch, by bounds that are certain but not tight."""
    if not cell.tools:
        return
    mover = cell.machine_of(channel)
    longest = max(max(tool.true_length, norm(tool.X_FT.p)) + tool.reach for tool in cell.tools.values())
    tools = cell.tools.values()
    widest = max(tool.reach + max((body.widest for body in tool.primitives), default=0.0) for tool in tools)
    for name, X_WS in placement.stocks.items():
        corners = bounds_of(cell.stocks[name].shape)
        X_BS = mover.X_WB.inverse() @ X_WS
        if mover.axes:
            miss = _beyond_travel(mover.axes, X_BS, corners, longest, widest)
        else:
            miss = _beyond_arm(mover.chain.tree, X_BS, corners, max(longest, widest))
        if miss is None:
            continue
        message, value, limit = miss
        yield Diagnostic(
            code="GS734",
            span=cell.span("stock", name),
            message=f"no tool comes to stock `{name}`: {message}",
            hint="check `in:` and `xyz` of the stock, `work_offsets` and `base`, and their units",
            value=value / MM,
            limit=limit / MM,
            unit="mm",
        )


def _beyond_travel(
    axes: Sequence[MachineAxis], X_MS: Pose, corners: Bounds, longest: float, widest: float
) -> tuple[str, float, float] | None:
    """The axis whose travel ends before the stock: its wording, where the stock begins, where the travel ends [m]."""
    if any(axis.rotary and axis.at is not None for axis in axes):
        return None  # the stock or the tool turns
    cloud = X_MS.apply(np.array(list(product(*zip(*corners, strict=True)))))
    for k, letter in enumerate("XYZ"):
        axis = next((axis for axis in axes if axis.letter == letter), None)
        if axis is None:
            continue
        low, high = float(cloud[:, k].min()), float(cloud[:, k].max())
        least = axis.lower - (longest if letter == "Z" else widest)
        most = axis.upper + (0.0 if letter == "Z" else widest)
        if high < least or low > most:
            tool = "with the longest tool" if letter == "Z" else "with the widest tool"
            where = f"it stands at {letter} {low / MM:.10g} to {high / MM:.10g} mm of the machine"
            ends = f"the travel reaches from {least / MM:.10g} to {most / MM:.10g} mm {tool}"
            return f"{where}, {ends}", (high if high < least else low), (least if high < least else most)
    return None


def _beyond_arm(tree: Tree, X_BS: Pose, corners: Bounds, tool: float) -> tuple[str, float, float] | None:
    """How far the stock is from the first joint [m], and how far the arm reaches at most, if that is less."""
    if tree.prismatic.any():
        return None
    links = norms(tree.before[tree.path.astype(bool)][1:, :3, 3])
    reach = float(links.sum() + norm(tree.flange_offset[:3, 3])) + tool
    shoulder = X_BS.inverse().apply(tree.before[0][:3, 3])
    nearest = np.clip(shoulder, np.array(corners[0]), np.array(corners[1]))
    distance = norm(shoulder - nearest)
    if distance <= reach:
        return None
    message = f"it is {distance / MM:.10g} mm from the first joint, and all links and the longest tool in a row"
    return f"{message} are {reach / MM:.10g} mm", distance, reach
