"""`sensors:` of a cell: what sees and feels, where it stands, and which word has it read."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from gcodesim.cell.placing import Place, names_of
from gcodesim.cell.signals import SignalWord, signal_word
from gcodesim.declarations.keys import all_keys, inline, key
from gcodesim.declarations.kind import Json, Kind, scalar, short
from gcodesim.declarations.map_of import MapOf
from gcodesim.declarations.nodes import Node, Scalar
from gcodesim.declarations.reading import UNREAD, Path, Reading, Unread
from gcodesim.declarations.record import Record, object_schema
from gcodesim.declarations.variant import Variant
from gcodesim.frozen import frozen
from gcodesim.sensors import SENSORS

if TYPE_CHECKING:
    from gcodesim.sensors.sensor import Sensor

_TYPES: Final = ("digital", "analog", "code")


@frozen(kw_only=False)
class _TriggerKind(Kind):
    """`M62 P1`, `M67 E0` or an M-code of the cell."""

    @property
    def expected(self) -> str:
        return "an output such as `M62 P1`, or an M-code such as `M110`"

    def read(self, node: Node, to: Reading, path: Path) -> SignalWord | Unread:
        text = scalar(self, node, to, path)
        if isinstance(text, Unread):
            return UNREAD
        word = signal_word(text.text)
        if word is None or word.type not in _TYPES or word.off:
            message = f"`{path[-1]}` is `{short(text.text)}`, at which nothing can be read; {self.expected} is expected"
            return to.fault("GS711", text.span, message)
        return word

    def schema(self, definitions: dict[str, Json]) -> Json:
        return {"type": "string", "examples": ["M62 P1", "M110"]}

    def show(self, value: Any) -> Any:
        return value.text

    def plain(self, value: Any) -> tuple[str, Any]:
        return "", value.text


@frozen
class Mount:
    """Where a sensor stands, and what has it read."""

    place: Place = inline(Place)
    trigger: SignalWord | None = key(
        _TriggerKind(),
        "a word at which it reads: an output when it rises from 0, an M-code each time; without it, a sensor "
        "reads at actions of `m_codes` such as `{camera: shoot}`",
        default=None,
    )


@frozen(eq=False)
class MountedSensor:
    """A sensor of a cell with its name."""

    name: str
    mount: Mount
    sensor: Sensor

    @property
    def kind(self) -> str:
        return self.sensor.kind


@frozen
class _SensorKind(Variant):
    """A sensor of the family; keys of its place stand among its own."""

    def member(
        self, record: Record, entries: tuple[tuple[Scalar, Node], ...], to: Reading, path: Path
    ) -> MountedSensor | Unread:
        of_mount = set(all_keys(Mount))
        mount = Record(Mount, record.what).read_entries(_among(entries, of_mount), to, path)
        sensor = record.read_entries(_among(entries, of_mount, not_in=True), to, path)
        if isinstance(mount, Unread) or isinstance(sensor, Unread):
            return UNREAD
        problems = sensor.problems()
        for name, message in problems:
            to.fault(
                "GS720", to.span((*path, name)), f"sensor {path[-1]} is impossible: {message}", _says(sensor, name)
            )
        if problems:
            return UNREAD
        return MountedSensor(name=str(path[-1]), mount=mount, sensor=sensor)

    def schema(self, definitions: dict[str, Json]) -> Json:
        kinds = []
        for name, cls in self.family.items():
            members = [*all_keys(cls).values(), *all_keys(Mount).values()]
            described = object_schema(members, definitions, cls.__doc__ or "")
            described["properties"] = {"type": {"const": name}, **described["properties"]}
            described["required"] = ["type", *described.get("required", [])]
            definitions[f"sensor_{name}"] = described
            kinds.append({"$ref": f"#/$defs/sensor_{name}"})
        return {"oneOf": kinds}

    def show(self, value: Any) -> Any:
        mount, sensor = Record(Mount, "the sensor"), Record(type(value.sensor), "the sensor")
        return {"type": value.kind, **mount.show(value.mount), **sensor.show(value.sensor)}

    def plain(self, value: Any) -> tuple[str, Any]:
        mount, sensor = Record(Mount, "the sensor"), Record(type(value.sensor), "the sensor")
        return "", {"type": value.kind, **mount.plain(value.mount)[1], **sensor.plain(value.sensor)[1]}


def _among(
    entries: tuple[tuple[Scalar, Node], ...], names: set[str], *, not_in: bool = False
) -> tuple[tuple[Scalar, Node], ...]:
    return tuple(entry for entry in entries if (entry[0].text in names) is not not_in)


def _says(sensor: Sensor, name: str) -> str:
    cls: type = type(sensor)
    return f"`{name}`: {all_keys(cls)[name].doc}" if name in all_keys(cls) else ""


SENSOR_MAP: Final = MapOf(
    names_of("sensor"),
    _SensorKind(family=SENSORS, what="sensor", example="{type: camera, in: arm/flange, xyz: [0, 60, 20]}"),
    "sensors by name, such as `eye: {type: camera, in: arm/flange, trigger: M62 P1}`",
    lenient=True,
)
