"""Named parameters that every program may read: #<_x>, #<_feed>, #<_metric> …"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from gcodesim.rs274.control import Control

Ask = Callable[["Control"], float]


def _position(axis: int) -> Ask:
    return lambda control: control.state.current[axis]


def _machine_position(axis: int) -> Ask:
    return lambda control: control.axes()[axis]


def _flag(test: Callable[[Control], bool]) -> Ask:
    return lambda control: float(test(control))


_SYSTEMS = (540.0, 550.0, 560.0, 570.0, 580.0, 590.0, 591.0, 592.0, 593.0)

PREDEFINED: dict[str, Ask] = {
    **{f"_{letter}": _position(axis) for axis, letter in enumerate("xyzabcuvw")},
    **{f"_abs_{letter}": _machine_position(axis) for axis, letter in enumerate("xyzabc")},
    "_metric_machine": lambda control: 1.0,
    "_vmajor": lambda control: 2.9,
    "_vminor": lambda control: 0.0,
    "_line": lambda control: float(control.span.line),
    "_motion_mode": lambda control: float(control.state.motion if control.state.motion >= 0 else 800),
    "_plane": lambda control: float(control.state.plane),
    "_ccomp": lambda control: {0: 400.0, 1: 410.0, -1: 420.0}[control.state.side],
    "_metric": _flag(lambda control: control.state.unit == 1e-3),
    "_imperial": _flag(lambda control: control.state.unit != 1e-3),
    "_absolute": _flag(lambda control: not control.state.incremental),
    "_incremental": _flag(lambda control: control.state.incremental),
    "_inverse_time": _flag(lambda control: control.state.feed_mode == 930),
    "_units_per_minute": _flag(lambda control: control.state.feed_mode == 940),
    "_units_per_rev": _flag(lambda control: control.state.feed_mode == 950),
    "_coord_system": lambda control: _SYSTEMS[control.state.system - 1],
    "_tool_offset": _flag(lambda control: any(control.state.tool_offset)),
    "_retract_r_plane": _flag(lambda control: control.state.retract == 990),
    "_retract_old_z": _flag(lambda control: control.state.retract == 980),
    "_spindle_rpm_mode": _flag(lambda control: not control.state.surface_speed),
    "_spindle_css_mode": _flag(lambda control: control.state.surface_speed),
    "_ijk_absolute_mode": _flag(lambda control: control.state.centre_absolute),
    "_lathe_diameter_mode": _flag(lambda control: control.state.diameter),
    "_lathe_radius_mode": _flag(lambda control: not control.state.diameter),
    "_spindle_on": _flag(lambda control: control.state.spindle != 0),
    "_spindle_cw": _flag(lambda control: control.state.spindle > 0),
    "_mist": _flag(lambda control: control.state.mist),
    "_flood": _flag(lambda control: control.state.flood),
    "_speed_override": _flag(lambda control: control.state.speed_override),
    "_feed_override": _flag(lambda control: control.state.feed_override),
    "_adaptive_feed": _flag(lambda control: control.state.adaptive_feed),
    "_feed_hold": _flag(lambda control: control.state.feed_hold),
    "_feed": lambda control: control.state.feed,
    "_rpm": lambda control: control.state.speed,
    "_current_tool": lambda control: float(control.state.tool),
    "_selected_tool": lambda control: float(max(control.state.selected, 0)),
    "_current_pocket": lambda control: float(control.spindle_tool.pocket),
    "_selected_pocket": lambda control: float(control.state.selected),
    "_value": lambda control: control.returned,
    "_value_returned": _flag(lambda control: control.value_returned),
    "_call_level": lambda control: float(control.sub_level),
    "_remap_level": lambda control: 0.0,
    "_task": lambda control: 0.0,
}
