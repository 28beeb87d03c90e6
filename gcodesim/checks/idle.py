"""Parts of a cell that a run ignores: no key may be silently without effect."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from gcodesim.arithmetic.distinct import distinct
from gcodesim.canon import AXIS_LETTERS
from gcodesim.cell import Cell
from gcodesim.cell.placing import MACHINE
from gcodesim.diagnostics import Diagnostic
from gcodesim.motion.tool_path import ToolPath
from gcodesim.scene import Mover


def idle_findings(cell: Cell, running: Sequence[str]) -> Iterator[Diagnostic]:
    """GS909, GS910: keys without effect, channels that are not `running`, and robots that nothing moves."""
    for channel in running:
        if cell.channels[channel].optional_stop:
            yield Diagnostic(
                code="GS909",
                span=cell.channel_span(channel, "optional_stop"),
                message="`optional_stop` has no effect: nobody stands at the simulated machine "
                "who would start it again",
                hint="M0 and M1 bring the tool to rest, and the program goes on",
            )
    movers = [*([MACHINE] if cell.machine is not None else []), *cell.robots]
    moved = [cell.channels[channel].robot or MACHINE for channel in running]
    moved = [name if name in movers else movers[0] for name in moved]
    for name, other in cell.channels.items():
        if name not in running:
            known = " and ".join(f"`{channel}`" for channel in running)
            yield Diagnostic(
                code="GS910",
                span=cell.span("channels", name),
                message=f"channel `{name}` does not run: no program is named for it, only for {known}",
                hint=f"its {other.robot or MACHINE} is left out; name its program: `--channel {name}=PROGRAM`, "
                "or `program:` in the cell",
            )
    for name in movers:
        if name not in moved and not any((other.robot or MACHINE) == name for other in cell.channels.values()):
            path = ("machine",) if name == MACHINE else ("robots", name)
            yield Diagnostic(
                code="GS909",
                span=cell.span(*path),
                message=f"`{name}` is left out: no channel runs it",
                hint="a robot that stands still is not in the way of anything either",
            )


def blind_axis_findings(path: ToolPath, mover: Mover) -> Iterator[Diagnostic]:
    """GS911: rotary axes that move although their place is unknown; at the first row of each."""
    if not len(path):
        return
    for letter in mover.timed_only:
        column = AXIS_LETTERS.index(letter)
        moved = np.flatnonzero(np.abs(path.end[:, column] - path.start[:, column]) > 1e-12)
        if len(moved):
            yield Diagnostic(
                code="GS911",
                span=path.span(int(moved[0])),
                message=f"axis {letter} takes time only: the cell does not say where it is, so nothing turns",
                hint=f"give a point on it: `{letter}: {{at: [x, y, z], …}}`",
                count=len(distinct(path.block[moved])),
            )
