"""The chisel edge of a drill: across the web at the point its rake is so negative that it pushes more than it cuts.

Factors by the length c of that edge over the diameter d: Oberg, Jones, Horton and Ryffel, Machinery's Handbook, 31st
ed. 2020, "Machining Power", table 7, after Shaw and Oxford 1957. With lips that reach the axis a drill would bear the
torque M and the thrust T; with a chisel edge it is A M, and B T + J K d², where K is the constant of the material.
"""

from __future__ import annotations

from typing import Final

import numpy as np

USUAL: Final = 0.18
"""c / d of drills of standard design; of a split point it is 0.03."""

LONGEST: Final = 0.4
"""c / d up to which the factors are known."""

_SHARE: Final = (0.0, 0.03, 0.05, 0.08, 0.10, 0.13, 0.15, 0.18, 0.20, 0.25, 0.30, 0.35, 0.40)
_THRUST: Final = (1.0, 1.100, 1.140, 1.200, 1.235, 1.270, 1.310, 1.355, 1.380, 1.445, 1.500, 1.575, 1.620)
_PUSH: Final = (0.0, 0.001, 0.003, 0.006, 0.010, 0.017, 0.022, 0.030, 0.040, 0.065, 0.090, 0.120, 0.160)


def weight_of_chisel(share: float) -> float:
    """How many times the thrust of a lip of its length a chisel edge of c / d = `share` bears: thrust is B T in all.

    With it the torque is within 2 % of A M up to c / d = 0.2, and 11 % below at 0.4.
    """
    whole = float(np.interp(share, _SHARE, _THRUST))
    return (whole - (1.0 - share)) / share


def push_factor(share: float) -> float:
    """J: how hard a chisel edge of c / d = `share` is pressed in, however thin the chip, over K d²."""
    return float(np.interp(share, _SHARE, _PUSH))
