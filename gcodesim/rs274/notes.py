"""Comments that do something: MSG, DEBUG, PRINT, LOG, ABORT; and those that would on a control, but not here."""

from __future__ import annotations

import re
from collections.abc import Sequence

from gcodesim import canon
from gcodesim.rs274.block import Note, Parameter
from gcodesim.rs274.control import Control
from gcodesim.rs274.expressions import evaluate
from gcodesim.rs274.fault import Fault

_KEY = re.compile(r"[ \t]*([A-Za-z]+),(.*)", re.DOTALL)
_ACTING = frozenset(("msg", "debug", "print", "log", "abort"))
# LinuxCNC compares the beginning only: `(PROBEOPEN points.txt)`
_UNSIMULATED = re.compile(r"[ \t]*(PROBEOPEN|PROBECLOSE|LOGOPEN|LOGAPPEND|LOGCLOSE|PYRUN|PYRELOAD|PY)\b", re.IGNORECASE)
_FORMAT = re.compile(r"%(?:(d|f)|\.([0-9])f)")


def execute_all(notes: Sequence[Note], control: Control) -> None:
    """The comments of a block, of which a control keeps the last only."""
    for note in notes[:-1]:
        match = _KEY.fullmatch(note.text) or _UNSIMULATED.match(note.text)
        if match is not None and (match[1].lower() in _ACTING or match.re is _UNSIMULATED):
            control.warn(
                "GS196",
                f"({match[1].upper()}, …) is passed over: of several comments in a block only the last one acts",
                "put it into a block of its own",
                note.place,
            )
    if notes:
        execute(notes[-1], control)


def execute(note: Note, control: Control) -> None:
    """The event of an active comment; nothing for any other."""
    match = _KEY.fullmatch(note.text)
    key = "" if match is None else match[1].lower()
    if key not in _ACTING:
        unsimulated = _UNSIMULATED.match(note.text)
        if unsimulated is not None and control.dialect.name == "linuxcnc":
            control.skip(f"({unsimulated[1].upper()})")
        return
    assert match is not None
    text = match[2]
    if key == "msg":
        control.out.append(canon.Message(span=control.span, text=text.strip()))
    elif key == "debug":
        control.out.append(canon.Message(span=control.span, text=filled(text, control).strip()))
    elif key == "print":
        control.out.append(canon.Print(span=control.span, text=filled(text, control).strip()))
    elif key == "log":
        control.out.append(canon.Log(span=control.span, text=filled(text, control).strip()))
    elif key == "abort":
        raise Fault("GS190", f"the program asks to stop: {text.strip()}", at=note.place)


def filled(text: str, control: Control) -> str:
    """`text` with #n and #<name> replaced by their values; %d, %f (four decimals) and %.nf set the form of what
    follows; without any of them a value has six decimals."""
    out: list[str] = []
    places = 6
    at = 0
    while at < len(text):
        char = text[at]
        form = _FORMAT.match(text, at) if char == "%" else None
        if form:
            places = int(form[2]) if form[2] is not None else (0 if form[1] == "d" else 4)
            at = form.end()
        elif char == "#":
            value, at = _value(text, at, control)
            out.append(_shown(value, places) if value is not None else "######")
        else:
            out.append(char)
            at += 1
    return "".join(out)


def _shown(value: float, places: int) -> str:
    return f"{value:.{places}f}" if places else f"{value:.0f}"


def _value(text: str, at: int, control: Control) -> tuple[float | None, int]:
    """The value of the parameter that `text` names at `at`, None when there is none, and where it ends."""
    name = re.compile(r"#<([^>]*)>").match(text, at)
    if name:
        squeezed = re.sub(r"\s", "", name[1]).lower()
        if not control.parameters.exists(squeezed):
            return None, name.end()
        return control.parameters.get_named(squeezed), name.end()
    number = re.compile(r"#([0-9]+)").match(text, at)
    if number is None:
        return None, at + 1
    try:
        return evaluate(Parameter(float(number[1])), control.parameters), number.end()
    except Fault:
        return None, number.end()
