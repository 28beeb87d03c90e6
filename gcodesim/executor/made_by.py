"""Who made which face of a stock: the passes of tools, kept for runs with a target."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from gcodesim.processes.column import ADDED

if TYPE_CHECKING:
    from gcodesim.executor.stint import Stint
    from gcodesim.frames import Array
    from gcodesim.material.passes import Passes
    from gcodesim.shop import Shop


def passes_of(shop: Shop) -> dict[str, Passes]:
    """Where the passes at each stock are kept; empty for a cell without a target."""
    if shop.cell.target is None:
        return {}
    from gcodesim.material.passes import Passes

    return {name: Passes(lathe=placed.revolved) for name, placed in shop.stocks.items()}


def add_passes(passes: dict[str, Passes], stints: Sequence[Stint], program: int) -> None:
    """Keep what the stints of a window did to stocks; `program` is the number of their channel."""
    from gcodesim.material.kernels import PassPieces

    for stint in stints:
        answer, swept, own = stint.answer, stint.task.process.swept, passes.get(stint.task.target.name)
        if answer is None or swept is None or own is None:
            continue
        window = stint.window
        step = window.piece_step
        kept = np.flatnonzero(answer[ADDED.name][step] > 0.0) if ADDED.name in answer.columns else np.arange(len(step))
        step, share = step[kept], stint.share[kept]
        bend = answer.deflection[step]
        before = window.axis if window.axis_before is None else window.axis_before
        pieces = PassPieces(
            starts=window.piece_start[kept] + bend,
            ends=window.piece_end[kept] + bend,
            axes_start=_between(before[step], window.axis[step], share[:, :1]),
            axes_end=_between(before[step], window.axis[step], share[:, 1:]),
            body=np.zeros(len(kept), dtype=np.int32),
        )
        own.add(swept, pieces, stint.row[kept], program)


def _between(one: Array, other: Array, share: Array) -> Array:
    return one + share * (other - one)
