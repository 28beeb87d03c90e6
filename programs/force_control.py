"""The joints make up for the milling force: `python programs/force_control.py [OUT]`.

An arm mills the same slot twice. Gears yield to the force of the cut; the second time a controller turns the motors
further by what the measured force winds up in them.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import ClassVar

import numpy as np

import gcodesim
from gcodesim.controllers import Controller, Sense
from gcodesim.controllers.flexible import Flexible
from gcodesim.frozen import frozen

CELL = Path(__file__).resolve().parent.parent / "cells" / "force_control.yaml"
SLOT = 1e-3 * np.array([[-10, 30, 10], [-10, 30, -2], [40, 30, -2], [40, 30, 10]])  # of the tip in G54 [m]


@frozen(slots=False, eq=False)
class Stiffened(Flexible):
    """Turns the motors further by what the measured force of the cut winds up in the gears."""

    kind: ClassVar[str] = "stiffened"

    def aim(self, sense: Sense) -> np.ndarray:
        last = sense.memory.get("wrench", np.zeros(6))
        sense.memory["wrench"] = felt = last + 0.2 * (sense.wrench - last)  # 20 ms, as a sensor smooths
        wound: np.ndarray = (sense.model.jacobian(sense.q).T @ felt) / sense.model.gears
        return sense.q_ref - wound


CONTROLLERS: tuple[Controller, ...] = (Flexible(), Stiffened())


def cut(controller: Controller, out: Path | None = None) -> dict[str, float]:
    """Path accuracy of the slot with this controller; `out` is the folder for log and results."""
    with gcodesim.open_cell(CELL, out=out) as cell:
        arm, mill = cell.robot(), cell.tool(1)
        arm.controller = controller
        mill.couple(arm)
        mill.spin(840.0)
        arm.run(gcodesim.ToolPath.from_points(SLOT, feed=0.015))
    found = cell.results.path_accuracy
    assert found is not None
    return dict(found)


def main() -> None:
    out = Path(sys.argv[1]) if len(sys.argv) > 1 else None
    for controller in CONTROLLERS:
        found = cut(controller, out / controller.kind if out else None)
        print(f"{controller.kind}: rms {found['rms_mm']:.4f} mm, greatest in the cut {found['AT_engaged_mm']:.4f} mm")


if __name__ == "__main__":
    main()
