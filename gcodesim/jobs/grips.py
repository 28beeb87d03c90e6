"""What grips have shown to be wrong, and what became of the parts: findings and results."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Final

from gcodesim.diagnostics import Diagnostic, Span
from gcodesim.executor.part_run import SET_DOWN, PartEnd
from gcodesim.numbers import rounded
from gcodesim.processes.gripping import GripEvent
from gcodesim.tools.gripper import Gripper
from gcodesim.units import DEG, MM

BY_MOTION: Final = frozenset(("lost", "reserve"))
"""Events that the motion of a row is to blame for, and not the word that switched the gripper before it."""


def grip_finding(event: GripEvent, tool: Gripper | None, span: Span, time: float, *, freely: bool) -> Diagnostic | None:
    """The finding of an event; None if all is well. `freely`: parts fall as free bodies, not straight down by rule."""
    name = "the gripper" if tool is None else tool.name
    each = " at each finger" if tool is not None and tool.widest else ""
    part = event.part.rpartition("/")[2]
    match event.kind:
        case "lost":
            return Diagnostic(
                code="GS560",
                message=f"{name} loses `{part}`: it needs {event.needs:.3g} N, has {event.has:.3g} N{each}; "
                f"{_fall(event, freely=freely)}",
                span=span,
                hint="accelerate less, press harder, or use a gripper with more friction",
                time=time,
                value=event.needs,
                limit=event.has,
                unit="N",
            )
        case "nothing":
            return Diagnostic(
                code="GS561",
                message=f"{name} closes, and no part is there",
                span=span,
                hint="look at the places of `parts:` and of the tip at this line; it may have been lost before",
                time=time,
            )
        case "wide":
            return Diagnostic(
                code="GS562",
                message=f"`{part}` is {event.needs / MM:.4g} mm wide about the tip; {name} opens "
                f"{event.has / MM:.4g} mm",
                span=span,
                hint="grip it where it is narrower, nearer to its middle, or with a gripper of more `stroke`",
                time=time,
                value=event.needs / MM,
                limit=event.has / MM,
                unit="mm",
            )
        case "held":
            return Diagnostic(
                code="GS563",
                message=f"{name} closes on `{part}`, which {event.other} holds",
                span=span,
                hint="let the other gripper open first; wait for it with `m_codes: {M200: {wait: NAME}}`",
                time=time,
            )
        case "released" if event.height > SET_DOWN:
            return Diagnostic(
                code="GS564",
                message=f"{name} lets `{part}` go above its place; {_fall(event, freely=freely)}",
                span=span,
                hint="go down until it stands on something before the gripper opens",
                time=time,
                value=event.height / MM,
                limit=SET_DOWN / MM,
                unit="mm",
            )
        case "reserve":
            assert tool is not None
            return Diagnostic(
                code="GS565",
                message=f"{name} holds `{part}` with a reserve of {event.has / event.needs:.3g}; "
                f"{tool.safety:.3g} is asked for: it needs {event.needs:.3g} N, has {event.has:.3g} N{each}",
                span=span,
                hint="accelerate less, press harder, or change `safety` of the gripper",
                time=time,
                value=event.has / event.needs,
                limit=tool.safety,
                unit="",
            )
    return None


def _fall(event: GripEvent, *, freely: bool) -> str:
    onto = f"`{event.support}`" if event.support else "the floor"
    if event.height <= SET_DOWN:
        return f"it stays on {onto}"
    way = f"{event.height / MM:.4g} mm"
    return f"it falls {way} and comes to rest on {onto}" if freely else f"it falls {way} onto {onto}, straight down"


def held_at_end(ends: Mapping[str, PartEnd], labels: Mapping[str, str], span: Span) -> list[Diagnostic]:
    """GS566 for each part that a gripper holds when its program ends."""
    return [
        Diagnostic(code="GS566", message=f"the program ends while {end.holder} holds `{labels[name]}`", span=span)
        for name, end in ends.items()
        if end.holder
    ]


def part_results(ends: Mapping[str, PartEnd], label: Callable[[str], str]) -> dict[str, dict[str, Any]]:
    """The entry `parts` of `results.json`."""
    found = {}
    for name, end in ends.items():
        x, y, z = (rounded(float(v) / MM) for v in end.X_W.p)
        found[label(name)] = {
            "x_mm": x,
            "y_mm": y,
            "z_mm": z,
            "quaternion_xyzw": [rounded(float(v)) for v in end.X_W.q],
            "held_by": end.holder or None,
            "on": None if end.holder else label(end.support) or None,
            "above_mm": None if end.holder else rounded(max(end.height, 0.0) / MM),
            "moved_mm": rounded(end.moved / MM),
            "grips": end.grips,
            "falls": end.falls,
            "pose_error_mm": None if end.error is None else rounded(end.error / MM, 9),
            "pose_error_deg": None if end.turn is None else rounded(end.turn / DEG, 9),
            "error_from": None if end.error is None else "goal" if end.to_goal else "release",
        }
    return found
