"""Programs that wait for each other: who goes on when, who never does."""

from __future__ import annotations

import random

import pytest

from gcodesim.planning.meetings import Agenda, Arrival, Fetching, Halt, Returning, Stop, Timetable, Wait, timetable


def together(**programs: list[float | str]) -> Timetable:
    """Programs as lists of seconds that they take and marks at which they wait."""
    agendas = {}
    for name, steps in programs.items():
        time, arrivals = 0.0, []
        for step in steps:
            if isinstance(step, str):
                arrivals.append(Arrival(mark=step, time=time))
            else:
                time += step
        agendas[name] = Agenda(arrivals=arrivals, duration=time)
    return timetable(agendas)


def test_both_go_on_when_the_last_has_come() -> None:
    table = together(a=[2.0, "m", 1.0], b=[5.0, "m", 0.5])

    assert table.waits == {"a": (Wait(2.0, 5.0),), "b": (Wait(5.0, 5.0),)}
    assert table.ends == {"a": 6.0, "b": 5.5}
    assert table.total == table.stopped_at == 6.0
    assert not table.circle and not table.ended and not table.lone


def test_waits_delay_all_that_follows() -> None:
    table = together(a=["m", 1.0, "n"], b=[3.0, "m", 5.0, "n"])

    assert table.waits["a"] == (Wait(0.0, 3.0), Wait(4.0, 8.0))


def test_a_circle_of_three_leaves_out_who_waits_behind_it() -> None:
    """d waits for c, and c for a; a and b and c wait for each other in a circle."""
    table = together(a=[1.0, "ab", "ca", "cd"], b=[2.0, "bc", "ab"], c=[3.0, "ca", "bc", "cd"], d=[4.0, "cd"])

    assert table.circle == (Halt("a", 0), Halt("b", 0), Halt("c", 0))
    assert table.total is None
    assert table.stopped_at == 4.0
    assert table.waits["d"] == (Wait(4.0, None),)


def test_who_waits_for_one_that_has_ended_is_in_no_circle() -> None:
    table = together(a=["m", "m"], b=["m"], c=["m", 7.0])

    assert not table.circle
    assert table.ended == ((Halt("a", 1), "b"), (Halt("a", 1), "c"))
    assert table.ends == {"a": None, "b": 0.0, "c": 7.0}
    assert table.stopped_at == 7.0


def test_a_lone_mark_is_passed_and_told_once() -> None:
    table = together(a=["x", 1.0, "x", "m"], b=["m"])

    assert table.lone == (Halt("a", 0),)
    assert table.total == 1.0


def test_named_partners_wait_for_nobody_else() -> None:
    """As on a control whose word names the paths: c comes to the same word later, with others."""
    pair, all_three = frozenset("ab"), frozenset("abc")
    table = timetable(
        {
            "a": Agenda(arrivals=[Arrival(mark="M100 P12", time=1.0, partners=pair)], duration=1.0),
            "b": Agenda(arrivals=[Arrival(mark="M100 P12", time=2.0, partners=pair)], duration=2.0),
            "c": Agenda(arrivals=[Arrival(mark="M100 P123", time=0.0, partners=all_three)], duration=0.0),
        }
    )

    assert table.ends == {"a": 2.0, "b": 2.0, "c": None}
    assert table.ended == ((Halt("c", 0), "a"), (Halt("c", 0), "b"))


@pytest.mark.parametrize("seed", range(200))
def test_as_a_clock_that_ticks(seed: int) -> None:
    """The truth: all channels advance by one second at a time and go on when all others stand there as often."""
    dice = random.Random(seed)
    names = "abcd"[: dice.randint(2, 4)]
    marks = {name: [dice.choice("mno") for _ in range(dice.randint(0, 4))] for name in names}
    programs = {
        name: [part for mark in marks[name] for part in (float(dice.randint(0, 3)), mark)] + [float(dice.randint(0, 3))]
        for name in names
    }

    table = together(**programs)

    ends, waits = ticked(programs)
    assert table.ends == ends
    assert {name: [(wait.begin, wait.end) for wait in table.waits[name]] for name in names} == waits
    assert (table.total is None) == bool(table.circle or table.ended)
    for standing, other in zip(table.circle, table.circle[1:] + table.circle[:1], strict=True):
        mark, against = marks[standing.channel][standing.index], marks[other.channel][other.index]
        assert mark != against and mark in marks[other.channel]


def ticked(
    programs: dict[str, list[float | str]],
) -> tuple[dict[str, float | None], dict[str, list[tuple[float, float | None]]]]:
    todo = {name: list(steps) for name, steps in programs.items()}
    users = {m: {n for n, steps in programs.items() if m in steps} for steps in programs.values() for m in steps}
    ends: dict[str, float | None] = dict.fromkeys(programs)
    waits: dict[str, list[tuple[float, float | None]]] = {name: [] for name in programs}
    since: dict[str, float] = {}
    for now in range(100):
        moved = True
        while moved:
            moved = False
            for name, steps in todo.items():
                if steps and steps[0] == 0.0:
                    steps.pop(0)
                    moved = True
                if not steps and ends[name] is None:
                    ends[name] = float(now)
                if steps and isinstance(steps[0], str):
                    since.setdefault(name, float(now))
            for mark in users:
                passed = {n: sum(s == mark for s in programs[n]) - sum(s == mark for s in todo[n]) for n in users[mark]}
                here = {n for n in users[mark] if n in since and todo[n][0] == mark}
                if here == users[mark] and len(set(passed.values())) == 1:
                    for name in here:
                        todo[name].pop(0)
                        waits[name].append((since.pop(name), float(now)))
                    moved = True
        for steps in todo.values():
            if steps and isinstance(steps[0], float):
                steps[0] -= 1.0
    for name, begin in since.items():
        waits[name].append((begin, None))
    return ends, waits


def things(**programs: list[float | str]) -> Timetable:
    """Programs as lists of seconds, marks, and things that they fetch (`+T1`) and return (`-T1`)."""
    agendas = {}
    for name, steps in programs.items():
        time = 0.0
        stops: list[Stop] = []
        for step in steps:
            if isinstance(step, float):
                time += step
            elif step[0] in "+-":
                stops.append((Fetching if step[0] == "+" else Returning)(thing=step[1:], time=time))
            else:
                stops.append(Arrival(mark=step, time=time))
        agendas[name] = Agenda(arrivals=stops, duration=time)
    return timetable(agendas)


def test_a_thing_is_waited_for_until_it_is_back_and_who_came_first_gets_it() -> None:
    table = things(a=[4.0, "+T1", 5.0, "-T1"], b=[1.0, "+T1", 7.0, "-T1", 1.0], c=[2.0, "+T1", 3.0, "-T1", 1.0])

    assert [table.waits[name][0] for name in "abc"] == [Wait(4.0, 11.0), Wait(1.0, 1.0), Wait(2.0, 8.0)]
    assert table.ends == {"a": 16.0, "b": 9.0, "c": 12.0}


def test_who_comes_later_by_a_mark_does_not_get_a_thing_earlier() -> None:
    """a comes to the thing at 1 s of its own time, but has waited at a mark for 9 s before that."""
    table = things(a=["m", 1.0, "+T1", 1.0, "-T1"], b=[9.0, "m", 2.0], c=[5.0, "+T1", 8.0, "-T1"])

    assert table.waits["c"][0] == Wait(5.0, 5.0)
    assert table.waits["a"][1] == Wait(10.0, 13.0)


def test_a_thing_and_a_mark_make_a_circle() -> None:
    table = things(a=["+T1", 3.0, "m", "-T1"], b=[2.0, "+T1", "m"])

    assert table.circle == (Halt("a", 1), Halt("b", 0))
    assert table.waits["b"] == (Wait(2.0, None),)


def test_who_has_ended_with_a_thing_never_gives_it_back() -> None:
    table = things(a=["+T1", 3.0], b=[2.0, "+T1"])

    assert table.ended == ((Halt("b", 0), "a"),)
    assert table.ends == {"a": 3.0, "b": None}
