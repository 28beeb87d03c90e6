"""`signals:` of a channel: which words of the program give the processes of its tools which values."""

from __future__ import annotations

import re
from typing import Any, Final, Literal

from gcodesim.canon.events import Action, Event, Output
from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import Json, Kind, key_name, scalar, short
from gcodesim.declarations.map_of import MapOf, NameRule
from gcodesim.declarations.nodes import Node
from gcodesim.declarations.reading import UNREAD, Path, Reading, Unread
from gcodesim.declarations.record import Record
from gcodesim.declarations.scalars import measured, why_no_number
from gcodesim.frozen import frozen

WordType = Literal["speed", "turning", "digital", "analog", "code"]

_WORD: Final = r"[Mm]\s*0*(\d{1,3})(?:\s*([PpEe])\s*0*(\d{1,5}))?"
_ONE: Final = re.compile(rf"\s*{_WORD}\s*", re.ASCII)
_PATTERN: Final = rf"^\s*([Ss]|{_WORD}(\s*/\s*{_WORD})?)\s*$"

# what a control does by itself: no signal can hang on it
_OF_THE_CONTROL: Final = frozenset((0, 1, 2, 6, 19, 30, *range(48, 54), 60, 61, 66, *range(70, 74), 98, 99))


@frozen
class SignalWord:
    """A word that gives a signal its value.

    `speed` is the number of S while the spindle turns, `turning` 1 while it turns; `digital` and `analog` are output
    `index` as M62 to M65, M67 and M68 set it. A `code` is an M-code: `on` (`M10`, `M62 P1`) sets 1 and `off` sets 0;
    without `off`, the code gives the number of its Q, else of its P, else 1. `text` is how it is shown.
    """

    type: WordType
    text: str
    index: int = 0
    on: str = ""
    off: str = ""

    @property
    def pin(self) -> str | None:
        """The output it follows, as `P1` or `E0`."""
        letter = {"digital": "P", "analog": "E"}.get(self.type)
        return f"{letter}{self.index}" if letter else None

    @property
    def codes(self) -> tuple[str, ...]:
        """The M-codes that mean nothing to the control without the cell."""
        return tuple(code for code in (self.on, self.off) if code)

    def number_of(self, event: Event) -> float | None:
        """What an event sets an output or a code to, as the program writes it; None if it says nothing of it.

        An M62 to M65 that the cell maps to an action sets its output as well.
        """
        if self.type == "code":
            return self._number_of_code(event)
        if isinstance(event, Output):
            return event.value if (event.type, event.index) == (self.type, self.index) else None
        if isinstance(event, Action) and self.type == "digital" and event.m in (62, 63, 64, 65):
            return float(event.m in (62, 64)) if event.p == self.index else None
        return None

    def _number_of_code(self, event: Event) -> float | None:
        if not isinstance(event, Action):
            return None
        own = {f"M{event.m}"} | ({f"M{event.m} P{event.p:g}"} if event.p is not None else set())
        if self.off:
            return 1.0 if self.on in own else 0.0 if self.off in own else None
        if self.on not in own:
            return None
        if event.q is not None:
            return event.q
        return event.p if event.p is not None and self.on == f"M{event.m}" else 1.0


def signal_word(text: str) -> SignalWord | None:
    """`m3 / m5` → the turning of the spindle, `M67 E0` → analog output 0; None for what gives no signal."""
    if text.strip().upper() == "S":
        return SignalWord(type="speed", text="S")
    found = [_ONE.fullmatch(part) for part in text.split("/")]
    if not 1 <= len(found) <= 2:
        return None
    parts = [(int(m[1]), (m[2] or "").upper(), int(m[3] or 0)) for m in found if m is not None]
    if len(parts) != len(found):
        return None
    shown = "/".join(f"M{m}" + (f" {letter}{n}" if letter else "") for m, letter, n in parts)
    numbers = {m for m, _, _ in parts}
    if numbers <= {3, 4, 5} and not any(letter for _, letter, _ in parts):
        return SignalWord(type="turning", text=shown)
    pins = {(letter, n) for _, letter, n in parts}
    if numbers <= {62, 63, 64, 65, 67, 68}:
        letter, index = next(iter(pins))
        wanted = "E" if numbers <= {67, 68} else "P"
        if len(pins) != 1 or letter != wanted or (wanted == "P" and numbers & {67, 68}):
            return None
        return SignalWord(type="digital" if wanted == "P" else "analog", text=shown, index=index)
    if numbers & (_OF_THE_CONTROL | {3, 4, 5, 62, 63, 64, 65, 67, 68}) or any(letter == "E" for _, letter, _ in parts):
        return None
    codes = shown.split("/")
    if len(set(codes)) != len(codes):
        return None
    return SignalWord(type="code", text=shown, on=codes[0], off=codes[1] if len(codes) == 2 else "")


@frozen(kw_only=False)
class _WordKind(Kind):
    """`S`, `M3/M5`, `M62 P1`, `M67 E0` or an M-code of the cell."""

    @property
    def expected(self) -> str:
        return "`S`, `M3/M5`, an output such as `M62 P1` or `M67 E0`, or an M-code such as `M110` or `M10/M11`"

    def read(self, node: Node, to: Reading, path: Path) -> SignalWord | Unread:
        text = scalar(self, node, to, path)
        if isinstance(text, Unread):
            return UNREAD
        word = signal_word(text.text)
        if word is None:
            message = f"`{path[-1]}` is `{short(text.text)}`, which gives no signal; {self.expected} is expected"
            return to.fault("GS711", text.span, message)
        return word

    def schema(self, definitions: dict[str, Json]) -> Json:
        return {"type": "string", "pattern": _PATTERN, "examples": ["S", "M67 E0", "M10/M11"]}

    def show(self, value: Any) -> Any:
        return value.text

    def plain(self, value: Any) -> tuple[str, Any]:
        return "", value.text


WORD: Final = _WordKind()


@frozen
class Amount:
    """A number with the unit as it is written. What it measures is known when the signal is."""

    value: float
    unit: str


@frozen(kw_only=False)
class _AmountKind(Kind):
    """`1 W`: a quantity of whatever the signal measures."""

    @property
    def expected(self) -> str:
        return "a quantity in a unit of the signal, such as `1 W`"

    def read(self, node: Node, to: Reading, path: Path) -> Amount | Unread:
        text = scalar(self, node, to, path)
        if isinstance(text, Unread):
            return UNREAD
        number = measured(text.text)
        if number is None or number.value in (float("inf"), float("-inf")):
            message = f"`{key_name(path)}` is `{short(text.text)}`; {self.expected} is expected"
            return to.fault("GS707", text.span, message, why_no_number(text.text))
        if number.value == 0.0:
            return to.fault("GS710", text.span, f"`{key_name(path)}` is {text.text.strip()}; it must not be 0")
        return Amount(value=number.value, unit=number.unit)

    def schema(self, definitions: dict[str, Json]) -> Json:
        return {"anyOf": [{"type": "number"}, {"type": "string", "examples": ["1 W", "1 cm^3/s"]}]}

    def show(self, value: Any) -> Any:
        return f"{value.value:.10g} {value.unit}".strip()

    def plain(self, value: Any) -> tuple[str, Any]:
        return "", self.show(value)


@frozen
class SignalSource:
    """Where a signal comes from. Its value [SI] is the word's number times `factor` plus `zero`."""

    word: SignalWord = key(
        _WordKind(),
        "what gives the value: S counts while the spindle turns, `M3/M5` is 1 meanwhile; `M10/M11` is 1 from M10 to "
        "M11; an M-code alone gives its Q, else its P, else 1",
    )
    per: Amount | None = key(
        _AmountKind(), "what 1 of the word means", default=None, rule="1 in the SI unit of the signal"
    )
    factor: float = 1.0
    zero: float = 0.0


def _name(text: str) -> str | None:
    name = text.strip()
    return name if re.fullmatch(r"[A-Za-z_]\w*", name, re.ASCII) else None


SIGNALS: Final = MapOf(
    NameRule(what="name of a signal", pattern=r"\s*[A-Za-z_]\w*\s*", canonical=_name),
    Record(SignalSource, "the signal"),
    "signals and the words that give them, such as `power: {word: S, per: 1 W}`",
)
