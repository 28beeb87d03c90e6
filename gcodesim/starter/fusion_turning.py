"""Turning tools of Fusion's libraries: inserts and holders as keys of a lathe's tools.

Fusion names a size as ISO 13399 does: INSD the inscribed circle, RE the nose, EPSR the angle of the tip.
"""

from __future__ import annotations

from typing import Final

from gcodesim.arithmetic.scalars import cos_sin
from gcodesim.starter.tool_keys import Json, ReadTool, ToolKeys, number_of
from gcodesim.tools.lathe_insert import LEAD_ANGLES, TIP_ANGLES
from gcodesim.units import DEG

TURNING: Final = {
    "turning general": "turning_tool",
    "turning boring": "boring_tool",
    "turning grooving": "grooving_tool",
    "turning parting": "grooving_tool",
    "turning threading": "threading_tool",
}
"""Kinds of tools by Fusion's word for them."""

_ORIENTATIONS: Final = {
    ("turning_tool", "R"): 2,
    ("turning_tool", "L"): 1,
    ("turning_tool", "N"): 6,
    ("boring_tool", "R"): 3,
    ("boring_tool", "L"): 4,
    ("boring_tool", "N"): 8,
}
"""Where the nose is, by the hand of the holder, for tools behind the axis."""

_EDGES: Final = {"T": 1.7321, "W": 0.684, "S": 1.0, "R": None}
"""Edge length in inscribed circles, of triangles, trigons and squares; of a rhomb it is 1 / sin of its tip."""

_READ: Final = frozenset(
    ("SC", "RE", "INSD", "EPSR", "CW", "tool_insertWidth", "tool_grooveWidth", "tool_internalThread", "TC", "SCTY", "S",
     "thread-profile-angle", "thread-tip-width", "OAL", "LH", "RA", "SIZE_SPECIFICATION_MODE", "TP", "TPN", "TPX")
)  # fmt: skip
"""What is used, and what says nothing of the shape that cuts."""


def turning_tool(number: int, name: str, keys: ToolKeys, geometry: Json, holder: Json) -> ReadTool:
    """The tool with these `geometry` and `holder`; `keys` have its kind, one of `TURNING`, and its name."""
    kind = keys.found["type"]
    style = str(holder.get("THSC", "")).strip()
    inside = (
        any(mark in style.lower() for mark in ("boring", "internal")) or geometry.get("tool_internalThread") is True
    )
    needs: tuple[str, ...] = ()
    if kind in ("turning_tool", "boring_tool"):
        needs = _insert(kind, style, keys, geometry, holder)
    elif kind == "grooving_tool":
        widths = (number_of(geometry.get(key)) for key in ("tool_insertWidth", "CW", "tool_grooveWidth"))
        keys.length("width", next((width for width in widths if width), None))
        keys.found["side"] = "inside" if inside else "face" if "face" in style.lower() else "outside"
        keys.notes.append("approximated: its left corner is taken for the one that is driven")
        needs = ("width",)
    else:
        angles = (number_of(geometry.get(key)) for key in ("thread-profile-angle", "EPSR"))
        keys.angle("angle", next((angle for angle in angles if angle), None))
        keys.length("flat", number_of(geometry.get("thread-tip-width")))
        keys.found["side"] = "inside" if inside else "outside"
    ignored = sorted(key for key in geometry if key not in _READ)
    if ignored:
        keys.notes.append(f"not used: {', '.join(f'`{key}`' for key in ignored)}")
    return keys.tool(number, name, needs)


def _insert(kind: str, style: str, keys: ToolKeys, geometry: Json, holder: Json) -> tuple[str, ...]:
    """Nose, edges and shank of a tool with an insert; the keys that it needs."""
    shape = str(geometry.get("SC", "")).strip().upper()
    hand = str(holder.get("HAND", "R")).strip().upper()[:1]
    circle = number_of(geometry.get("INSD"))
    keys.found["orientation"] = str(_ORIENTATIONS.get((kind, hand), _ORIENTATIONS[kind, "R"]))
    keys.length("width", number_of(holder.get("W")))
    if shape == "R":
        keys.length("nose_radius", None if circle is None else 0.5 * circle)
        keys.angle("tip_angle", 0.0)
        return ("nose_radius",)
    keys.length("nose_radius", number_of(geometry.get("RE")))
    tip = number_of(geometry.get("EPSR")) or TIP_ANGLES.get(shape)
    keys.angle("tip_angle", tip)
    if tip is not None and circle is not None:
        ratio = _EDGES.get(shape, 1.0 / cos_sin(tip * DEG)[1])
        keys.length("edge", None if ratio is None else ratio * circle)
    if shape in LEAD_ANGLES:
        keys.angle("lead_angle", LEAD_ANGLES[shape])
        keys.notes.append(
            f"approximated: its holder{f' `{style}`' if style else ''} is taken for the usual one of such inserts"
        )
    return ("tip_angle",)
