"""What a word means, and what its line does: the text that shows under the pointer."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

from gcodesim.canon.listing import as_text
from gcodesim.diagnostics.plain import markdown_text, one_line
from gcodesim.editor.place import TextRange
from gcodesim.editor.state_text import number, rows
from gcodesim.rs274.dialects.meanings import LETTERS, meanings_of
from gcodesim.rs274.fault import Fault

if TYPE_CHECKING:
    from gcodesim.editor.program_document import ProgramDocument
    from gcodesim.rs274.incremental import LineMoment
    from gcodesim.rs274.parameters import Parameters
    from gcodesim.rs274.tokens import Token

_MOST_EVENTS = 5


class Hover(NamedTuple):
    """Text in Markdown, and the part of the program that it is about."""

    text: str
    range: TextRange


def hover(document: ProgramDocument, line: int, column: int) -> Hover | None:
    """What stands at a place; None for an empty line and behind its end."""
    tokens = document.tokens(line)
    at = next((n for n, token in enumerate(tokens) if token.place[0] <= column < token.place[1]), None)
    moment = document.moment(line)
    if at is None and (moment is None or not tokens):
        return None
    told = [] if at is None else list(_about(document, tokens, at, moment))
    begin, end = (tokens[0].place[0], tokens[-1].place[1]) if at is None else _word(tokens, at)
    if moment is not None:
        told.append(_table(document, moment))
        told += _events(moment)
    return Hover("\n\n".join(told), TextRange(line, begin, line, end)) if told else None


def _word(tokens: list[Token], at: int) -> tuple[int, int]:
    """The word or parameter to which a token belongs."""
    first, last = at, at
    if tokens[at].kind in ("NUMBER", "NAME", "ADDING", "SIGN"):
        while first > 0 and tokens[first].kind in ("NUMBER", "NAME", "ADDING", "SIGN", "HASH"):
            first -= 1
            if tokens[first].kind in ("LETTER", "HASH"):
                break
    while last + 1 < len(tokens) and tokens[last].kind in ("LETTER", "ADDING", "SIGN", "HASH", "O"):
        if tokens[last + 1].kind not in ("NUMBER", "NAME", "ADDING", "SIGN"):
            break
        last += 1
    return tokens[first].place[0], tokens[last].place[1]


def _about(document: ProgramDocument, tokens: list[Token], at: int, moment: LineMoment | None) -> Iterator[str]:
    """What the word itself means."""
    begin, end = _word(tokens, at)
    inside = [token for token in tokens if begin <= token.place[0] < end]
    head, rest = inside[0], "".join(token.text for token in inside[1:])
    if head.kind == "LETTER":
        yield _of_letter(document, head.text.upper(), rest, tokens)
    elif head.kind == "HASH" and rest:
        yield _of_parameter(rest, moment)
    elif head.kind in ("O", "KEYWORD"):
        yield _of_o_word(document, tokens)


def _of_letter(document: ProgramDocument, letter: str, rest: str, tokens: list[Token]) -> str:
    meanings = meanings_of(document.dialect)
    try:
        code = f"{letter}{float(rest):g}"
    except ValueError:
        code = letter
    if letter in "GM":
        return f"**{code}** {meanings.get(code, 'has no meaning here')}"
    user = [
        f"{t.text.upper()}{float(v.text):g}"
        for t, v in pairwise(tokens)
        if t.kind == "LETTER" and t.text in "gm" and v.kind == "NUMBER"
    ]
    of = f" (of {' '.join(user)})" if user else ""
    said = f"**{code}** {LETTERS.get(letter, 'a word')}{of}"
    if letter in "TH" and rest.isdigit() and (name := document.tool_names.get(int(rest))):
        said += f": {markdown_text(name)}"
    return said


def _of_parameter(name: str, moment: LineMoment | None) -> str:
    word = f"**#{markdown_text(name)}**"
    if moment is None:
        return f"{word} a parameter"
    values = moment.before.parameters, moment.after.parameters
    shown = [_value(one, name) for one in values]
    return f"{word} is {shown[0]}" + (f", then {shown[1]}" if shown[1] != shown[0] else "")


def _value(parameters: Parameters, name: str) -> str:
    try:
        if name.startswith("<"):
            return number(parameters.get_named("".join(name[1:-1].split()).lower()))
        return number(parameters.get(int(float(name))))
    except (Fault, ValueError):
        return "not set"


def _of_o_word(document: ProgramDocument, tokens: list[Token]) -> str:
    words = " ".join(token.text for token in tokens[:3] if token.kind in ("O", "NUMBER", "NAME", "KEYWORD"))
    return f"**{markdown_text(words)}**"


def _table(document: ProgramDocument, moment: LineMoment) -> str:
    lines = [
        f"| {what} | {markdown_text(value)} |" for what, value in rows(moment.before, moment.after, document.tool_names)
    ]
    return "\n".join(["| | |", "|---|---|", *lines])


def _events(moment: LineMoment) -> list[str]:
    """The canonical events of the line."""
    said = [one_line(as_text(event)[8:].strip()) for event in moment.events[:_MOST_EVENTS]]
    if len(moment.events) > _MOST_EVENTS:
        said.append(f"… and {len(moment.events) - _MOST_EVENTS} more")
    return ["```\n" + "\n".join(said) + "\n```"] if said else []
