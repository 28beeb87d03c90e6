"""The handshake of controls: whatever their pace, nobody leaves a mark before all have come."""

from __future__ import annotations

import random
from collections.abc import Iterator

import pytest

from gcodesim.diagnostics import Span
from gcodesim.post.meeting import ControlMeetings, MeetingLines
from gcodesim.post.moves import RobotAwait, RobotSwitch

PARTNERS = {"all": ["a", "b", "c"], "ab": ["a", "b"], "bc": ["b", "c"]}
PROGRAMS = {
    "a": ["all", "ab", "ab", "all", "all"],
    "b": ["bc", "all", "ab", "bc", "ab", "all", "bc", "all"],
    "c": ["bc", "all", "bc", "all", "bc", "all"],
}


def steps(name: str, wires: set[str]) -> Iterator[tuple[str, bool] | str]:
    """What a control does: it waits for a wire, or comes to or leaves a mark; wires that are on are in `wires`."""
    partners = {mark: names for mark, names in PARTNERS.items() if name in names}
    lines = {other: MeetingLines(output=f"{name}{other}", input=f"{other}{name}") for other in "abc" if other != name}
    meetings = ControlMeetings(channel=name, partners=partners, lines=lines)
    for mark in PROGRAMS[name]:
        yield f"comes {mark}"
        for step in meetings.meet(Span("x"), mark):
            if isinstance(step, RobotAwait):
                yield step.signal, step.on
            else:
                assert isinstance(step, RobotSwitch)
                (wires.add if step.value else wires.discard)(step.signal)
                yield step.signal, bool(step.value)  # as long as it likes
        yield f"leaves {mark}"


@pytest.mark.parametrize("seed", range(20))
def test_all_wait_for_all(seed: int) -> None:
    chance = random.Random(seed)
    wires: set[str] = set()
    running = {name: steps(name, wires) for name in PROGRAMS}
    waits: dict[str, tuple[str, bool] | str] = {name: next(each) for name, each in running.items()}
    pace = {name: chance.choice([1, 1, 20]) for name in PROGRAMS}
    came = {(name, mark): 0 for name in PROGRAMS for mark in PARTNERS}
    left = dict(came)
    for _ in range(20_000):
        name = chance.choice([name for name in running for _ in range(pace[name])] or ["-"])
        if name == "-":
            break
        now = waits[name]
        if isinstance(now, tuple) and (now[0] in wires) != now[1]:
            continue
        if isinstance(now, str):
            what, mark = now.split()
            (came if what == "comes" else left)[name, mark] += 1
            assert left[name, mark] <= min(came[other, mark] for other in PARTNERS[mark])
        following = next(running[name], None)
        if following is None:
            del running[name]
        else:
            waits[name] = following

    assert not running
    assert left == came
    assert not wires
