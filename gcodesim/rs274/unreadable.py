"""Why a line cannot be read: the finding for a line that breaks the grammar, with the slip that it may be."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from gcodesim.rs274.block import Place
from gcodesim.rs274.fault import Fault

if TYPE_CHECKING:
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
    "SLASH": "`/`",
    "$END": "the end of the line",
    "NAME": "`<name>`",
}


def explain(problem: Unreadable, squeezed: str, columns: list[int]) -> Fault:
    """The finding for a line that breaks the grammar; `columns` are those of the characters of `squeezed`."""
    fault = _explain(problem, squeezed, columns)
    slip = _slip(squeezed, columns, min(problem.column, len(squeezed)))
    if slip and not _in_flow(squeezed):
        fault.hint = slip
    return fault


def _slip(squeezed: str, columns: list[int], at: int) -> str:
    """What was probably meant, when the character at `at` of a prepared line cannot stand there; else empty."""
    marked = ""
    for index, char in enumerate(squeezed):
        marked += _HERE if index == at else ""
        marked += " " if index and columns[index] > columns[index - 1] + 1 and index != at else ""
        marked += char
    marked += _HERE if at == len(squeezed) else ""
    for pattern, hint in _SLIPS:
        match = pattern.search(marked)
        if match is not None:
            return hint.format(*(group or "" for group in match.groups()))
    return ""


_HERE = "\x00"
_SLIPS: tuple[tuple[re.Pattern[str], str], ...] = tuple(
    (re.compile(pattern.replace("|>", _HERE)), hint)
    for pattern, hint in (
        (r"([0-9]*)|>,([0-9]+)", "the decimal sign is a point: write {0}.{1}"),
        (r"([0-9.]+)|>_([0-9]+)", "digits are not grouped: write {0}{1}"),
        (r"([0-9.]*)|>o([0-9.]*)(?![a-z<\[])", "is it the letter O? Write the digit 0: {0}0{1}"),
        (r"([0-9.]+)l|>", "is it the letter? Write the digit 1: {0}1"),
        (r"(?<![a-z])[a-z]|>[li]([0-9.]*)", "is it the letter? Write the digit 1: 1{0}"),
        (r"[0-9.](?:mm|m|in|i)|>", "numbers carry no unit: G21 says millimetres, G20 inches"),
        (r"[0-9.]|>(?:\"|in|mm)", "numbers carry no unit: G21 says millimetres, G20 inches"),
        (r"(?<![a-z])([a-z])|>=", "a word is a letter and its number, without `=`"),
        (r"|>[/{}'#*:]|#|>[a-z ]", "a comment stands in parentheses, or behind `;`"),
        (r"|>[^\x00-\x7f]", "only plain digits and letters are read outside comments"),
    )
)


def _explain(problem: Unreadable, squeezed: str, columns: list[int]) -> Fault:
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
