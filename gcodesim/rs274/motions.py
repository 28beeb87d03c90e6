"""Motion codes: G0, G1 and arcs here, the others in files of their own."""

from __future__ import annotations

from collections.abc import Callable

from gcodesim.rs274 import compensation
from gcodesim.rs274.arcs import arc
from gcodesim.rs274.control import Control
from gcodesim.rs274.cycles import cycle
from gcodesim.rs274.ends import end_point
from gcodesim.rs274.feeds import check_feed, resolve_inverse_time, straight_length
from gcodesim.rs274.lathe_contours import contour_cycle
from gcodesim.rs274.probing import probe
from gcodesim.rs274.splines import cubic_spline, nurbs_start, quadratic_spline
from gcodesim.rs274.threads import rigid_tap, thread, thread_cycle
from gcodesim.rs274.words import Words

MotionCode = Callable[[Words, Control, int], None]


def straight(words: Words, control: Control, code: int) -> None:
    """G0 and G1."""
    if code == 10:
        check_feed(words, control, "G1")
    leaving, control.state.comp_leaving = control.state.comp_leaving, False
    on = compensation.is_on(control)
    if not words.has_axes() and not on and not leaving:
        return
    end = end_point(words, control)
    if on:
        compensation.straight(words, control, end, rapid=code == 0)
        return
    if code == 10 and control.state.feed_mode == 930:
        resolve_inverse_time(words, control, straight_length(control.state.current, end))
    control.state.comp_leaving = leaving  # the move starts beside the current point
    if code == 0:
        control.rapid(end)
    else:
        control.line(end)
    control.state.comp_leaving = False


def _end_cycles(_: Words, control: Control, code: int) -> None:
    """G80."""
    del code
    control.state.cycle = -1


def _ending_cycles(motion: MotionCode) -> MotionCode:
    """Any motion but a cycle ends the chain of cycles."""

    def act(words: Words, control: Control, code: int) -> None:
        motion(words, control, code)
        control.state.cycle = -1

    return act


MOTIONS: dict[int, MotionCode] = {
    0: _ending_cycles(straight),
    10: _ending_cycles(straight),
    20: _ending_cycles(arc),
    30: _ending_cycles(arc),
    50: _ending_cycles(cubic_spline),
    51: _ending_cycles(quadratic_spline),
    52: _ending_cycles(nurbs_start),
    330: _ending_cycles(thread),
    331: _ending_cycles(rigid_tap),
    382: _ending_cycles(probe),
    383: _ending_cycles(probe),
    384: _ending_cycles(probe),
    385: _ending_cycles(probe),
    730: cycle,
    740: cycle,
    760: _ending_cycles(thread_cycle),
    **dict.fromkeys((700, 710, 711, 712, 720, 721, 722), _ending_cycles(contour_cycle)),
    800: _end_cycles,
    **dict.fromkeys((810, 820, 830, 840, 850, 860, 870, 880, 890), cycle),
}
