"""When programs that wait for each other go on: numbers and names only, no machine.

A *mark* is a name at which programs wait for each other. It is used by the channels whose programs come to it at least
once. The n-th time of one channel meets the n-th time of all others that use the mark: each waits from its arrival
until the last has arrived, then all go on at once. A mark that nobody else uses is passed.

A *thing* is there once, such as a tool. One channel has it from when it fetches it until it returns it; another that
fetches it waits until then. Of several that wait, the one that has come first gets it, by name if they came at once.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TypeAlias

from gcodesim.frozen import frozen


@frozen
class Arrival:
    """A program comes to `mark` at `time` [s] of its own, waits not counted.

    `partners` are the channels that a control waits for, itself included, if the program names them; else all channels
    that use the mark.
    """

    mark: str
    time: float
    partners: frozenset[str] | None = None


@frozen
class Fetching:
    """A program needs `thing` at `time` [s] of its own, waits not counted, and has it from then on."""

    thing: str
    time: float


@frozen
class Returning:
    """A program gives `thing` back at `time` [s] of its own, waits not counted."""

    thing: str
    time: float


Stop: TypeAlias = Arrival | Fetching | Returning


@frozen
class Agenda:
    """The stops of one program in order, and how long it takes in all [s], waits not counted.

    `holds` are the things that it has at the start.
    """

    arrivals: Sequence[Stop]
    duration: float
    holds: frozenset[str] = frozenset()


@frozen(kw_only=False)
class Wait:
    """A channel waits from `begin` until `end` [s] of the common clock; `end` is None where the others never come."""

    begin: float
    end: float | None

    @property
    def seconds(self) -> float:
        return 0.0 if self.end is None else self.end - self.begin


@frozen(kw_only=False)
class Halt:
    """Channel `channel` stands at its stop `index`."""

    channel: str
    index: int


@frozen
class Timetable:
    """How the programs of a run go together; everything is ordered by the names of channels.

    `waits` has an entry for each stop that a channel comes to. `ends` [s] is when each program ends, None where it
    never does. `circle`: channels of which each waits for the next one, and the last for the first. `ended`: who waits
    where for a channel that has ended. `lone`: the first arrivals at marks that nobody else uses.
    """

    waits: Mapping[str, tuple[Wait, ...]]
    ends: Mapping[str, float | None]
    circle: tuple[Halt, ...]
    ended: tuple[tuple[Halt, str], ...]
    lone: tuple[Halt, ...]

    @property
    def total(self) -> float | None:
        """When the last program ends [s]; None if one of them never does."""
        ends = [end for end in self.ends.values() if end is not None]
        return max(ends, default=0.0) if len(ends) == len(self.ends) else None

    @property
    def stopped_at(self) -> float:
        """The last time [s] at which anything happens; the arrival at a mark that is never passed counts."""
        last = [end for end in self.ends.values() if end is not None]
        last += [waits[-1].begin for name, waits in self.waits.items() if self.ends[name] is None]
        return max(last, default=0.0)


def timetable(agendas: Mapping[str, Agenda]) -> Timetable:
    """Let the programs of `agendas` run together, by the names of their channels."""
    desk = _Desk({name: agendas[name] for name in sorted(agendas)})
    while desk.meet():
        pass
    return desk.result()


class _Desk:
    """The programs on their way; each stands at its next stop, or has ended."""

    def __init__(self, agendas: Mapping[str, Agenda]) -> None:
        self._agendas = agendas
        users: dict[str, dict[str, None]] = {}
        for name, agenda in agendas.items():
            for arrival in agenda.arrivals:
                if isinstance(arrival, Arrival):
                    users.setdefault(arrival.mark, {})[name] = None
        self._users = {mark: tuple(names) for mark, names in users.items()}
        self._next = dict.fromkeys(agendas, 0)
        self._late = dict.fromkeys(agendas, 0.0)  # the waits so far
        self._passed: dict[tuple[str, str], int] = {}  # how often a channel has passed a mark
        self._waits: dict[str, list[Wait]] = {name: [] for name in agendas}
        self._holder = {thing: name for name in reversed(list(agendas)) for thing in agendas[name].holds}
        self._freed: dict[str, float] = {}  # when things came back
        self._fresh = list(agendas)  # channels that have come to another stop

    def meet(self) -> bool:
        """Let all channels go on that may; whether there was one.

        Marks and returns first: what fetches a thing does so later than all that can still happen before it.
        """
        fresh, self._fresh = self._fresh, []
        for name in fresh:
            stop = self._at(name)
            if isinstance(stop, Returning):
                self._return(name, stop)
            elif isinstance(stop, Arrival) and not self._missing(name):
                self._go_on(self._together(name, stop))
        if not self._fresh:
            self._fetch()
        return bool(self._fresh)

    def _at(self, name: str) -> Stop | None:
        """Where a channel stands; None when it has ended."""
        arrivals = self._agendas[name].arrivals
        return arrivals[self._next[name]] if self._next[name] < len(arrivals) else None

    def _begin(self, name: str, stop: Stop) -> float:
        return stop.time + self._late[name]

    def _together(self, name: str, arrival: Arrival) -> tuple[str, ...]:
        """The channels that meet where `name` stands, itself included."""
        named = arrival.partners
        if named is None:
            return self._users[arrival.mark]
        return tuple(other for other in self._agendas if other == name or other in named)

    def _missing(self, name: str) -> list[str]:
        """The channels for which `name`, which stands at a mark or before a thing, still waits."""
        stop = self._at(name)
        assert stop is not None
        if not isinstance(stop, Arrival):
            holder = self._holder.get(stop.thing)
            return [] if holder is None else [holder]
        times = self._passed.get((name, stop.mark), 0)
        return [other for other in self._together(name, stop) if other != name and not self._is_at(other, stop, times)]

    def _is_at(self, other: str, arrival: Arrival, times: int) -> bool:
        """Whether `other` stands at the mark, having passed it so many times."""
        now = self._at(other)
        if not isinstance(now, Arrival):
            return False
        return now.mark == arrival.mark and self._passed.get((other, arrival.mark), 0) == times

    def _go_on(self, together: Iterable[str]) -> None:
        standing = [(name, stop) for name in together if isinstance(stop := self._at(name), Arrival)]
        end = max(self._begin(name, arrival) for name, arrival in standing)
        for name, arrival in standing:
            key = (name, arrival.mark)
            self._passed[key] = self._passed.get(key, 0) + 1
            self._pass(name, arrival, end)

    def _pass(self, name: str, stop: Stop, end: float) -> None:
        """Let a channel go on from a stop at `end` [s]."""
        begin = self._begin(name, stop)
        self._waits[name].append(Wait(begin, end))
        self._late[name] += end - begin
        self._next[name] += 1
        self._fresh.append(name)

    def _return(self, name: str, stop: Returning) -> None:
        if self._holder.get(stop.thing) == name:
            del self._holder[stop.thing]
            self._freed[stop.thing] = self._begin(name, stop)
        self._pass(name, stop, self._begin(name, stop))

    def _fetch(self) -> None:
        """Let the first channel that can have the thing that it needs take it."""
        ready = [
            (self._ready(name, stop), self._begin(name, stop), name, stop)
            for name in self._agendas
            if isinstance(stop := self._at(name), Fetching) and self._holder.get(stop.thing, name) == name
        ]
        if ready:
            end, _, name, stop = min(ready, key=lambda each: each[:3])
            self._holder[stop.thing] = name
            self._pass(name, stop, end)

    def _ready(self, name: str, stop: Fetching) -> float:
        return max(self._begin(name, stop), self._freed.get(stop.thing, 0.0))

    def result(self) -> Timetable:
        ends: dict[str, float | None] = {}
        for name, agenda in self._agendas.items():
            arrival = self._at(name)
            ends[name] = agenda.duration + self._late[name] if arrival is None else None
            if arrival is not None:
                self._waits[name].append(Wait(self._begin(name, arrival), None))
        held = {name: self._missing(name) for name, end in ends.items() if end is None}
        return Timetable(
            waits={name: tuple(waits) for name, waits in self._waits.items()},
            ends=ends,
            circle=tuple(self._standing(name) for name in _circle(held)),
            ended=tuple((self._standing(name), by) for name, others in held.items() for by in others if by not in held),
            lone=tuple(self._lone()),
        )

    def _standing(self, name: str) -> Halt:
        return Halt(name, self._next[name])

    def _lone(self) -> Iterable[Halt]:
        for name, agenda in self._agendas.items():
            seen = set()
            for index, arrival in enumerate(agenda.arrivals):
                if not isinstance(arrival, Arrival):
                    continue
                if arrival.mark not in seen and self._together(name, arrival) == (name,):
                    yield Halt(name, index)
                seen.add(arrival.mark)


def _circle(held: Mapping[str, Sequence[str]]) -> tuple[str, ...]:
    """Channels of which each is held by the next one, the first by name at the front; empty if there is no circle.

    `held` has, for each channel that stands, those for which it waits; one that is not in it has ended.
    """
    done: set[str] = set()
    for first in sorted(held):
        way: list[str] = []
        branches = [iter((first,))]
        while branches:
            name = next(branches[-1], None)
            if name is None:
                branches.pop()
                if way:
                    done.add(way.pop())
            elif name in way:
                circle = way[way.index(name) :]
                front = circle.index(min(circle))
                return (*circle[front:], *circle[:front])
            elif name in held and name not in done:
                way.append(name)
                branches.append(iter(sorted(held[name])))
    return ()
