"""Teaching by poses: `python programs/taught_poses.py [OUT]`.

The arm is brought to each pose and remembers its joints; then it goes there and back
through all of them without a stop.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

import gcodesim

CELL = Path(__file__).resolve().parent.parent / "cells" / "taught_poses.yaml"
PLACES = ([0.45, -0.40, 0.35], [0.60, -0.25, 0.55], [0.65, 0.00, 0.65], [0.60, 0.25, 0.55], [0.45, 0.40, 0.35])  # [m]


def main() -> None:
    out = Path(sys.argv[1]) if len(sys.argv) > 1 else None
    with gcodesim.open_cell(CELL, out=out) as cell:
        arm = cell.robot("arm")
        cell.tool(1).couple(arm)
        taught = []
        for place in PLACES:
            arm.move_to(place)
            taught.append(arm.joint_state.position)
            cell.draw_frame(*arm.endeffector_pose)
        begin = cell.time
        arm.follow_joints([*reversed(taught), *taught])
        off = float(np.abs(arm.joint_state.position - taught[-1]).max())
        print(f"{len(taught)} poses taught in {begin:.3f} s, played there and back in {cell.time - begin:.3f} s")
        print(f"{off:.6f} rad off the last pose")


if __name__ == "__main__":
    main()
