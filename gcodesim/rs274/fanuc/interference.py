"""The interference check of cutter compensation, over the blocks that the control reads ahead.

Between two corners `i` and `j` of the program, at most N - 2 moves apart where the
control reads N blocks, the tool has to go the way that the program goes:

    (P_j - P_i) (V_j - V_i) >= 0

P are the corners as programmed, V where the tool passes them; the angle is from 90
to 270 deg where the product is negative, and the control stops with alarm PS0041.
Of one move alone `compensation.flush` knows it already; over more of them it is a
place that is narrower than the tool between moves that are long enough by themselves.
"""

from __future__ import annotations

from gcodesim.rs274.circles import Point, apart
from gcodesim.rs274.compensation import is_on
from gcodesim.rs274.fanuc.control import FanucControl
from gcodesim.rs274.fault import Fault
from gcodesim.units import MM

_SLACK = 1e-9  # of the squared radius


def check(control: FanucControl, corner: Point, before: Point | None, reached: Point | None) -> None:
    """Compare a corner that the tool has passed with those before it; Fault GS152.

    `before` is where the move to it began, None where that move started the compensation, and `reached` where it ended.
    """
    state = control.state
    if not is_on(control) or state.comp_endpoint is None or reached is None:
        return
    if before is None:
        state.comp_corners = ()
    for programmed, passed in state.comp_corners[:-1]:  # the last one bounds one move alone
        way = corner[0] - programmed[0], corner[1] - programmed[1]
        gone = reached[0] - passed[0], reached[1] - passed[1]
        if way[0] * gone[0] + way[1] * gone[1] < -_SLACK * state.comp_radius * state.comp_radius:
            unit_mm = state.unit / MM
            width, diameter = apart(programmed, corner) * unit_mm, 2.0 * state.comp_radius * unit_mm
            raise Fault(
                "GS152",
                f"the contour is {width:.3f} mm wide here; the tool, diameter {diameter:.3f} mm, does not fit in",
                hint="use a smaller tool; the control sees it among the blocks that it reads ahead (alarm PS0041)",
                value=diameter,
                limit=width,
                unit="mm",
            )
    state.comp_corners = (*state.comp_corners, (corner, state.comp_endpoint))[-(control.blocks_ahead - 2) :]


__all__ = ["check"]
