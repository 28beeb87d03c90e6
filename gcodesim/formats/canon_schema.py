"""The canonical listing as JSON Schema: one record for each kind of event."""

from __future__ import annotations

from typing import Final

from gcodesim.declarations.kind import Json
from gcodesim.formats.json_schema import array, choice, nullable, number, optional, record, text, truth, whole

_AXES: Final = array("X Y Z [mm], A B C [deg], machine coordinates", {"type": "number"}) | {
    "minItems": 6,
    "maxItems": 6,
}
_POINT: Final = array("X Y Z [mm]", {"type": "number"}) | {"minItems": 3, "maxItems": 3}
_FEED: Final = {
    "feed": number("in `feed_unit`"),
    "feed_unit": choice("per minute, or per revolution of the spindle", "mm/min", "mm/rev", "deg/min", "deg/rev"),
}
_FOUR: Final = array("X Y Z E, mm and s", {"type": "number"}) | {"minItems": 4, "maxItems": 4}
_PITCH: Final = {"pitch": number("mm a revolution of the spindle")}
_TOOL: Final = {"tool": whole("T number; 0: none", least=-1)}
_EXTRUDE: Final = {"extrude": number("mm of filament; drawn back where negative")}
_ARC: Final = {
    "end": _AXES,
    "center": _POINT,
    "normal": array("of the plane", {"type": "number"}) | {"minItems": 3, "maxItems": 3},
    "ccw": truth("seen against the normal"),
    "turns": whole("full turns besides"),
    "sweep": number("deg"),
    **_FEED,
}
_TEXT: Final = {"text": text("what is shown")}

EVENTS: Final[dict[str, list[dict[str, Json]]]] = {
    "rapid": [{"end": _AXES}],
    "line": [{"end": _AXES, **_FEED}, {"end": _AXES, **_FEED, **_EXTRUDE}, {"end": _AXES, **_PITCH}],
    "arc": [_ARC, {**_ARC, **_EXTRUDE}],
    "spline": [
        {
            "end": _AXES,
            "control_points": whole("how many"),
            "points": array("on the curve", _POINT),
            **_FEED,
        }
    ],
    "probe": [{"end": _AXES, **_FEED}],
    "tap": [{"end": _AXES, **_PITCH}],
    "extrude": [
        {"length": number("mm of filament alone"), "feed": number("mm/min"), "by_firmware": truth("G10 or G11")}
    ],
    "planner_limits": [
        {
            "speed": _FOUR,
            "acceleration": _FOUR,
            "jerk": _FOUR,
            "printing": number("mm/s² of moves that extrude"),
            "retracting": number("mm/s² of filament alone"),
            "travel": number("mm/s² of other moves"),
            "deviation": number("mm, junction deviation; 0: jerk counts"),
            "corner": number("mm/s through a right angle; 0: jerk or deviation counts"),
        }
    ],
    "section": [
        {
            "layer": whole("from 1; 0: before the first", least=0),
            "feature": text("as the slicer calls it"),
            "width": number("mm of the bead; 0: unsaid"),
            "height": number("mm of the bead; 0: unsaid"),
        }
    ],
    "dwell": [{"seconds": number("s")}],
    "tool_select": [_TOOL],
    "tool_change": [_TOOL],
    "tool_number": [_TOOL],
    "tool_offset": [{"offset": _AXES}],
    "point_control": [{"on": truth("moves are those of the tip in the work"), "at": _AXES}],
    "spindle": [
        {
            "dir": choice("direction", "off", "cw", "ccw"),
            "speed": number("in `unit`"),
            "unit": choice("m/min: constant surface speed", "rpm", "m/min"),
            "max_rpm": nullable(number("cap of constant surface speed")),
        }
    ],
    "coolant": [{"flood": truth("M8"), "mist": truth("M7")}],
    "path_mode": [
        {
            "mode": choice("how corners are taken", "exact_stop", "exact_path", "blend"),
            "tolerance": number("mm"),
            "naive": number("mm"),
        }
    ],
    "override": [{name: truth("whether it is allowed") for name in ("feed", "speed", "adaptive", "hold")}],
    "work_system": [
        {"index": whole("1 is G54", least=0), "offset": _AXES, "g92": _AXES, "rotation": number("deg")},
        {
            "index": whole("1 is G54", least=0),
            "offset": _AXES,
            "g92": _AXES,
            "rotation": number("deg"),
            "axes": array("rows of the rotation of a system that leans", _POINT),
        },
    ],
    "orient": [{"angle": number("deg"), "direction": whole("0 nearest, 1 clockwise, 2 counterclockwise")}],
    "output": [
        {
            "type": choice("which kind of output", "digital", "analog"),
            "index": whole("number of the output"),
            "value": number("0, 1 or a level"),
            "with_motion": truth("with the next move"),
        }
    ],
    "input": [
        {
            "type": choice("which kind of input", "digital", "analog"),
            "index": whole("number of the input"),
            "wait": choice("for what M66 waits", "immediate", "rise", "fall", "high", "low"),
            "timeout": number("s"),
        }
    ],
    "action": [
        {
            "m": whole("M number"),
            "p": nullable(number("P word")),
            "q": nullable(number("Q word")),
            "target": text("what the cell maps it to"),
            "verb": text("what it does"),
        }
    ],
    "message": [_TEXT],
    "print": [_TEXT],
    "log": [_TEXT],
    "stop": [{}],
    "optional_stop": [{}],
    "pallet_shuttle": [{}],
    "end": [{}],
    "eof": [{}],
}


def canon(finding: Json) -> Json:
    """The whole listing; `finding` describes one finding."""
    forms = [_event(kind, form) for kind, forms in EVENTS.items() for form in forms]
    return record(
        "what a program tells the machine",
        status=choice("`error`: reading stopped early", "ok", "error"),
        error=nullable(record("why reading stopped", message=text("what"), line=nullable(whole("where")))),
        events=array("up to the end or the first error", {"anyOf": forms}),
        findings=array("all findings", finding),
    )


def _event(kind: str, members: dict[str, Json]) -> Json:
    return record(kind, kind={"const": kind}, **members, line=optional(whole("line of the program", least=1)))
