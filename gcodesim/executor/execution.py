"""How far a run has come, and what comes of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field
from typing import TYPE_CHECKING

from gcodesim.frozen import frozen

if TYPE_CHECKING:
    from gcodesim.executor.accuracy import PathAccuracy
    from gcodesim.executor.freeing import Freed
    from gcodesim.executor.loose_bodies import LooseBody
    from gcodesim.executor.part_run import PartEnd
    from gcodesim.executor.stock_change import StockChange
    from gcodesim.executor.tip_swings import TipSwings
    from gcodesim.executor.totals import JointTotals, RowTotals
    from gcodesim.material.passes import Passes
    from gcodesim.processes.gripping import GripEvent
    from gcodesim.scene import Stay


@frozen
class Progress:
    """How far a run has come: steps done and in all, simulated time [s], path row."""

    step: int
    steps: int
    time: float
    row: int


@frozen(eq=False)
class Execution:
    """The outcome of a run. `interrupted`: somebody stopped it after `steps` of `planned` steps.

    `parts` is what became of parts, `stays` where they have been, `late_grips` what happened to them after the last
    step.
    `changes` says what was done to each stock. `others`: the same of further channels.
    `passes` at each stock, of all channels, where there is a target.
    `accuracy`: how far the tip was off its path; None where neither gears nor controllers let it. `swings`: how its tip
    swung while it cut; None where gears do not move. `freed` are the pieces that came loose, in order, and `loose` what
    became of those of all channels, where the world is an engine.
    """

    rows: RowTotals
    joints: JointTotals
    steps: int
    planned: int
    last_row: int
    interrupted: bool
    changes: Mapping[str, StockChange] = field(default_factory=dict)
    parts: Mapping[str, PartEnd] = field(default_factory=dict)
    stays: Sequence[Stay] = ()
    late_grips: tuple[GripEvent, ...] = ()
    others: Sequence[Execution] = ()
    passes: Mapping[str, Passes] = field(default_factory=dict)
    accuracy: PathAccuracy | None = None
    swings: TipSwings | None = None
    freed: Sequence[Freed] = ()
    loose: Sequence[LooseBody] = ()
