"""Why a line cannot be read: the finding for a line that breaks the grammar, with the likely slip."""

from __future__ import annotations

import re
from difflib import get_close_matches
from typing import TYPE_CHECKING

from gcodesim.rs274.block import KEYWORDS
from gcodesim.rs274.dialects import DIALECTS
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.slips import slip_at

if TYPE_CHECKING:
    from gcodesim.rs274.dialects import Dialect
    from gcodesim.rs274.grammar import Unreadable

_NAMES_OF_TERMINALS = {
    "NUMBER": "a number",
    "LSQB": "`[`",
    "RSQB": "`]`",
    "HASH": "`#`",
    "EQUAL": "`=`",
    "FUNCTION": "a function",
    "LETTER": "a word",
    "KEYWORD": "sub, call, if, while …",
    "ADDING": "an operator",
    "SLASH": "`/`",
    "$END": "the end of the line",
    "NAME": "`<name>`",
}

_STATEMENT = re.compile(r"/?(?:n[0-9]+)?(goto(?=[0-9#\[])|if(?=\[)|while(?=\[)|do(?=[0-9])|end(?=[0-9]))")
_CALL = re.compile(r"[a-z]{2,}(?=\[)")
_FLOW = re.compile(r"(?:/?(?:n[0-9.]+)?o)((?:[0-9.]+|<[^>]*>|\[[^a-z]*\])?)([a-z]*)")
_NEXT = re.compile(  # a word, statement, setting, operand or comment begins
    r"[a-z^@$][-+]?(?:#?[0-9.]+|#<[^>]*>|(?=[#\[]))|goto|then|do(?=[0-9])|#(?:[0-9]+|<[^>]*>)=|\[|[(;]"
)
_NOTE = re.compile(r"\([^()]*\)|;.*")
_FUNCTIONS = ("abs", "acos", "asin", "atan", "cos", "exp", "fix", "fup", "ln", "round", "sin", "sqrt", "tan")
_WITH_VALUE = frozenset(("if", "elseif", "while", "repeat", "call", "return"))
_OPERATORS = ("mod", "eq", "ne", "gt", "ge", "lt", "le", "and", "or", "xor")


def explain(problem: Unreadable, squeezed: str, columns: list[int], dialect: Dialect) -> Fault:
    """The finding for a line that breaks the grammar; `columns` are those of the characters of `squeezed`."""
    statement = _STATEMENT.match(squeezed)
    if statement is not None and not dialect.statements:
        word = statement[1].upper()
        own = "o1 if [#1 GT 2] … o1 endif is the way here; " if dialect.flow_words else ""
        place = (columns[statement.start(1)], columns[statement.end(1) - 1] + 1)
        other = next((name for name in (*DIALECTS.own(), *DIALECTS) if DIALECTS[name].statements), "")
        hint = f"{own}{other} knows {word} (--dialect {other})"
        return Fault("GS008", f"{word} is no word of {dialect.name}", at=place, hint=hint)
    if not dialect.statements and (flow := _FLOW.match(squeezed)) is not None:
        if not dialect.flow_words:
            begin = columns[squeezed.index("o")]
            hint = "linuxcnc has them (--dialect linuxcnc)"
            return Fault("GS008", f"{dialect.name} has no O-words", at=(begin, begin + 1), hint=hint)
        return _explain_flow(problem, squeezed, columns, flow)
    at = min(problem.column, len(squeezed))
    if not dialect.named_parameters and dialect.computes and squeezed[at - 1 : at + 1] == "#<":
        hint = "linuxcnc has them (--dialect linuxcnc)"
        place = (columns[at - 1], columns[at] + 1)
        return Fault("GS007", f"{dialect.name} has no named parameters", at=place, hint=hint)
    slip = slip_at(squeezed, columns, at)
    if not dialect.computes and squeezed[at : at + 1] in ("#", "["):
        slip = f"{dialect.name} has neither parameters nor expressions: the post has to write numbers"
    return _explain(problem, squeezed, columns, slip)


def _explain(problem: Unreadable, squeezed: str, columns: list[int], slip: str) -> Fault:
    at = min(problem.column, len(squeezed))
    found = squeezed[at : at + 1]
    here = (columns[at], columns[at] + 1) if found else (max(columns[-1] - 1, 0), columns[-1])
    wants_value = "NUMBER" in problem.expected
    before = squeezed[at - 1 : at] if at else ""
    if found == "n" and at > 0 and not (wants_value and before.isalpha() and _is_word_letter(squeezed, at - 1)):
        hint = "move the N word to the front"
        return Fault("GS001", "a line number must stand first in its line", at=here, hint=hint)
    if (squeezed[:1] == "n" and at == 1) or (found == "n" and at == 0):
        hint = "write N and digits, or drop the N"
        return Fault("GS005", "a line number is N and digits, without a sign", at=(columns[0], here[1]), hint=hint)
    if wants_value and "FUNCTION" in problem.expected and (name := _CALL.match(squeezed, at)) is not None:
        return _unknown_name(name[0], at, columns, "function", _FUNCTIONS)
    if wants_value and (before in ("@", "^", "$") or (before.isalpha() and before.isascii())):
        letter = before.upper()
        if _is_word_letter(squeezed, at - 1):
            return Fault(
                "GS004",
                f"{letter} has no number" + (f" (found `{_visible(found)}`)" if found else ""),
                at=(columns[at - 1], columns[at - 1] + 1),
                hint=slip or f"write a number after {letter}, or drop the word",
            )
    if before and before in "+-" and wants_value:
        hint = slip or "write the number behind it, or drop it"
        return Fault("GS004", "a sign without a number", at=(columns[at - 1], columns[at - 1] + 1), hint=hint)
    if re.match(r"[0-9.]", found) and re.search(r"[0-9.]\Z", squeezed[:at]):
        first, last = _number_around(squeezed, at)
        place = (columns[first], columns[last - 1] + 1)
        hint = "a number has one decimal point" if squeezed.count(".", first, last) > 1 else slip
        return Fault("GS005", f"`{squeezed[first:last]}` is not a number", at=place, hint=hint)
    if "RSQB" in problem.expected and _is_open(squeezed) and (not found or _NEXT.match(squeezed, at)):
        return _never_closed(squeezed, columns, at)
    if "EQUAL" in problem.expected and _in_setting(squeezed, at):
        return Fault("GS007", "a parameter setting needs `=`", at=here, hint=slip or "write it as #1=2")
    if squeezed.count("<", 0, at + 1) > squeezed.count(">", 0, at + 1) or (found == "<" and ">" not in squeezed[at:]):
        return Fault("GS007", "the name of the parameter is never closed", at=here, hint="add `>`")
    if not found:
        hint = slip or _expectation(problem)
        return Fault("GS006", "the line ends in the middle of a value", at=here, hint=hint)
    if squeezed.count("[", 0, at) > squeezed.count("]", 0, at):
        return _explain_expression(squeezed, columns, at, problem, slip)
    return Fault("GS001", f"`{_visible(found)}` cannot stand here", at=here, hint=slip or _expectation(problem))


def _explain_expression(squeezed: str, columns: list[int], at: int, problem: Unreadable, slip: str) -> Fault:
    text = re.match(r"[a-z]+", squeezed[at:])
    word = text.group() if text else squeezed[at : at + 1]
    if len(word) > 1:
        functions = "FUNCTION" in problem.expected
        return _unknown_name(
            word, at, columns, "function" if functions else "operator", _FUNCTIONS if functions else _OPERATORS
        )
    here = (columns[at], columns[at] + 1)
    if word == "(":
        slip = "( ) is a comment, also in an expression; group by [ ]"
    elif word == "#":
        slip = ""
    hint = slip or _expectation(problem)
    return Fault("GS006", f"`{_visible(word)}` cannot stand here in an expression", at=here, hint=hint)


def _is_open(squeezed: str) -> bool:
    """Whether the line has more opening than closing brackets, comments aside."""
    text = _NOTE.sub("", squeezed)
    return text.count("[") > text.count("]")


def _never_closed(squeezed: str, columns: list[int], at: int) -> Fault:
    """The innermost bracket that is still open at `at`, where something else begins or the line ends."""
    opened: list[int] = []
    for index, char in enumerate(squeezed[:at]):
        if char == "[":
            opened.append(index)
        elif char == "]":
            opened.pop()
    follows = _NEXT.match(squeezed, at)
    hint = "add `]`"
    if follows:
        hint += " before the comment" if follows[0] in "(;" else f" before {follows[0].upper()}"
    begin = columns[opened[-1]]
    return Fault("GS006", "a bracket is never closed", at=(begin, begin + 1), hint=hint)


def _unknown_name(word: str, at: int, columns: list[int], what: str, known: tuple[str, ...]) -> Fault:
    """A function or operator that does not exist, and the nearest that does."""
    here = (columns[at], columns[at + len(word) - 1] + 1)
    near = get_close_matches(word, known, n=1)
    hint = f"did you mean {near[0].upper()}?" if near else f"known are {' '.join(known).upper()}"
    return Fault("GS006", f"`{word.upper()}` is no {what}", at=here, hint=hint)


def _explain_flow(problem: Unreadable, squeezed: str, columns: list[int], flow: re.Match[str]) -> Fault:
    at = min(problem.column, len(squeezed))
    here = (columns[at], columns[at] + 1) if at < len(squeezed) else (max(columns[-1] - 1, 0), columns[-1])
    label, word = flow[1], flow[2]
    start = flow.start()
    if not label:
        hint = "write a number or a name in < > behind it, as in o100 or o<name>"
        begin = squeezed.index("o", start)
        return Fault("GS008", "an O-word without a label", at=(columns[begin], columns[begin] + 1), hint=hint)
    if word and word not in KEYWORDS:
        near = get_close_matches(word, KEYWORDS, n=1)
        return Fault(
            "GS008",
            f"`{word}` is no command of an O-word",
            at=(columns[flow.start(2)], columns[flow.end(2) - 1] + 1),
            hint=f"did you mean {near[0]}?" if near else f"known are {' '.join(KEYWORDS)}",
        )
    if "RSQB" in problem.expected and _is_open(squeezed) and (at == len(squeezed) or _NEXT.match(squeezed, at)):
        return _never_closed(squeezed, columns, at)
    if squeezed.count("[", 0, at) > squeezed.count("]", 0, at):
        return _explain_expression(squeezed, columns, at, problem, "")
    if word in _WITH_VALUE and re.match(r"[a-z0-9#.<+-]", squeezed[at : at + 1]):
        hint = f"its value stands in brackets, as in o{label} {word} [#1]"
        return Fault("GS008", f"`{squeezed[at]}` cannot stand here", at=here, hint=hint)
    return Fault("GS008", "this cannot stand in a line with an O-word", at=here, hint="put it on a line of its own")


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
    if "an operator" in names and "`/`" in names:
        names.remove("`/`")  # one of them
    return f"expected {', '.join(names)}" if names else ""


def _visible(char: str) -> str:
    return char if char.isprintable() else f"U+{ord(char):04X}"
