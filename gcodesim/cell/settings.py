"""Settings of the cell other than bodies: limits, severities, time steps, tool magazine."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import field, replace
from datetime import date
from math import isqrt
from typing import Any, Final, Literal

from gcodesim.cell.placing import Place
from gcodesim.cell.tool_stand import STANDS, StandSpec
from gcodesim.cell.touching import PairKind
from gcodesim.declarations.composed import Either, ListOf
from gcodesim.declarations.keys import inline, key
from gcodesim.declarations.kind import NOT_NEGATIVE, POSITIVE, Json, Kind, Range, scalar, short
from gcodesim.declarations.map_of import NameRule
from gcodesim.declarations.nodes import Node
from gcodesim.declarations.plain_kinds import Choice, Text, Whole
from gcodesim.declarations.quantity import Quantity
from gcodesim.declarations.reading import UNREAD, Path, PlainUnits, Reading, Unread
from gcodesim.declarations.units import find, names
from gcodesim.diagnostics import Severity
from gcodesim.frozen import frozen

NS: Final = 1_000_000_000
DEFAULT_RATE: Final = 250.0  # Hz
DEFAULT_PERIOD_NS: Final = 20_000_000
LOG_SAMPLES: Final = 30_000
"""Records of a log whose period is not set: 10 min at 20 ms. A longer run has as many, further apart."""
_SHORTEST_STEP_NS: Final = 1_000
_LONGEST_STEP_NS: Final = 2.0**62  # longer ones are infinite, for all that counts here
_LONGEST_PERIOD: Final = 10.0  # s


@frozen(kw_only=False)
class _UnitOf(Kind):
    """The unit of plain numbers."""

    dimension: str

    @property
    def expected(self) -> str:
        return f"one of {', '.join(names(self.dimension))}"

    def read(self, node: Node, to: Reading, path: Path) -> str | Unread:
        text = scalar(self, node, to, path)
        if isinstance(text, Unread):
            return UNREAD
        unit = find(text.text, self.dimension)
        if unit is None:
            return to.fault("GS709", text.span, f"`{path[-1]}` is `{short(text.text)}`; {self.expected} is expected")
        return unit.name

    def schema(self, definitions: dict[str, Json]) -> Json:
        return {"enum": list(names(self.dimension))}


@frozen
class Units:
    """The meaning of numbers without a unit."""

    length: str = key(_UnitOf("length"), "unit of plain lengths", default="mm", quiet=True)
    angle: str = key(_UnitOf("angle"), "unit of plain angles", default="deg", quiet=True)

    def checked(self, to: Reading, path: Path) -> Units:
        length, angle = find(self.length, "length"), find(self.angle, "angle")
        assert length is not None and angle is not None
        to.plain = PlainUnits(length=length, angle=angle)
        return self


@frozen
class Limits:
    """The most that spindle and process may need, and how near bodies may come; None: unlimited."""

    spindle_power: float | None = key(Quantity("power", POSITIVE), "greatest spindle power", default=None)
    spindle_speed: float | None = key(Quantity("rotational speed", POSITIVE), "greatest spindle speed", default=None)
    spindle_torque: float | None = key(Quantity("torque", POSITIVE), "greatest spindle torque", default=None)
    force: float | None = key(Quantity("force", POSITIVE), "greatest force on the tool", default=None)
    clearance: float | None = key(
        Quantity("length", POSITIVE), "least distance of links and tools from fixtures", default=None
    )
    may_touch: tuple[tuple[str, str], ...] = key(
        ListOf(PairKind()),
        "pairs of bodies that are not checked against each other, by the names that findings have for them",
        default=(),
        quiet=True,
        example="[[arm/link_4, post], [jaw, blank]]",
    )

    @property
    def apart(self) -> frozenset[frozenset[str]]:
        """The pairs that may touch, in any order."""
        return frozenset(frozenset(pair) for pair in self.may_touch)


@frozen
class SpindleTimes:
    """How quickly the spindle follows S, M3, M4 and M5; the program goes on when it turns as it should."""

    run_up: float = key(
        Quantity("time", NOT_NEGATIVE), "from rest to `speed`, less to a lower one; the machine stands", default=0.0
    )
    run_down: float = key(Quantity("time", NOT_NEGATIVE), "from `speed` to rest", default=0.0)
    speed: float | None = key(
        Quantity("rotational speed", POSITIVE),
        "which these times are for",
        default=None,
        rule="`spindle_speed` of `limits`",
        quiet=True,
    )

    def full_speed(self, limits: Limits) -> float | None:
        """What the times are for [rad/s]."""
        return limits.spindle_speed if self.speed is None else self.speed


_PATTERN: Final = "([Gg][Ss]|[A-Za-z][A-Za-z0-9]{2,15}-)([0-9](?:[0-9]{2}|[0-9][xX]|[xX]{2}))"


def code_pattern(text: str) -> str | None:
    """`GS304`, `GS30x` or `GS9xx`, of other packages `NAME-304` and so on; None when it is neither."""
    match = re.fullmatch(_PATTERN, text.strip())
    return f"{match[1].upper()}{match[2].lower()}" if match else None


CODE_PATTERNS: Final = NameRule(
    what="code (such as `GS304` or `GS9xx`)",
    pattern=_PATTERN,
    canonical=code_pattern,
)


def matches(pattern: str, code: str) -> bool:
    """Whether `code` falls under `pattern` (GS304, GS30x, GS9xx)."""
    return code.startswith(pattern.rstrip("x"))


@frozen(kw_only=False)
class SeverityKind(Kind):
    """`error`, `warning` or `note`."""

    @property
    def expected(self) -> str:
        return "`error`, `warning` or `note`"

    def read(self, node: Node, to: Reading, path: Path) -> Severity | Unread:
        word = Choice(("error", "warning", "note")).read(node, to, path)
        return UNREAD if isinstance(word, Unread) else Severity[word.upper()]

    def schema(self, definitions: dict[str, Json]) -> Json:
        return {"enum": ["error", "warning", "note"]}

    def show(self, value: Any) -> Any:
        return value.word

    def plain(self, value: Any) -> tuple[str, Any]:
        return "", value.word


@frozen(kw_only=False)
class _Date(Kind):
    """A day, `2027-03-01`."""

    @property
    def expected(self) -> str:
        return "a day such as `2027-03-01`"

    def read(self, node: Node, to: Reading, path: Path) -> date | Unread:
        text = scalar(self, node, to, path)
        if isinstance(text, Unread):
            return UNREAD
        try:
            if not re.fullmatch(r"[0-9]{4}-[0-9]{2}-[0-9]{2}", text.text):
                raise ValueError
            return date.fromisoformat(text.text)
        except ValueError:
            return to.fault("GS711", text.span, f"`{path[-1]}` is `{short(text.text)}`; {self.expected} is expected")

    def schema(self, definitions: dict[str, Json]) -> Json:
        return {"type": "string", "format": "date"}

    def show(self, value: Any) -> Any:
        return value.isoformat()

    def plain(self, value: Any) -> tuple[str, Any]:
        return "", value.isoformat()


_CODE = Text(pattern=CODE_PATTERNS.pattern, form="a code such as `GS212`")
_REASON = Text(pattern=r"[\s\S]*\S[\s\S]*", form="a text that says why")


@frozen
class Suppression:
    """A finding that somebody has looked at: code, program, and the block by its text, N number or line."""

    code: str = key(_CODE, "the finding's code")
    program: str | None = key(Text(), "file name of the program", default=None)
    block: str | None = key(Text(), "text of the block", default=None)
    n: int | None = key(Whole(NOT_NEGATIVE), "N number of the block", default=None)
    line: int | None = key(Whole(Range(least=1.0)), "line of the program", default=None)
    reason: str = key(_REASON, "why it is no fault")
    until: date | None = key(_Date(), "last day on which this holds", default=None)

    def checked(self, to: Reading, path: Path) -> Suppression | Unread:
        ways = [name for name in ("block", "n", "line") if getattr(self, name) is not None]
        if len(ways) > 1:
            return to.fault(
                "GS719",
                to.key((*path, ways[1])),
                f"the block is named twice, by `{ways[0]}` and `{ways[1]}`",
                "give one",
            )
        return replace(self, code=code_pattern(self.code) or self.code)


@frozen
class Simulation:
    """World and step. `step_ns`, a tick of the clock, is derived: a whole number of ns."""

    world: Literal["bullet", "kinematic"] | None = key(
        Choice(("bullet", "kinematic")), "where the robot moves", default=None
    )
    rate: float | Literal["auto"] = key(
        Either((("auto", "auto"),), Quantity("frequency", POSITIVE)),
        "steps per second; `auto`: 250, in the kinematic world fewer where the cut stays the same",
        default="auto",
        example="250 Hz",
    )
    seed: int = key(Whole(Range(least=0.0, most=2.0**63 - 1)), "seed of all random numbers", default=1)
    step_ns: int = field(default=round(NS / DEFAULT_RATE))


@frozen
class LogSettings:
    """How densely the run is recorded."""

    period: float | Literal["auto"] = key(
        Either((("auto", "auto"),), Quantity("time", Range(above=0.0, most=_LONGEST_PERIOD))),
        "time between two records; `auto`: 20 ms, longer where steps are not ticks and the run takes more than 10 min",
        default="auto",
        example="20 ms",
    )
    period_ns: int = field(default=DEFAULT_PERIOD_NS)


def with_step(simulation: Simulation, log: LogSettings, to: Reading) -> tuple[Simulation, LogSettings]:
    """Both in whole nanoseconds; a finding if the step is not a whole number or does not divide the log period."""
    period = DEFAULT_PERIOD_NS / NS if log.period == "auto" else log.period
    rate = DEFAULT_RATE if simulation.rate == "auto" else simulation.rate
    period_ns = round(period * NS)
    span = to.span(("log", "period")) if ("log", "period") in to.spans else to.span(("simulation", "rate"))
    if period_ns < _SHORTEST_STEP_NS or abs(period * NS - period_ns) > 1e-3:
        to.fault(
            "GS721",
            span,
            f"the log period of {period * 1e3:.9g} ms is no whole number of ns",
            "write for example `period: 20 ms`",
        )
        return simulation, log
    step_ns = round(min(NS / rate, _LONGEST_STEP_NS))
    whole = step_ns >= 1 and abs(step_ns * rate / NS - 1.0) < 1e-12
    if not whole or period_ns % step_ns:
        span = to.span(("simulation", "rate")) if ("simulation", "rate") in to.spans else span
        nearest = " or ".join(f"`{rate:.10g} Hz`" for rate in sorted(nearest_rates(rate, period_ns)))
        why = "no whole number of ns" if not whole else f"no whole part of the log period of {period * 1e3:.9g} ms"
        to.fault("GS721", span, f"at {rate:.10g} Hz a step is {why}", f"nearest is {nearest}")
        return simulation, log
    return replace(simulation, step_ns=step_ns), replace(log, period_ns=period_ns)


def nearest_rates(rate: float, period_ns: int) -> tuple[float, ...]:
    """Rates [Hz] just below and above `rate` whose step is a whole number of ns that divides `period_ns`."""
    parts = [n for n in _divisors(period_ns) if period_ns // n >= _SHORTEST_STEP_NS]
    rates = sorted(n * NS / period_ns for n in parts)
    below = [r for r in rates if r <= rate]
    above = [r for r in rates if r > rate]
    return (*below[-1:], *above[:1])


def _divisors(number: int) -> Iterator[int]:
    small = [n for n in range(1, isqrt(number) + 1) if number % n == 0]
    yield from small
    yield from (number // n for n in reversed(small) if n * n != number)


@frozen
class Magazine:
    """Where tools wait, and how long a change takes. `place.frame` None and no `xyz`: no place was given."""

    place: Place = inline(Place)
    pitch: float = key(Quantity("length", POSITIVE), "distance between pockets along X", default=0.12, example="120 mm")
    change_time: float = key(Quantity("time", NOT_NEGATIVE), "time of one tool change", default=0.0)
    stands: Mapping[int, StandSpec] = key(STANDS, "to which an arm drives at a tool change", default={}, quiet=True)
    placed: bool = False

    def checked(self, to: Reading, path: Path) -> Magazine:
        return replace(self, placed=any((*path, name) in to.spans for name in ("in", "xyz", "rpy")))
