"""Comments that act: MSG, DEBUG, PRINT, LOG, ABORT; and those that would act on a control, but not here."""

from __future__ import annotations

import re
from collections.abc import Sequence

from gcodesim import canon
from gcodesim.rs274.block import Note
from gcodesim.rs274.control import Control
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.parameters import DEBUG_ON, LAST_NUMBER, POSITION

_KEY = re.compile(r"[ \t]*([A-Za-z]+),(.*)", re.DOTALL)
_ACTING = frozenset(("msg", "debug", "print", "log", "abort"))
# LinuxCNC compares the beginning only: `(PROBEOPEN points.txt)`
_UNSIMULATED = re.compile(r"[ \t]*(PROBEOPEN|PROBECLOSE|LOGOPEN|LOGAPPEND|LOGCLOSE|PYRUN|PYRELOAD|PY)\b", re.IGNORECASE)
_FORMAT = re.compile(r"%(?:(d|f)|\.([0-9])f)")
_PARAMETER = re.compile(r"#(?:<([^>]*)>|([0-9]+))")
_UNKNOWN = "######"
_NOTHING = 1e-4  # values nearer to 0 are shown as 0
_LONGEST = 30  # characters of a value, as on the control


def execute_all(notes: Sequence[Note], control: Control) -> None:
    """The comments of a block, of which a control keeps only the last."""
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
            control.skip(f"({unsimulated[1].upper()})", note.place)
        return
    assert match is not None
    text = match[2]
    if key == "msg":
        control.out.append(canon.Message(span=control.span, text=text.strip()))
    elif key == "debug":
        if control.parameters.get(DEBUG_ON) > 0.0:
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
        parameter = _PARAMETER.match(text, at) if char == "#" else None
        if form:
            places = int(form[2]) if form[2] is not None else (0 if form[1] == "d" else 4)
            at = form.end()
        elif char == "%" and text[at + 1 : at + 2] == ".":
            out.append(".")  # not a valid form: the control drops its %
            at += 2
        elif parameter:
            value = _value(parameter, control)
            out.append(_UNKNOWN if value is None else _shown(value, places))
            at = parameter.end()
        else:
            out.append(char)
            at += 1
    return "".join(out)


def _shown(value: float, places: int) -> str:
    if abs(value) < _NOTHING:
        value = 0.0
    text = f"{value:.{places}f}" if places else f"{value:.0f}"
    return text if len(text) < _LONGEST else _UNKNOWN


def _value(parameter: re.Match[str], control: Control) -> float | None:
    """The value of #n or #<name>; None if it has none."""
    name, number = parameter[1], parameter[2]
    if name is not None:
        squeezed = re.sub(r"\s", "", name).lower()
        return control.parameters.get_named(squeezed) if control.parameters.exists(squeezed) else None
    index = int(number)
    if POSITION <= index < POSITION + 9:  # here it may be read with cutter compensation, too
        return control.state.current[index - POSITION]
    return control.parameters.get(index) if index <= LAST_NUMBER else None
