"""Two arms from one script: `python programs/painted_together.py [OUT]`.

One arm holds a panel and brings its stripes before the gun one by one; the other sprays each of them, up and down.
What a script says is done arm by arm; all arms have one clock.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

import gcodesim

CELL = Path(__file__).resolve().parent.parent / "cells" / "spray_two_arms.yaml"
STRIPES = range(-100, 101, 40)  # [mm] of the panel's middle beside the gun
ENDS = (-130.0, 130.0)  # [mm] of the gun, below and above


def line(*points: list[float], feed: float = np.inf) -> gcodesim.ToolPath:
    """A path through points [mm] with a feed [m/s], or in rapids."""
    return gcodesim.ToolPath.from_points(1e-3 * np.array(points), feed=feed)


def main() -> None:
    out = Path(sys.argv[1]) if len(sys.argv) > 1 else None
    with gcodesim.open_cell(CELL, out=out, world="kinematic") as cell:
        painter, holder, gun = cell.robot("painter"), cell.robot("holder"), cell.tool(8)
        gun.couple(painter)
        gun.set("flow", 1.5e-6)
        painter.run(line([-150, 0, 0], [-150, 0, ENDS[0]]))
        at = STRIPES[0]
        for number, stripe in enumerate(STRIPES):
            holder.run(line([30, at, 0], [30, stripe, 0], feed=0.2))
            at = stripe
            below, above = ENDS if number % 2 == 0 else ENDS[::-1]
            gun.activate()
            painter.run(line([-150, 0, below], [-150, 0, above], feed=0.3))
            gun.deactivate()
        spent = cell.time
    film = cell.results.coating["bodies"]["panel"]
    print(f"{len(STRIPES)} stripes in {spent:.1f} s: {film['least_um']:.1f} to {film['most_um']:.1f} µm of paint")


if __name__ == "__main__":
    main()
