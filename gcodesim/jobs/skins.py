"""The skin of the part that was compared with its target, painted by deviation and by the lines that made it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.material.skin import Maker, PaintedSkin, deviations, skin_to_paint

if TYPE_CHECKING:
    from gcodesim.frames import Array
    from gcodesim.jobs.job import Job
    from gcodesim.material.deviation import Misfit
    from gcodesim.material.passes import Makers, Passes
    from gcodesim.shop import PlacedStock


Mesh = tuple["Array", NDArray[np.int32]]
"""Vertices (v, 3) [m] and faces (f, 3)."""

SLACK: Final = 0.05
"""Cells between a face and the tool that made it: facets of tools, chords of arcs."""


def slack_of(cell: float) -> float:
    """How far [m] a face of a stock with cells of this size may be from the tool that made it."""
    return max(5.0e-6, SLACK * cell)


def painted(
    job: Job, placed: PlacedStock, passes: Passes, target: Mesh, tolerance: float, regions: Sequence[Misfit]
) -> tuple[PaintedSkin, Makers]:
    """The skin of a stock as it is now, and which row made each face; `target` stands in the stock's frame.

    `tolerance` is in m; `regions` are the places out of tolerance, in the order of the results.
    """
    vertices, faces, points, normals = skin_to_paint(placed.stock)
    made = passes.makers(points, slack_of(placed.stock.cell), within=True)
    known: dict[tuple[str, int, int], int] = {}
    keys = np.stack([made.program, made.row], axis=1)
    pairs, which = np.unique(keys, axis=0, return_inverse=True)
    number = np.full(len(pairs), -1, dtype=np.int32)
    for k, (program, row) in enumerate(pairs.tolist()):
        if row >= 0:
            plan = job.all[program].plan
            assert plan is not None
            span, tool = plan.path.span(row), plan.path.states[plan.path.state[row]].tool
            number[k] = known.setdefault((span.file, span.line, tool), len(known))
    maker = number[which.reshape(-1)]
    skin = PaintedSkin(
        vertices=vertices,
        faces=faces,
        deviation=deviations(target, points, normals),
        maker=maker,
        makers=[Maker(file=file, line=line, tool=tool) for file, line, tool in known],
        turn=turn_of(placed),
        tolerance=tolerance,
        spots=np.array([(region.low, region.high) for region in regions]).reshape(-1, 2, 3),
    )
    return skin, made


def turn_of(placed: PlacedStock) -> Array:
    """From the frame of a stock's columns into the part's own."""
    return np.ascontiguousarray(placed.stock.in_part(np.eye(3)).T)
