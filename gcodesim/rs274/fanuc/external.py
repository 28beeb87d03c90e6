"""POPEN, DPRNT, BPRNT, PCLOS and SETVN: macro statements for a device outside, and names of variables."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from gcodesim import canon
from gcodesim.rs274.block import Block, Flow, Name

if TYPE_CHECKING:
    from gcodesim.rs274.block import ColumnRange
    from gcodesim.rs274.fanuc.control import FanucControl

_STATEMENT = re.compile(
    r"\s*(?P<skip>/[1-9]?)?\s*(?:[Nn]\s*[0-9]+)?\s*"
    r"(?P<all>(?P<word>POPEN|PCLOS|DPRNT|BPRNT|SETVN)\s*(?:[0-9]*\s*\[(?P<text>.*)\])?)\s*(?:[(;].*)?",
    re.IGNORECASE,
)
_VARIABLE = re.compile(r"#([0-9]{1,5})\s*\[([0-9])([0-9])\]")
KEYWORDS = frozenset(("popen", "pclos", "dprnt", "bprnt", "setvn"))


def statement(line: int, text: str) -> Block | None:
    """The block of a line that is such a statement; None for any other."""
    match = _STATEMENT.fullmatch(text)
    if match is None:
        return None
    flow = Flow(Name(match["text"] or ""), match["word"].lower(), (), match.span("all"))
    return Block(line, text, [], flow=flow, deleted=match["skip"] is not None)


def execute(flow: Flow, control: FanucControl) -> None:
    """DPRNT prints; the others are told as not simulated."""
    if flow.keyword != "dprnt":
        place: ColumnRange = flow.place
        control.skip(flow.keyword.upper(), place)
        return
    assert isinstance(flow.label, Name)
    control.out.append(canon.Print(span=control.span, text=printed(flow.label.name, control)))


def printed(text: str, control: FanucControl) -> str:
    """The text with `#n[ab]` as numbers of at most a digits before the point and b behind it; `*` is a blank.

    A vacant variable prints nothing. Leading blanks, which a parameter of the control puts in, are left out.
    """

    def shown(match: re.Match[str]) -> str:
        variables = control.parameters
        value = variables.read(variables.index(float(match[1])))
        if value is None:
            return ""
        number = f"{abs(value) % 10.0 ** int(match[2]):.{match[3]}f}"
        return f"-{number}" if value < 0.0 else number

    return _VARIABLE.sub(shown, text).replace("*", " ").strip()
