"""Canonical events in print: JSON in mm, degrees and per minute, and one line of text each."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from typing import Any

from gcodesim.canon import events as ev
from gcodesim.units import DEG, MINUTE, MM, RPM

_PLACES = 9  # of a mm or degree: below any machine, above the rounding of the conversion


def number(value: float) -> float | int:
    """`value` as printed: nine places, whole numbers without a fraction, no negative zero."""
    rounded = round(value, _PLACES) + 0.0
    return int(rounded) if rounded.is_integer() and abs(rounded) < 1e15 else rounded


def _axes(axes: ev.Axes) -> list[float | int]:
    return [number(v / MM) for v in axes[:3]] + [number(v / DEG) for v in axes[3:]]


def _point(point: ev.Point) -> list[float | int]:
    return [number(v / MM) for v in point]


_OF_FOUR = ("speed", "acceleration", "jerk")
_OF_ONE = ("printing", "retracting", "travel", "deviation", "corner")
_FEED_UNITS = {
    "m/s": (MINUTE / MM, "mm/min"),
    "m/rev": (1.0 / MM, "mm/rev"),
    "rad/s": (MINUTE / DEG, "deg/min"),
    "rad/rev": (1.0 / DEG, "deg/rev"),
}


def _feed(feed: float, unit: ev.FeedUnit) -> dict[str, Any]:
    factor, name = _FEED_UNITS[unit]
    return {"feed": number(feed * factor), "feed_unit": name}


def _line(event: ev.LinearFeed) -> dict[str, Any]:
    if event.pitch is not None:
        return {"end": _axes(event.end), "pitch": number(event.pitch / MM)}
    return {"end": _axes(event.end), **_feed(event.feed, event.feed_unit), **_extrude(event.extrude)}


def _extrude(length: float) -> dict[str, Any]:
    """Filament that goes along with a move; programs of mills have none."""
    return {"extrude": number(length / MM)} if length else {}


def _limits(event: ev.PlannerLimits) -> dict[str, Any]:
    limits = event.limits  # what the machine alone limits is not said
    out: dict[str, Any] = {
        name: [number(v / MM) for v in values] for name in _OF_FOUR if max(values := getattr(limits, name)) < math.inf
    }
    return out | {name: number(value / MM) for name in _OF_ONE if (value := getattr(limits, name)) < math.inf}


def _section(event: ev.SectionStart) -> dict[str, Any]:
    layer, feature, width, height = event.section
    return {"layer": layer, "feature": feature, "width": number(width / MM), "height": number(height / MM)}


def _arc(event: ev.ArcFeed) -> dict[str, Any]:
    return {
        "end": _axes(event.end),
        "center": _point(event.center),
        "normal": [number(v) for v in event.normal],
        "ccw": event.ccw,
        "turns": event.turns,
        "sweep": number(event.sweep / DEG),
        **_feed(event.feed, event.feed_unit),
        **_extrude(event.extrude),
    }


def _spline(event: ev.SplineFeed) -> dict[str, Any]:
    return {
        "end": _axes(event.end),
        "control_points": len(event.control_points),
        "points": [_point(p) for p in event.points],
        **_feed(event.feed, event.feed_unit),
    }


def _spindle(event: ev.Spindle) -> dict[str, Any]:
    if event.direction == "off":
        return {"dir": "off", "speed": 0, "unit": "rpm", "max_rpm": None}
    if event.unit == "m/s":
        cap = None if event.max_speed is None else number(event.max_speed / RPM)
        return {"dir": event.direction, "speed": number(event.speed * MINUTE), "unit": "m/min", "max_rpm": cap}
    return {"dir": event.direction, "speed": number(event.speed / RPM), "unit": "rpm", "max_rpm": None}


def _text(event: ev.Message | ev.Print | ev.Log) -> dict[str, Any]:
    return {"text": event.text}


def _nothing(_: ev.Event) -> dict[str, Any]:
    return {}


_KINDS: dict[type[ev.Event], tuple[str, Callable[[Any], dict[str, Any]]]] = {
    ev.Rapid: ("rapid", lambda e: {"end": _axes(e.end)}),
    ev.LinearFeed: ("line", _line),
    ev.ArcFeed: ("arc", _arc),
    ev.SplineFeed: ("spline", _spline),
    ev.ProbeMove: ("probe", lambda e: {"end": _axes(e.end), **_feed(e.feed, e.feed_unit)}),
    ev.Tap: ("tap", lambda e: {"end": _axes(e.end), "pitch": number(e.pitch / MM)}),
    ev.Dwell: ("dwell", lambda e: {"seconds": number(e.seconds)}),
    ev.Extrude: (
        "extrude",
        lambda e: {
            "length": number(e.length / MM),
            "feed": number(e.feed * MINUTE / MM),
            "by_firmware": e.by_firmware,
        },
    ),
    ev.PlannerLimits: ("planner_limits", _limits),
    ev.SectionStart: ("section", _section),
    ev.ToolSelect: ("tool_select", lambda e: {"tool": e.tool}),
    ev.ToolChange: ("tool_change", lambda e: {"tool": e.tool}),
    ev.ToolNumber: ("tool_number", lambda e: {"tool": e.tool}),
    ev.ToolOffset: ("tool_offset", lambda e: {"offset": _axes(e.offset)}),
    ev.PointControl: ("point_control", lambda e: {"on": e.on, "at": _axes(e.at)}),
    ev.Spindle: ("spindle", _spindle),
    ev.Coolant: ("coolant", lambda e: {"flood": e.flood, "mist": e.mist}),
    ev.PathMode: (
        "path_mode",
        lambda e: {"mode": e.mode, "tolerance": number(e.tolerance / MM), "naive": number(e.naive / MM)},
    ),
    ev.Override: (
        "override",
        lambda e: {"feed": e.feed, "speed": e.speed, "adaptive": e.adaptive, "hold": e.hold},
    ),
    ev.WorkSystem: (
        "work_system",
        lambda e: {
            "index": e.index,
            "offset": _axes(e.offset),
            "g92": _axes(e.g92),
            "rotation": number(e.rotation / DEG),
            **({} if e.axes is None else {"axes": [[number(v) for v in row] for row in e.axes]}),
        },
    ),
    ev.Orient: ("orient", lambda e: {"angle": number(e.angle / DEG), "direction": e.direction}),
    ev.Output: (
        "output",
        lambda e: {"type": e.type, "index": e.index, "value": number(e.value), "with_motion": e.with_motion},
    ),
    ev.Input: (
        "input",
        lambda e: {"type": e.type, "index": e.index, "wait": e.wait, "timeout": number(e.timeout)},
    ),
    ev.Action: (
        "action",
        lambda e: {
            "m": e.m,
            "p": None if e.p is None else number(e.p),
            "q": None if e.q is None else number(e.q),
            "target": e.target,
            "verb": e.verb,
        },
    ),
    ev.Message: ("message", _text),
    ev.Print: ("print", _text),
    ev.Log: ("log", _text),
    ev.Stop: ("stop", _nothing),
    ev.OptionalStop: ("optional_stop", _nothing),
    ev.PalletShuttle: ("pallet_shuttle", _nothing),
    ev.End: ("end", _nothing),
    ev.EndOfFile: ("eof", _nothing),
}


def as_json(event: ev.Event) -> dict[str, Any]:
    """One event as `gcodesim canon --format json` prints it."""
    kind, fields = _KINDS[type(event)]
    out: dict[str, Any] = {"kind": kind, **fields(event)}
    if event.span.line:
        out["line"] = event.span.line
    return out


def listing(events: Iterable[ev.Event], error: tuple[str, int | None] | None = None) -> dict[str, Any]:
    """The object that `gcodesim canon --format json` prints; `error` is message and source line."""
    return {
        "status": "ok" if error is None else "error",
        "error": None if error is None else {"message": error[0], "line": error[1]},
        "events": [as_json(event) for event in events],
    }


_COORDINATES = "XYZABC"


def as_text(event: ev.Event) -> str:
    """One event as one line: source line, kind, fields."""
    fields = as_json(event)
    line = fields.pop("line", "")
    kind = fields.pop("kind")
    return f"{line:>6}  {kind:<14}" + " ".join(_field(name, value) for name, value in fields.items()).rstrip()


def _field(name: str, value: Any) -> str:
    if name in ("end", "at", "offset", "g92"):
        shown = " ".join(f"{axis}{v}" for axis, v in zip(_COORDINATES, value, strict=True) if v or axis in "XYZ")
        return shown if name in ("end", "at") else f"{name}=({shown})"
    if name == "points":
        return f"points={len(value)}"
    if isinstance(value, list):
        return f"{name}=({', '.join(str(v) for v in value)})"
    if isinstance(value, bool):
        return f"{name}={'yes' if value else 'no'}"
    if name == "text":
        return str(value)
    return f"{name}={'none' if value is None else value}"
