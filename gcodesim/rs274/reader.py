"""Lines to blocks: a scan for plain words and numbers, the grammar for everything else.

Both ways give the same block; the scan only spares the grammar on the lines
that CAM systems write.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import TYPE_CHECKING

from gcodesim.rs274.block import Block, Flow, Note, Place, Setting, Word
from gcodesim.rs274.fault import Fault

if TYPE_CHECKING:
    from gcodesim.rs274.dialects import Dialect
    from gcodesim.rs274.grammar import Parsed, Unreadable

_NUMBER = r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)"
_LETTERS = "A-MP-Za-mp-z@^"
# possessive quantifiers, so that a line that does not fit is left after one pass
_PLAIN = re.compile(rf"[ \t]*+(?:[Nn][0-9]++[ \t]*+)?+(?:[{_LETTERS}]{_NUMBER}[ \t]*+)*+")
_WORD = re.compile(rf"([{_LETTERS}])({_NUMBER})")
_BLANK = re.compile(r"[ \t]*\Z")
_MOST_BRACKETS = 200

_NAMES_OF_TERMINALS = {
    "NUMBER": "a number",
    "LSQB": "`[`",
    "RSQB": "`]`",
    "HASH": "`#`",
    "EQUAL": "`=`",
    "FUNCTION": "a function",
    "LETTER": "a word",
    "KEYWORD": "sub, call, if, while …",
    "SLASH": "`/`",
    "$END": "the end of the line",
    "NAME": "`<name>`",
}


def _plain_places(text: str) -> list[Place]:
    line_number = re.match(r"[ \t]*[Nn][0-9]+", text)
    return [m.span() for m in _WORD.finditer(text, line_number.end() if line_number else 0)]


def read_plain(line: int, text: str) -> Block | None:
    """The block of a line made of words with plain numbers; None when the line holds anything else."""
    scanned = _PLAIN.match(text)
    if scanned is None or scanned.end() != len(text):
        return None
    start = 0
    head = text.lstrip()[:1]
    if head in ("N", "n"):
        start = text.index(head) + 1  # the N word itself is dropped
    words = [(letter.lower(), float(number)) for letter, number in _WORD.findall(text, start)]
    return Block(line, text, words, plain=True, _find=_plain_places)


def prepare(text: str) -> tuple[str, list[int]]:
    """The line without blanks and in lower case outside comments, and the column each character came from.

    Raises `Fault` on comments that nest or do not close.
    """
    out: list[str] = []
    columns: list[int] = []
    at = 0
    while at < len(text):
        char = text[at]
        if char == "(":
            end = text.find(")", at)
            nested = text.find("(", at + 1, end if end >= 0 else len(text))
            if nested >= 0:
                raise Fault("GS003", "a comment inside a comment", at=(nested, nested + 1), hint="close the first one")
            if end < 0:
                raise Fault("GS003", "the comment is never closed", at=(at, len(text)), hint="add `)`")
            out.append(text[at : end + 1])
            columns.extend(range(at, end + 1))
            at = end + 1
        elif char == ";":
            out.append(text[at:])
            columns.extend(range(at, len(text)))
            break
        else:
            if char not in " \t":
                # lower() may give two characters (as of a dotted capital I); columns must stay in step
                out.append(char.lower() if char.isascii() else char)
                columns.append(at)
            at += 1
    columns.append(len(text))
    return "".join(out), columns


class Reader:
    """Reads lines of one dialect; `read` gives the block or raises `Fault`."""

    def __init__(self, dialect: Dialect) -> None:
        self._dialect = dialect
        self._longest_line = dialect.longest_line
        self._parse: Callable[[str], Parsed] | None = None

    def read(self, line: int, text: str) -> Block:
        """The block of `text`, which stands in line number `line`."""
        if len(text) > self._longest_line:
            raise Fault(
                "GS002",
                f"the line has {len(text)} characters; {self._longest_line} are allowed",
                at=(self._longest_line, len(text)),
                hint="split the line, or shorten its comment",
                value=len(text),
                limit=self._longest_line,
            )
        return read_plain(line, text) or self._read_by_grammar(line, text)

    def _read_by_grammar(self, line: int, text: str) -> Block:
        squeezed, columns = prepare(text)
        if not squeezed:
            return Block(line, text, [])
        if squeezed[0] in "(;":
            only = _whole_comment(squeezed)
            if only is not None:
                return Block(line, text, [], notes=(Note(only, (columns[0], len(text.rstrip()))),))
        if squeezed.count("[") > _MOST_BRACKETS:
            raise Fault("GS006", f"more than {_MOST_BRACKETS} brackets in one line", hint="compute it in several steps")
        if self._parse is None:
            from gcodesim.rs274.grammar import parser_of  # Lark costs 50 ms, so only when a line needs it

            self._parse = parser_of(self._dialect.grammar)
        from gcodesim.rs274.grammar import Unreadable

        try:
            parsed = self._parse(squeezed)
        except Unreadable as problem:
            raise _explain(problem, squeezed, columns) from None
        block = _to_block(line, text, squeezed, columns, parsed)
        self._check_extensions(block, squeezed, columns)
        return block

    def _check_extensions(self, block: Block, squeezed: str, columns: list[int]) -> None:
        """Raise `Fault` for parts of the language that this dialect does not have."""
        dialect = self._dialect
        if block.flow is not None and not dialect.flow_words:
            raise Fault("GS008", f"{dialect.name} has no O-words", at=block.flow.place)
        if not dialect.named_parameters and "#<" in squeezed:
            at = squeezed.index("#<")
            if not any(first <= columns[at] < last for _, (first, last) in block.notes):
                raise Fault("GS007", f"{dialect.name} has no named parameters", at=(columns[at], columns[at] + 2))


def _whole_comment(squeezed: str) -> str | None:
    """What a line that is one comment and nothing else has to say."""
    if squeezed[0] == ";":
        return ""  # after a semicolon nothing is active
    return squeezed[1:-1] if squeezed.find(")") == len(squeezed) - 1 else None


def _to_block(line: int, text: str, squeezed: str, columns: list[int], parsed: Parsed) -> Block:
    starts = sorted(
        [start for start, _ in parsed.words]
        + [start for start, _, _ in parsed.settings]
        + [start for start, _ in parsed.notes]
        + [len(squeezed)]
    )

    def place(start: int) -> Place:
        end = next(s for s in starts if s > start)
        return columns[start], columns[end - 1] + 1

    flow = None
    if parsed.flow is not None:
        start, label, keyword, operands = parsed.flow
        flow = Flow(label, keyword, operands, place(start))
    words: list[Word] = [word for _, word in parsed.words]
    return Block(
        line,
        text,
        words,
        settings=tuple(Setting(index, value, place(start)) for start, index, value in parsed.settings),
        notes=tuple(Note(note, place(start)) for start, note in parsed.notes),
        flow=flow,
        deleted=parsed.deleted,
        _places=[place(start) for start, _ in parsed.words],
    )


def _explain(problem: Unreadable, squeezed: str, columns: list[int]) -> Fault:
    """The finding for a line that breaks the grammar."""
    at = min(problem.column, len(squeezed))
    found = squeezed[at : at + 1]
    here = (columns[at], columns[at] + 1) if found else (max(columns[-1] - 1, 0), columns[-1])
    wants_value = "NUMBER" in problem.expected
    before = squeezed[at - 1 : at]
    if found == "n" and at > 0 and not (wants_value and before.isalpha() and _is_word_letter(squeezed, at - 1)):
        return Fault(
            "GS001", "a line number must stand first in its line", at=here, hint="move the N word to the front"
        )
    if (squeezed[:1] == "n" and at == 1) or (found == "n" and at == 0):
        return Fault("GS005", "a line number is N and digits, without a sign", at=(columns[0], here[1]))
    if _in_flow(squeezed):
        return _explain_flow(problem, squeezed, columns, here)
    if wants_value and before.isalpha() and before.isascii() and _is_word_letter(squeezed, at - 1):
        letter = before.upper()
        return Fault(
            "GS004",
            f"{letter} has no number" + (f" (found `{found}`)" if found else ""),
            at=(columns[at - 1], columns[at - 1] + 1),
            hint=f"write a number after {letter}, or drop the word",
        )
    if squeezed[at - 1 : at] in "+-" and wants_value and at:
        return Fault("GS004", "a sign without a number", at=(columns[at - 1], columns[at - 1] + 1))
    if re.match(r"[0-9.]+", squeezed[at:]) and re.search(r"[0-9.]\Z", squeezed[:at]):
        number = _number_around(squeezed, at)
        return Fault(
            "GS005",
            f"`{squeezed[number[0] : number[1]]}` is not a number",
            at=(columns[number[0]], columns[number[1] - 1] + 1),
        )
    if squeezed.count("[") > squeezed.count("]") and not found:
        return Fault("GS006", "a bracket is never closed", at=here, hint="add `]`")
    if "EQUAL" in problem.expected and _in_setting(squeezed, at):
        return Fault("GS007", "a parameter setting needs `=`", at=here, hint="write it as #1=2")
    if squeezed.count("<", 0, at + 1) > squeezed.count(">", 0, at + 1) or (found == "<" and ">" not in squeezed[at:]):
        return Fault("GS007", "the name of the parameter is never closed", at=here, hint="add `>`")
    if squeezed.count("[", 0, at) > squeezed.count("]", 0, at):
        return _explain_expression(squeezed, columns, at, problem)
    if not found:
        return Fault("GS006", "the line ends in the middle of a value", at=here, hint=_expectation(problem))
    return Fault("GS001", f"`{_visible(found)}` cannot stand here", at=here, hint=_expectation(problem))


def _explain_expression(squeezed: str, columns: list[int], at: int, problem: Unreadable) -> Fault:
    text = re.match(r"[a-z]+|.?", squeezed[at:])
    word = text.group() if text else ""
    here = (columns[at], columns[at + max(len(word), 1) - 1] + 1)
    if len(word) > 1:
        what = "function" if "FUNCTION" in problem.expected else "operator"
        return Fault("GS006", f"`{word.upper()}` is no {what} of this dialect", at=here, hint=_expectation(problem))
    return Fault("GS006", f"`{_visible(word)}` cannot stand here in an expression", at=here, hint=_expectation(problem))


def _explain_flow(problem: Unreadable, squeezed: str, columns: list[int], here: Place) -> Fault:
    at = problem.column
    if "KEYWORD" in problem.expected:
        word = re.match(r"[a-z]+", squeezed[at:])
        if word:
            return Fault(
                "GS008",
                f"`{word.group()}` is no command of an O-word",
                at=(columns[at], columns[at + len(word.group()) - 1] + 1),
                hint="known are sub endsub call return if elseif else endif while endwhile do repeat endrepeat …",
            )
    return Fault("GS008", "this cannot stand in a line with an O-word", at=here, hint="put it on a line of its own")


def _in_flow(squeezed: str) -> bool:
    return re.match(r"/?(?:n[0-9.]+)?o", squeezed) is not None


def _is_word_letter(squeezed: str, at: int) -> bool:
    """Whether the letter at `at` opens a word rather than ending a name of a function or operator."""
    return at == 0 or not squeezed[at - 1].isalpha()


def _number_around(squeezed: str, at: int) -> tuple[int, int]:
    start, end = at, at
    while start > 0 and squeezed[start - 1] in "0123456789.":
        start -= 1
    while end < len(squeezed) and squeezed[end] in "0123456789.":
        end += 1
    return start, end


def _in_setting(squeezed: str, at: int) -> bool:
    hash_sign = squeezed.rfind("#", 0, at)
    return (
        hash_sign >= 0
        and (hash_sign == 0 or not squeezed[hash_sign - 1].isalpha())
        and "=" not in squeezed[hash_sign:at]
    )


def _expectation(problem: Unreadable) -> str:
    names = [_NAMES_OF_TERMINALS[t] for t in _NAMES_OF_TERMINALS if t in problem.expected]
    return f"expected {', '.join(names)}" if names else ""


def _visible(char: str) -> str:
    return char if char.isprintable() else f"U+{ord(char):04X}"


__all__ = ["Reader", "prepare", "read_plain"]
