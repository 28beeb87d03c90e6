"""How the tool is held: along an axis, as words of the program say, or on the normal of a surface."""

from __future__ import annotations

import re
from typing import Any, Final

from gcodesim.canon.systems import system_name
from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import POSITIVE, Json, Kind, Range, scalar, short
from gcodesim.declarations.nodes import Node
from gcodesim.declarations.quantity import Quantity
from gcodesim.declarations.reading import UNREAD, Path, Reading, Reference, Unread
from gcodesim.declarations.scalars import measured
from gcodesim.frozen import frozen
from gcodesim.kinematics.attitude import WordTurn
from gcodesim.units import DEG

_AXIS: Final = re.compile(r"\s*([+-]?)\s*([XYZxyz])(?:\s+of\s+(\S+))?\s*")
_TURN: Final = re.compile(r"([XYZxyz])\s*\(\s*([+-]?)\s*([ABCabc])\s*\)")
_TURNS: Final = re.compile(r"(\s*[XYZxyz]\s*\(\s*[+-]?\s*[ABCabc]\s*\)){1,3}\s*")
_NORMAL: Final = re.compile(r"\s*normal\s+of\s+(\S+)\s*")
_DOWN: Final = (0.0, 0.0, -1.0)
_LEANS: Final = Range(above=-80.0 * DEG, below=80.0 * DEG)


@frozen(kw_only=False)
class _AxisOf(Kind):
    """`-Z of G54`, or `normal of plate`."""

    @property
    def expected(self) -> str:
        return "an axis of a frame such as `-Z of G54`, or `normal of` a stock, part, fixture or the `target`"

    def read(self, node: Node, to: Reading, path: Path) -> ToolAxis | Unread:
        text = scalar(self, node, to, path)
        if isinstance(text, Unread):
            return UNREAD
        if (surface := _NORMAL.fullmatch(text.text)) is not None:
            return ToolAxis(axis=_DOWN, frame=None, surface=surface[1])
        match = _AXIS.fullmatch(text.text)
        if match is None:
            return to.fault("GS711", text.span, f"`{path[-1]}` is `{short(text.text)}`; {self.expected} is expected")
        sign = -1.0 if match[1] == "-" else 1.0
        axis = tuple(sign if match[2].upper() == letter else 0.0 for letter in "XYZ")
        frame = None if match[3] is None else system_name(match[3]) or match[3]
        if frame is not None:
            to.references.append(Reference(what="frame", name=frame, path=path))
        return ToolAxis(axis=(axis[0], axis[1], axis[2]), frame=frame)

    def schema(self, definitions: dict[str, Json]) -> Json:
        either = rf"^({_AXIS.pattern}|{_NORMAL.pattern})$"
        return {"type": "string", "pattern": either, "examples": ["-Z of G54", "normal of plate"]}

    def show(self, value: Any) -> Any:
        if value.surface is not None:
            return f"normal of {value.surface}"
        index = next(i for i, part in enumerate(value.axis) if part)
        return f"{'-' if value.axis[index] < 0 else ''}{'XYZ'[index]}" + (f" of {value.frame}" if value.frame else "")

    def plain(self, value: Any) -> tuple[str, Any]:
        return "", self.show(value)


@frozen
class ToolAxis:
    """The direction of T's Z: unit vector `axis` in `frame`; None is the work system in force.

    With the name of a `surface` it is into the surface along its normal, and `axis` away from it.
    """

    axis: tuple[float, float, float]
    frame: str | None
    surface: str | None = None


@frozen(kw_only=False)
class _Spin(Kind):
    """`free`, or an angle."""

    @property
    def expected(self) -> str:
        return "`free` or an angle"

    def read(self, node: Node, to: Reading, path: Path) -> float | Unread | None:
        text = scalar(self, node, to, path)
        if isinstance(text, Unread):
            return UNREAD
        if text.text == "free":
            return None
        if measured(text.text) is None:
            return to.fault("GS711", text.span, f"`spin` is `{short(text.text)}`; {self.expected} is expected")
        return Quantity("angle").read(node, to, path)

    def schema(self, definitions: dict[str, Json]) -> Json:
        return {"anyOf": [{"const": "free"}, Quantity("angle").schema(definitions)]}

    def show(self, value: Any) -> Any:
        return Quantity("angle").show(value)

    def plain(self, value: Any) -> tuple[str, Any]:
        return Quantity("angle").plain(value)


@frozen(kw_only=False)
class _Words(Kind):
    """`Z(A) Y(B) X(C)`."""

    @property
    def expected(self) -> str:
        return "turns such as `Z(A) Y(B) X(C)`: an axis and, in brackets, the word A, B or C that turns about it"

    def read(self, node: Node, to: Reading, path: Path) -> tuple[WordTurn, ...] | Unread:
        text = scalar(self, node, to, path)
        if isinstance(text, Unread):
            return UNREAD
        if _TURNS.fullmatch(text.text) is None:
            return to.fault("GS711", text.span, f"`{path[-1]}` is `{short(text.text)}`; {self.expected} is expected")
        found = _TURN.findall(text.text.upper())
        words = [word for _, _, word in found]
        if len(set(words)) < len(words):
            return to.fault("GS711", text.span, f"`{path[-1]}` turns twice by one word", "each of A, B, C at most once")
        return tuple(
            WordTurn("XYZ".index(axis), "ABC".index(word), -1.0 if sign == "-" else 1.0) for axis, sign, word in found
        )

    def schema(self, definitions: dict[str, Json]) -> Json:
        return {"type": "string", "pattern": f"^{_TURNS.pattern}$", "examples": ["Z(A) Y(B) X(C)", "Z(-C) X(-A)"]}

    def show(self, value: Any) -> Any:
        return " ".join(f"{'XYZ'[t.axis]}({'-' if t.sign < 0.0 else ''}{'ABC'[t.word]})" for t in value)

    def plain(self, value: Any) -> tuple[str, Any]:
        return "", self.show(value)


@frozen
class Orientation:
    """How an arm holds the tool. `spin` None: free, chosen near the previous joints, or 0 with three `words`.

    That it stands on the normal of a surface is for machines with rotary axes too.
    """

    tool_axis: ToolAxis = key(
        _AxisOf(), "direction of the tool's Z, from holder to tip", default=ToolAxis(axis=_DOWN, frame=None)
    )
    spin: float | None = key(_Spin(), "angle about the tool axis, or `free`", default=None)
    words: tuple[WordTurn, ...] | None = key(
        _Words(),
        "how A, B and C lean the tool: turns from the work system on, each about an axis that those before have turned",
        default=None,
        quiet=True,
        example="Z(A) Y(B) X(C)",
    )
    lead: float = key(
        Quantity("angle", _LEANS),
        "on the normal of a surface: the holder leans so far along the feed",
        default=0.0,
        quiet=True,
        example="10 deg",
    )
    tilt: float = key(
        Quantity("angle", _LEANS),
        "on the normal of a surface: the holder leans so far to the right",
        default=0.0,
        quiet=True,
        example="10 deg",
    )
    smooth: float = key(
        Quantity("length", POSITIVE),
        "on the normal of a surface: the way over which the tool turns at an edge, to both sides (default: 2 mm)",
        default=2e-3,
        quiet=True,
        example="2 mm",
    )
    within: float = key(
        Quantity("length", POSITIVE),
        "on the normal of a surface: how far from it feeds may be (default: 20 mm)",
        default=20e-3,
        quiet=True,
        example="20 mm",
    )

    def checked(self, to: Reading, path: Path) -> Orientation | Unread:
        if self.tool_axis.surface is None:
            usual = Orientation()
            for name in ("lead", "tilt", "smooth", "within"):
                if getattr(self, name) != getattr(usual, name):
                    hint = "write `tool_axis: normal of` with a stock, part, fixture or the `target`"
                    to.fault("GS719", to.key((*path, name)), f"`{name}` is for a tool axis from a surface", hint)
        elif self.words is not None:
            message = "A, B and C cannot lean the tool that a surface holds"
            to.fault("GS719", to.key((*path, "words")), message, "leave one of `words` and `normal of` out")
            return UNREAD
        return self
