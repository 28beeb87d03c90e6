"""The words of one block with their values: which codes it names, and whether they may stand together."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from typing import Final

from gcodesim.rs274.block import Block, ColumnRange
from gcodesim.rs274.dialects import DIALECTS, Dialect, g_name
from gcodesim.rs274.dialects.linuxcnc import CANCEL_CYCLES, USER
from gcodesim.rs274.expressions import checked
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.parameters import Parameters

_NEVER_NEGATIVE: Final = frozenset("fhlst")
_WHY_NOT_NEGATIVE: Final = {"f": "F says how fast; where to is said by the axes", "s": "M4 turns the other way round"}
_WHOLE: Final = frozenset("hlt")
_OVERWRITTEN: Final = frozenset("@^")  # of these the last one counts, as on the control
AXIS_LETTERS: Final = frozenset("xyzabcuvw")
_EXPONENT: Final = re.compile(r"(?:[0-9]+\.?[0-9]*|\.[0-9]+)[Ee][+-]?[0-9]{1,2}(?![0-9])")


class Words:
    """Values by letter, G codes (times ten) and M codes by modal group, and their names in the form of `users`."""

    __slots__ = ("block", "g", "m", "m_codes", "names", "values")

    def __init__(self, block: Block) -> None:
        self.block = block
        self.values: dict[str, float] = {}
        self.g: dict[int, int] = {}
        self.m: dict[int, int] = {}
        self.m_codes: list[int] = []
        self.names: set[str] = set()

    def get(self, letter: str) -> float | None:
        return self.values.get(letter)

    def has_axes(self) -> bool:
        return not AXIS_LETTERS.isdisjoint(self.values) or self.has_polar()

    def has_polar(self) -> bool:
        return "@" in self.values or "^" in self.values

    def need(self, letter: str, code: str, who: str, hint: str = "") -> float:
        """The value of `letter`, or a fault because `who` needs it."""
        value = self.values.get(letter)
        if value is None:
            raise Fault(code, f"{who} needs the word {letter.upper()}", at=who.split(" ")[0].lower(), hint=hint)
        return value

    def whole(self, letter: str, who: str, code: str = "GS106") -> int | None:
        """The value of `letter` as a whole number; a fault when it is not near one."""
        value = self.values.get(letter)
        if value is None:
            return None
        number = round(value)
        if abs(value - number) > 1e-4:
            raise Fault(code, f"{letter.upper()} of {who} must be a whole number, not {value:g}", at=letter)
        return number


def read_words(
    block: Block, dialect: Dialect, parameters: Parameters, mapped: Mapping[str, object], has_cell: bool
) -> Words:
    """Evaluate the words of `block` from left to right, and check what can be checked without the state.

    Raises `Fault` at the first word that cannot stand.
    """
    words = Words(block)
    values = words.values
    for position, (letter, node) in enumerate(block.words):
        value = node if type(node) is float and -1e30 < node < 1e30 else _value(block, position, node, parameters)
        if letter == "g":
            _add_g(words, position, value, dialect)
        elif letter == "m":
            _add_m(words, position, value, dialect, mapped, has_cell)
        else:
            if letter in values and letter not in _OVERWRITTEN:
                raise Fault(
                    "GS009",
                    f"{letter.upper()} stands twice in the block",
                    at=block.places[position],
                    hint="drop one, or put the second into a block of its own",
                )
            if letter not in dialect.letters:
                hint = exponent(block) if letter == "e" else ""
                hint = hint or elsewhere(lambda other, word=letter: word in other.letters, dialect)  # type: ignore[misc]
                message = f"{dialect.name} has no {letter.upper()} word"
                raise Fault("GS001", message, at=block.places[position], hint=hint)
            if value < 0.0 and letter in _NEVER_NEGATIVE:
                hint = _WHY_NOT_NEGATIVE.get(letter, "")
                message = f"{letter.upper()} is negative: {value:g}"
                raise Fault("GS106", message, at=block.places[position], hint=hint, value=value)
            if letter in _WHOLE and abs(value - round(value)) > 1e-4:
                raise Fault(
                    "GS106", f"{letter.upper()} must be a whole number, not {value:g}", at=block.places[position]
                )
            values[letter] = value
    if len(words.m_codes) > dialect.most_m_codes:
        raise Fault(
            "GS014",
            f"{len(words.m_codes)} M codes in one block; {dialect.most_m_codes} are allowed",
            hint="spread them over two blocks",
        )
    return words


def check_use(words: Words, dialect: Dialect, motion: str) -> None:
    """Every word must be used by a code of the block, or by the motion that goes on."""
    for letter in words.values:
        if not is_used(words, letter, dialect, motion):
            users = dialect.users[letter]
            if letter == "$" and "s" in words.values:
                continue
            who = " ".join(sorted((u.upper() for u in users if u != "user"), key=_code_order))
            hint = f"{letter.upper()} belongs to {who}"
            if letter == "e":
                hint = exponent(words.block) or hint
            raise Fault("GS104", f"nothing in this block uses the word {letter.upper()}", at=letter, hint=hint)


def is_used(words: Words, letter: str, dialect: Dialect, motion: str) -> bool:
    """Whether a code of the block, or the motion that goes on, uses `letter`."""
    users = dialect.users.get(letter)
    return users is None or motion in users or not words.names.isdisjoint(users)


def exponent(block: Block) -> str:
    """What to write in place of 1.5e3; empty if the line has no such number."""
    number = _EXPONENT.search(block.text)
    return "" if number is None else f"numbers have no exponent: write {float(number.group()):.12g}"


def elsewhere(knows: Callable[[Dialect], bool], own: Dialect) -> str:
    """A hint at other dialects that know something; empty if none does."""
    names = [name for name in DIALECTS if name != own.name and knows(DIALECTS[name])]
    names = [name for name in names if not any(name.startswith(f"{other}_") for other in names)]  # a kind of another
    if not names:
        return ""
    return f"{' and '.join(names)} {'know' if len(names) > 1 else 'knows'} it (--dialect {names[0]})"


def _code_order(name: str) -> tuple[str, float]:
    return name[0], float(name[1:])


def place_of(block: Block, at: ColumnRange | str | None) -> ColumnRange | None:
    """Columns of what a fault names: a place, a letter, or a code such as `g43`."""
    if at is None or isinstance(at, tuple):
        return at
    if len(at) == 1 or at[0] == ",":
        return block.place_of(at)
    for (letter, value), place in zip(block.words, block.places, strict=False):
        if letter == at[0] and type(value) is float and abs(value - float(at[1:])) < 1e-6:
            return place
    return None


def _value(block: Block, position: int, node: object, parameters: Parameters) -> float:
    try:
        return checked(node, parameters)  # type: ignore[arg-type]
    except Fault as fault:
        fault.at = block.places[position]
        raise


def _add_g(words: Words, position: int, value: float, dialect: Dialect) -> None:
    tenths = round(value * 10.0)
    group = dialect.g_groups.get(tenths)
    if group is None or abs(value * 10.0 - tenths) > 1e-3:
        shown = f"G{value:g}"
        if tenths in dialect.unsimulated and abs(value * 10.0 - tenths) <= 1e-3:
            raise Fault(
                "GS915",
                f"{shown} is not simulated: {dialect.unsimulated[tenths]}",
                at=words.block.places[position],
                hint="without it the moves behind it would be others than on the control",
            )
        raise Fault(
            "GS012",
            f"{shown} is no G code of {dialect.name}",
            at=words.block.places[position],
            hint=_near_g(value, dialect),
        )
    other = words.g.get(group)
    if other is not None and other != CANCEL_CYCLES:
        raise Fault(
            "GS011",
            f"{g_name(other).upper()} and {g_name(tenths).upper()} exclude each other in one block",
            at=words.block.places[position],
            hint="they belong to one modal group; keep one",
        )
    words.g[group] = tenths
    words.names.add(g_name(tenths))


def _near_g(value: float, dialect: Dialect) -> str:
    """A hint at dialects that know the code, or at similar codes."""
    tenths = round(value * 10.0)
    if abs(value * 10.0 - tenths) <= 1e-3 and (others := elsewhere(lambda other: tenths in other.g_groups, dialect)):
        return others
    whole = sorted(code for code in dialect.g_groups if code // 10 == int(value)) if value >= 0 else []
    if not whole and value >= 100.0 and value.is_integer():
        return "is a letter missing, or a blank between two codes?"
    names = [g_name(code).upper() for code in whole]
    return f"did you mean {names[0]}?" if len(names) == 1 else f"known are {', '.join(names)}" if names else ""


def _add_m(
    words: Words, position: int, value: float, dialect: Dialect, mapped: Mapping[str, object], has_cell: bool
) -> None:
    number = round(value)
    if value < 0.0 or abs(value - number) > 1e-4:
        raise Fault("GS013", f"M{value:g} is no M code: it must be a whole number", at=words.block.places[position])
    group = dialect.m_groups.get(number)
    is_mapped = any(key == f"M{number}" or key.startswith(f"M{number} ") for key in mapped)
    of_user = number in dialect.user_m_codes and (has_cell or dialect.open_m_codes)
    if group is None and (is_mapped or of_user or number in dialect.tip_m_codes):
        group = USER
    if group is None:
        hint = "map it in the cell under `m_codes`"
        if others := elsewhere(lambda other: number in other.m_groups, dialect):
            hint = others
        if number in dialect.user_m_codes:
            hint = "a control runs a program of its own for it; " + hint
        raise Fault("GS013", f"M{number} is no M code of {dialect.name}", at=words.block.places[position], hint=hint)
    other = words.m.get(group)
    if other is not None:
        raise Fault(
            "GS011",
            f"M{other} and M{number} exclude each other in one block",
            at=words.block.places[position],
            hint="put one of them into a block of its own",
        )
    words.m[group] = number
    words.m_codes.append(number)
    words.names.add(f"m{number}")
    if group == USER:
        words.names.add("user")
