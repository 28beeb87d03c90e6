"""What is in force at a line, in words of the trade."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Final

from gcodesim.canon.systems import name_of_system
from gcodesim.numbers import clean
from gcodesim.rs274.state import AXES

if TYPE_CHECKING:
    from gcodesim.rs274.control import Control

_SIDES: Final = {0: "G40", 1: "G41", -1: "G42"}
_TURNS: Final = {1: "M3", -1: "M4", 0: "M5"}


def number(value: float) -> str:
    """A number as people write it: four places at most."""
    return f"{clean(round(value, 4)):g}" if abs(value) < 1e5 else f"{value:.4g}"


def code_text(code: int) -> str:
    """A G code of a number times ten."""
    return f"G{code / 10:g}"


def modes_text(control: Control) -> str:
    """The modal codes in force."""
    state = control.state
    codes = [code_text(state.motion) if state.motion >= 0 else "G80"]
    codes += [code_text(state.plane), "G21" if state.unit == 1e-3 else "G20", "G91" if state.incremental else "G90"]
    codes += [code_text(state.feed_mode), _SIDES[state.side], name_of_system(state.system), code_text(state.path)]
    return " ".join(codes)


def position_text(control: Control) -> str:
    """Where the tool is in the active work system; axes that are at 0 and never moved are left out behind Z."""
    current = control.state.current
    shown = [(letter, value) for letter, value in zip(AXES.upper(), current, strict=True) if letter in "XYZ" or value]
    return " ".join(f"{letter}{number(value)}" for letter, value in shown)


def tool_text(control: Control, names: dict[int, str]) -> str:
    """The tool in the spindle."""
    tool = control.spindle_tool.number
    if not tool:
        return "none"
    return f"T{tool}" + (f" ({names[tool]})" if tool in names else "")


def speed_text(control: Control) -> str:
    state = control.state
    turns = _TURNS[state.turning]
    return f"S{number(state.speed)} {turns}"


def rows(before: Control, after: Control, names: dict[int, str]) -> Iterator[tuple[str, str]]:
    """What is in force after a line, and what was where it differs."""
    for what, now, then in (
        ("position", position_text(after), position_text(before)),
        ("feed", f"F{number(after.state.feed)}", f"F{number(before.state.feed)}"),
        ("spindle", speed_text(after), speed_text(before)),
        ("tool", tool_text(after, names), tool_text(before, names)),
        ("modes", modes_text(after), modes_text(before)),
    ):
        yield what, now if now == then else f"{then} → {now}"
