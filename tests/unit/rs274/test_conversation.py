"""A run is a conversation: what it asks, and how it goes on from the answer."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from gcodesim import canon
from gcodesim.canon.listing import as_json
from gcodesim.diagnostics import Severity, SourceText
from gcodesim.rs274 import Run, Settings, interpret
from gcodesim.units import DEG, MM

Answer = canon.Answer | canon.Axes | None


def touched(x: float, y: float, z: float, *, over: float = 0.0, tripped: bool = True) -> canon.Touched:
    """Trip at a point of M [mm]; the machine comes to rest `over` mm above or below."""
    point = (x * MM, y * MM, z * MM, 0.0, 0.0, 0.0)
    stop = (x * MM, y * MM, (z + over) * MM, 0.0, 0.0, 0.0)
    return canon.Touched(point=point, stop=stop, tripped=tripped)


def converse(text: str, answer: Callable[[canon.Event], Answer], **settings: object) -> tuple[list[canon.Event], Run]:
    """All events of a program whose questions are answered, and the run."""
    run = interpret(SourceText("p.ngc", text.encode()), Settings(answered=True, **settings))  # type: ignore[arg-type]
    stream, events, reply = iter(run), [], None
    while True:
        try:
            event = stream.send(reply)
        except StopIteration:
            return events, run
        events.append(event)
        asks = isinstance(event, canon.ProbeMove | canon.Input)
        reply = answer(event) if asks else None


def errors(run: Run) -> list[tuple[str, int]]:
    return [(f.code, f.span.line) for f in run.findings if f.level is Severity.ERROR]


def ends(events: list[canon.Event]) -> list[canon.Axes]:
    return [event.end for event in events if isinstance(event, canon.Rapid)]


def test_the_trip_is_stored_and_the_next_move_begins_where_the_machine_stopped() -> None:
    events, run = converse("G21 F50\nG0 Z10\nG38.2 Z-5\nG91 G0 Z5\nM2", lambda _: touched(0, 0, 2, over=-0.1))
    assert run.parameters[5063] == pytest.approx(2.0) and run.parameters[5070] == 1.0
    assert ends(events)[-1][2] == pytest.approx(6.9 * MM)


def test_the_trip_is_stored_in_the_work_system_and_in_program_units() -> None:
    program = "G20 F5\nG10 L2 P1 X1 R90\nG54\nG0 X0 Y0 Z1\nG38.2 Z-1\n(DEBUG, #5061 #5062)\nM2"
    _, run = converse(program, lambda _: touched(25.4, 50.8, 12.7))
    assert [run.parameters.get(n, 0.0) for n in (5061, 5062, 5063)] == pytest.approx([2.0, 0.0, 0.5], abs=1e-12)


def test_angles_of_the_trip_are_degrees() -> None:
    answer = canon.Touched(point=(0, 0, 0, 30 * DEG, 0, 0), stop=(0, 0, 0, 30 * DEG, 0, 0), tripped=True)
    _, run = converse("F50\nG38.2 Z-5 A30\nM2", lambda _: answer)
    assert run.parameters[5064] == pytest.approx(30.0)


@pytest.mark.parametrize(("word", "found"), [("G38.2", [("GS138", 2)]), ("G38.3", []), ("G38.4", [("GS138", 2)])])
def test_only_some_probes_have_to_trip(word: str, found: list[tuple[str, int]]) -> None:
    events, run = converse(f"F50\n{word} Z-5\nG0 Z7\nM2", lambda _: touched(0, 0, -5, tripped=False))
    assert errors(run) == found
    assert (run.parameters.get(5070, 0.0), run.parameters[5063]) == (0.0, pytest.approx(-5.0))
    assert len(ends(events)) == (0 if found else 1), "a probe that failed ends the program"
    assert run.failed_line == (2 if found else None)


def test_a_probe_in_the_wrong_state_is_refused_and_the_rest_is_still_read() -> None:
    refused = canon.Touched(point=(0,) * 6, stop=(0,) * 6, tripped=False, refused=True)  # type: ignore[arg-type]
    events, run = converse("F50\nG38.3 Z-5\nG0 Z7\nG1 X\nM2", lambda _: refused)
    assert errors(run) == [("GS139", 2), ("GS004", 4)]
    assert ends(events) == []


def test_a_loop_that_only_an_answer_ends() -> None:
    program = "F50\no1 do\nG38.3 Z-1\nG91 G0 Z-2\nG90\no1 while [#5070 EQ 0]\nM2"
    count = 0

    def answer(_: canon.Event) -> canon.Touched:
        nonlocal count
        count += 1
        return touched(0, 0, -1, tripped=count == 4)

    _, run = converse(program, answer)
    assert count == 4 and not list(run.findings)


def test_nobody_answers_in_canon() -> None:
    run = interpret(SourceText("p.ngc", b"F50\nM66 P1 L3 Q2\nG38.2 Z-5\nM2"), Settings())
    events = list(run)
    assert not any(isinstance(event, canon.Input) for event in events)
    assert run.parameters[5070] == 1.0 and run.parameters[5063] == -5.0
    assert sorted(run.not_simulated) == ["G38.2", "M66"]


@pytest.mark.parametrize(
    ("block", "asked"),
    [
        ("M66 P3 L0", {"type": "digital", "index": 3, "wait": "immediate", "timeout": 0}),
        ("M66 P3", {"type": "digital", "index": 3, "wait": "immediate", "timeout": 0}),
        ("M66 P0 L1 Q2.5", {"type": "digital", "index": 0, "wait": "rise", "timeout": 2.5}),
        ("M66 P0 L2 Q1", {"type": "digital", "index": 0, "wait": "fall", "timeout": 1}),
        ("M66 P0 L3 Q1", {"type": "digital", "index": 0, "wait": "high", "timeout": 1}),
        ("M66 P0 L4 Q1", {"type": "digital", "index": 0, "wait": "low", "timeout": 1}),
        ("M66 E2 L0", {"type": "analog", "index": 2, "wait": "immediate", "timeout": 0}),
    ],
)
def test_what_m66_asks(block: str, asked: dict[str, object]) -> None:
    events, run = converse(f"{block}\nM2", lambda _: canon.Heard(value=1.0))
    shown = next(as_json(event) for event in events if isinstance(event, canon.Input))
    assert shown == {"kind": "input", "line": 1, **asked}
    assert run.parameters[5399] == 1.0 and not run.not_simulated


def test_a_wait_that_runs_out_reads_minus_one() -> None:
    program = "M66 P0 L3 Q1\no1 if [#5399 LT 0]\nG0 X5\no1 endif\nM2"
    events, run = converse(program, lambda _: canon.Heard(value=None))
    assert run.parameters[5399] == -1.0 and len(ends(events)) == 1


def test_the_time_of_an_answer_is_none_of_reading(monkeypatch: pytest.MonkeyPatch) -> None:
    from gcodesim.rs274 import allowance as module

    clock = 0.0
    monkeypatch.setattr(module.time, "monotonic", lambda: clock)
    monkeypatch.setattr(module, "_CHECK_CLOCK_EVERY", 1)

    def slow(_: canon.Event) -> canon.Touched:
        nonlocal clock
        clock += 100.0
        return touched(0, 0, -1)

    _, run = converse("F50\nG38.2 Z-5\n#1=1\n#1=2\nM2", slow, time_limit=10.0)
    assert not list(run.findings)


def test_the_skip_function_of_fanuc_is_answered_too() -> None:
    program = "%\nO1\nG21 G90 G94\nG31 Z-10. F50\n#1=#5063\nG0 Z[#1+2.]\nM30\n%\n"
    events, run = converse(program, lambda _: touched(0, 0, -4), dialect="fanuc")
    assert ends(events)[-1][2] == pytest.approx(-2.0 * MM)
    assert not run.not_simulated


def test_the_skip_position_of_fanuc_is_where_the_signal_came() -> None:
    """Z of the axes, with the length of H1 (50 mm), in the work system; the next G91 goes on from where it stopped."""
    setup = "O1\nG21 G90 G10 L10 P1 R50.\nG10 L2 P1 X0 Y0 Z10.\nG54 G43 H1\nG0 Z20.\n"
    program = setup + "G31 Z-5. F50.\n#100=#5063\nG91 G0 Z5.\nM30\n"
    events, run = converse(program, lambda _: touched(0, 0, 12, over=-0.1), dialect="fanuc")
    assert errors(run) == []
    assert run.parameters[100] == pytest.approx(2.0 + 50.0)
    assert ends(events)[-1][2] == pytest.approx((12 - 0.1 + 5) * MM)
