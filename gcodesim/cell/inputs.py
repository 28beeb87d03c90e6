"""What M66 reads: inputs of a channel that hold a value, change by time, or are wired to an output of the program."""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Mapping
from typing import Any, Final, Literal

from gcodesim.declarations.kind import Json, Kind, scalar, short
from gcodesim.declarations.map_of import NameRule
from gcodesim.declarations.nodes import Listing, Node
from gcodesim.declarations.nodes import Mapping as MappingNode
from gcodesim.declarations.quantity import Quantity
from gcodesim.declarations.reading import UNREAD, Path, Reading, Reference, Unread
from gcodesim.frozen import frozen

_PLACE: Final = re.compile(r"\s*([PpEe])\s*0*(\d{1,3})\s*")
_TIME, _VALUE = Quantity("time"), Quantity("ratio")

Wait = Literal["immediate", "rise", "fall", "high", "low"]


@frozen
class InputSource:
    """An input: at each of `times` (n,) [s] it has the next of `values` (n + 1,), or it follows what else is named."""

    values: tuple[float, ...] = (0.0,)
    times: tuple[float, ...] = ()
    output: str | None = None
    device: str | None = None
    sensor: str | None = None

    def read(
        self, wait: Wait, begin: float, timeout: float, outputs: Mapping[str, float]
    ) -> tuple[float | None, float]:
        """What M66 reads that begins at `begin` [s], and how long it waits [s]; None when `timeout` [s] runs out.

        `outputs` are those that the program has set. While it waits it sets none, so a wired input stays as it is.
        """
        if self.output is not None:
            return InputSource(values=(outputs.get(self.output, 0.0),)).read(wait, begin, timeout, {})
        index = bisect_right(self.times, begin)
        now = self.values[index]
        if wait == "immediate" or (wait == "high" and now) or (wait == "low" and not now):
            return now, 0.0
        for time, value in zip(self.times[index:], self.values[index + 1 :], strict=True):
            if time > begin + timeout:
                break
            if bool(value) == (wait in ("rise", "high")) and bool(value) != bool(now):
                return value, time - begin
            now = value
        return None, timeout


def place_of_pin(text: str) -> str | None:
    """`p01` → `P1`; None when it is no input or output."""
    match = _PLACE.fullmatch(text)
    return None if match is None else f"{match[1].upper()}{int(match[2])}"


INPUTS: Final = NameRule(
    what="input (digital such as `P0`, analog such as `E0`)", pattern=_PLACE.pattern, canonical=place_of_pin
)


@frozen(kw_only=False)
class InputKind(Kind):
    """`1`, `[[0, 0], [5 s, 1]]` or `{output: P1}`."""

    @property
    def expected(self) -> str:
        return (
            "a number, a list of times and values such as `[[0, 0], [5 s, 1]]`, `{output: P1}`, `{device: door}` or "
            "`{sensor: barrier}`"
        )

    def read(self, node: Node, to: Reading, path: Path) -> InputSource | Unread:
        if isinstance(node, MappingNode):
            return self._wired(node, to, path)
        if isinstance(node, Listing):
            return self._by_time(node, to, path)
        value = _VALUE.read(node, to, path)
        return UNREAD if isinstance(value, Unread) else InputSource(values=(value,))

    def _wired(self, node: MappingNode, to: Reading, path: Path) -> InputSource | Unread:
        word = node.entries[0][0].text if len(node.entries) == 1 else ""
        if word in ("device", "sensor"):
            name = scalar(self, node.entries[0][1], to, (*path, word))
            if isinstance(name, Unread):
                return UNREAD
            what: Literal["device", "sensor"] = "device" if word == "device" else "sensor"
            to.references.append(Reference(what=what, name=name.text, path=(*path, word)))
            return InputSource(device=name.text) if what == "device" else InputSource(sensor=name.text)
        if len(node.entries) != 1 or node.entries[0][0].text != "output":
            return to.fault("GS706", node.span, f"`{path[-1]}` is wired to nothing known; {self.expected} is expected")
        text = scalar(self, node.entries[0][1], to, (*path, "output"))
        if isinstance(text, Unread):
            return UNREAD
        place = place_of_pin(text.text)
        if place is None:
            message = f"`output` is `{short(text.text)}`; an output is digital such as `P1`, or analog such as `E0`"
            return to.fault("GS711", text.span, message)
        return InputSource(output=place)

    def _by_time(self, node: Listing, to: Reading, path: Path) -> InputSource | Unread:
        times: list[float] = []
        values = [0.0]
        for index, item in enumerate(node.items):
            if not isinstance(item, Listing) or len(item.items) != 2:
                return to.fault("GS706", item.span, f"`{path[-1]}` needs pairs of time and value; {self.expected}")
            time = _TIME.read(item.items[0], to, (*path, index, 0))
            value = _VALUE.read(item.items[1], to, (*path, index, 1))
            if isinstance(time, Unread) or isinstance(value, Unread):
                return UNREAD
            if times and time <= times[-1]:
                return to.fault("GS711", item.span, f"times of `{path[-1]}` must increase")
            times.append(time)
            values.append(value)
        return InputSource(times=tuple(times), values=tuple(values))

    def schema(self, definitions: dict[str, Json]) -> Json:
        value, time = _VALUE.schema(definitions), _TIME.schema(definitions)
        pair = {"type": "array", "prefixItems": [time, value], "minItems": 2, "maxItems": 2}
        output = {"type": "string", "pattern": f"^{_PLACE.pattern}$"}
        wired = {
            "type": "object",
            "properties": {"output": output},
            "required": ["output"],
            "additionalProperties": False,
        }
        named = [
            {
                "type": "object",
                "properties": {word: {"type": "string"}},
                "required": [word],
                "additionalProperties": False,
            }
            for word in ("device", "sensor")
        ]
        return {"anyOf": [value, {"type": "array", "items": pair}, wired, *named]}

    def show(self, value: Any) -> Any:
        if value.device is not None:
            return {"device": value.device}
        if value.sensor is not None:
            return {"sensor": value.sensor}
        if value.output is not None:
            return {"output": value.output}
        if not value.times:
            return _VALUE.show(value.values[0])
        pairs = zip(value.times, value.values[1:], strict=True)
        return [[_TIME.show(time), _VALUE.show(at)] for time, at in pairs]

    def plain(self, value: Any) -> tuple[str, Any]:
        return "", self.show(value)
