"""Slips of keyboards, posts and word processors: what was probably meant where a line cannot be read."""

from __future__ import annotations

import re
import unicodedata

_HERE = "\x00"
_UNITS = "numbers carry no unit: G21 says millimetres, G20 inches"
_SLIPS: tuple[tuple[re.Pattern[str], str], ...] = tuple(
    (re.compile(pattern.replace("|>", _HERE)), hint)
    for pattern, hint in (
        (r",|>a", ",A, the angle of a move, is not simulated: write both coordinates of its end"),
        (r"([0-9]*)|>,([0-9]+)", "the decimal sign is a point: write {0}.{1}"),
        (r"([0-9.]+)|>_([0-9]+)", "digits are not grouped: write {0}{1}"),
        (r"(?<![a-z])([gm]) ?|>o([0-9.]*)(?![a-z<\[])", "is it the letter O? Write the digit 0: {0}0{1}"),
        (r"([0-9.]*) ?|>o([0-9.]*)(?![a-z<\[])", "is it the letter O? Write the digit 0: {0}0{1}"),
        (r"(?<![a-z])[a-np-z]([0-9.]+)o ?|>(?![<\[])", "is it the letter O? Write the digit 0: {0}0"),
        (r"([0-9.]+)l ?|>", "is it the letter? Write the digit 1: {0}1"),
        (r"(?<![a-z])([a-z])|>([li])([0-9.]*)(?![a-z])", "is it the letter {1}? Write the digit 1: {0}1{2}"),
        (r"[0-9.](?:(?:mm|m|in)|>| ?(?:m|>m|i|>n|mm|>|in|>))", _UNITS),
        (r"[0-9.] ?|>(?:\"(?! ?[a-z])|in|mm)", _UNITS),
        (r"(?<![a-z])([a-z])|>=", "a word is a letter and its number, without `=`"),
        (r"#([0-9]+) ?|>([0-9.]+)", "write #{0}={1}"),
        (r"(?<![a-z])([a-z][0-9.]+) ?|>\]", "there is no `[` before: write it behind the letter"),
        (r"[0-9.] ?|>([-+/*])(?=[0-9.#\[])(?![^=]*=)", "what is to be computed stands in brackets, as in [2{0}1]"),
        (r"|>[/{}'\"#*:\\]|# ?|>[a-z]|\x00[!~?&=_]+ ?[a-z]{2}", "a comment stands in parentheses, or behind `;`"),
        (r"|>\)", "there is no `(` before it"),
        (r"[0-9]*\.[0-9]*|>\.", "a number has one decimal point"),
        (r"|>%", "a % stands alone in the first line of a program and in the last"),
        (r"\A ?|>[0-9.]", "a number belongs behind a letter, as in X{here}"),
    )
)
# letters of other alphabets that look like ours, and characters that word processors substitute
_TWINS = dict(zip("АВСЕНІЈКМОРЅТХУаеорсхуіјΑΒΕΖΗΙΚΜΝΟΡΤΥΧ", "ABCEHIJKMOPSTXYaeopcxyijABEZHIKMNOPTYX", strict=True))
_SIGNS = {**dict.fromkeys("\u2010\u2011\u2012\u2013\u2014\u2212\ufe63", "-"), "\u00d7": "*", "\u2044": "/"}
_QUOTES = "\u2018\u2019\u201a\u201c\u201d\u201e\u00ab\u00bb\u00b4\u2032\u2033"


def slip_at(squeezed: str, columns: list[int], at: int) -> str:
    """What was probably meant if the character at `at` of a prepared line is not allowed there; else empty."""
    if at < len(squeezed) and not squeezed[at].isascii():
        return _foreign(squeezed[at])
    marked = ""
    for index, char in enumerate(squeezed):
        marked += " " if index and columns[index] > columns[index - 1] + 1 else ""
        marked += _HERE if index == at else ""
        marked += char
    marked += _HERE if at == len(squeezed) else ""
    for pattern, hint in _SLIPS:
        match = pattern.search(marked)
        if match is not None:
            return hint.format(*((group or "").upper() for group in match.groups()), here=squeezed[at : at + 1])
    return ""


def _foreign(char: str) -> str:
    """What to type in place of a foreign character."""
    code = f"U+{ord(char):04X}"
    if char == "\ufeff":
        return f"{code} is a mark that an editor leaves behind: delete it"
    if char in _QUOTES:
        return "a comment stands in parentheses, or behind `;`"
    if unicodedata.category(char) in ("Zs", "Cf"):
        return f"{code} only looks like a blank: type it anew"
    twin = _SIGNS.get(char) or _TWINS.get(char) or unicodedata.normalize("NFKC", char)
    if len(twin) == 1 and twin.isascii():
        return f"{code} only looks like `{twin}`: type it anew"
    return "only plain digits and letters are read outside comments"
