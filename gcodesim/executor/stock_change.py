"""What tools do to each stock in a run."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from gcodesim.arithmetic.matrices import norms
from gcodesim.processes.column import ADDED, REMOVED

if TYPE_CHECKING:
    from gcodesim.executor.stint import Stint


class StockChange(NamedTuple):
    """What was done to one stock: volumes [m³] `removed` and `added`, and the greatest `force` [N] that it felt."""

    removed: float = 0.0
    added: float = 0.0
    force: float = 0.0


UNCHANGED: Final = StockChange()


def add_changes(changes: dict[str, StockChange], stints: Sequence[Stint]) -> None:
    """Add up what was done to each stock."""
    for stint in stints:
        answer = stint.answer
        if answer is None or not (REMOVED.name in answer.columns or ADDED.name in answer.columns):
            continue
        force = float(norms(answer.wrench[:, :3]).max(initial=0.0))
        for name, columns in (answer.by_stock or {stint.task.target.name: answer.columns}).items():
            so_far = changes.get(name, UNCHANGED)
            changes[name] = StockChange(
                so_far.removed + float(np.sum(columns.get(REMOVED.name, 0.0))),
                so_far.added + float(np.sum(columns.get(ADDED.name, 0.0))),
                max(so_far.force, force),
            )
