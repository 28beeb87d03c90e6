"""Words of the program become signals, one value for each row of the path."""

from __future__ import annotations

import numpy as np
import pytest

from gcodesim.canon import Action, Event, LinearFeed, Output, PathMode, Spindle
from gcodesim.cell.signals import SignalSource, signal_word
from gcodesim.diagnostics import Span
from gcodesim.executor.signals import signals_of_rows
from gcodesim.motion import build_tool_path
from gcodesim.motion.blend import blend
from gcodesim.processes.signal import ACTIVE, SetBy, Signal
from gcodesim.units import RPM

HERE = Span("p.nc", 1)


def move(x: float) -> LinearFeed:
    return LinearFeed(span=HERE, end=(x, 0.0, 0.0, 0.0, 0.0, 0.0), feed=0.01, word="G1")


def output(index: int, value: float, *, analog: bool = False, with_motion: bool = True) -> Output:
    kind = "analog" if analog else "digital"
    return Output(span=HERE, type=kind, index=index, value=value, with_motion=with_motion)


def action(m: int, p: float | None = None, q: float | None = None, does: str = "tool activate") -> Action:
    target, verb = does.split()
    return Action(span=HERE, m=m, p=p, q=q, target=target, verb=verb)


def spindle(speed: float, direction: str = "cw") -> Spindle:
    return Spindle(span=HERE, direction=direction, speed=speed * RPM)  # type: ignore[arg-type]


def values(word: str, *events: Event, factor: float = 1.0, zero: float = 0.0) -> list[float]:
    """Of rows that begin before, between and after the events: one move ahead of each, and one behind the last."""
    found = signal_word(word)
    assert found is not None
    path = build_tool_path([each for i, event in enumerate(events) for each in (move(i + 1.0), event)] + [move(99.0)])
    given = signals_of_rows(path, {"own": SignalSource(word=found, factor=factor, zero=zero)})["own"]
    assert given.shape == (len(path),)
    return [float(f"{value:.9g}") for value in given]


def test_s_counts_while_the_spindle_turns() -> None:
    assert values("S", spindle(100), spindle(300, "ccw"), spindle(300, "off")) == [0, 100, 300, 0]
    assert values("S", spindle(100), factor=2.0, zero=273.0) == [273, 473]
    assert values("M3/M5", spindle(100), spindle(50, "ccw"), spindle(50, "off")) == [0, 1, 1, 0]


def test_outputs_hold_from_the_next_row_on() -> None:
    assert values("M62 P1", output(1, 1), output(2, 1), output(1, 0, with_motion=False)) == [0, 1, 1, 0]
    assert values("M67 E0", output(0, 20, analog=True), output(0, 1), output(0, 7.5, analog=True)) == [0, 20, 20, 7.5]
    assert values("M65 P1", action(64, 1.0), action(63, 1.0)) == [0, 1, 0]  # the cell maps M64 P1 to an action besides


def test_codes_give_their_number_or_switch() -> None:
    assert values("M110", action(110, 30.0), action(110, 4.0, 5.0), action(111, 9.0), action(110)) == [0, 30, 5, 5, 1]
    assert values("M10/M11", action(10), action(12), action(11)) == [0, 1, 1, 0]
    assert values("M110 P2", action(110, 2.0), action(110, 3.0, 8.0), action(110, 2.0, 8.0)) == [0, 1, 1, 8]


def test_the_last_word_before_a_row_counts() -> None:
    word = signal_word("M62 P0")
    assert word is not None
    path = build_tool_path([move(1.0), output(0, 1), output(0, 0), output(0, 1), move(2.0), output(0, 0)])
    assert signals_of_rows(path, {"own": SignalSource(word=word)})["own"].tolist() == [0.0, 1.0]


def test_actions_set_the_signals_that_declare_them() -> None:
    grip = Signal("grip", "N", 3.0, set_by=(SetBy("gripper", "close", 60.0), SetBy("gripper", "open", 0.0)))
    closing, opening = action(10, does="gripper close"), action(11, does="gripper open")
    path = build_tool_path([move(1.0), closing, move(2.0), opening, move(3.0)])
    found = signals_of_rows(path, None, {"grip": grip, "active": ACTIVE})

    assert found["grip"].tolist() == [3.0, 60.0, 0.0]  # its default until the first of them
    assert found["active"].tolist() == [False, False, False]  # another target


def test_a_path_without_rows_has_one_value() -> None:
    word = signal_word("M64 P0")
    assert word is not None
    path = build_tool_path([output(0, 1, with_motion=False)])
    assert signals_of_rows(path, {"own": SignalSource(word=word)})["own"].tolist() == [1.0]


@pytest.mark.parametrize(
    "text", ["G1", "M62", "M62 E1", "M67 P1", "M62 P1/M67 E1", "M62 P1/M63 P2", "M2", "M10/M10", "M3/M10"]
)
def test_what_gives_no_signal(text: str) -> None:
    assert signal_word(text) is None


def test_chords_are_not_merged_across_an_output() -> None:
    """On a control too, what is switched with a motion begins with that motion."""
    from gcodesim.motion.pieces import AxisLimits

    through = PathMode(span=HERE, mode="blend", tolerance=1e-3, naive=1e-3)
    limits = AxisLimits(speed=np.full(6, 1.0), acceleration=np.full(6, 1.0))
    plain = blend(build_tool_path([through, move(1.0), move(2.0), move(3.0)]), limits)
    switched = blend(build_tool_path([through, move(1.0), move(2.0), output(0, 1), move(3.0)]), limits)

    assert len(np.unique(plain.row_first)) == 1 and set(switched.row_first.tolist()) == {0, 2}
