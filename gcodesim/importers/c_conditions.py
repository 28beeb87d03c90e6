"""Which lines of a C header hold, as far as its conditions ask for what the header itself defines."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Final

from gcodesim.importers.importer import number_in

_DIRECTIVE: Final = re.compile(r"\s*#\s*(if|ifdef|ifndef|elif|else|endif)\b(.*)")
_TOKEN: Final = re.compile(r"\s*(&&|\|\||[!(),]|[A-Za-z_]\w*|\d+)")
_OFF: Final = ("0", "false")
_ASK: Final[Mapping[str, Callable[[list[bool]], bool]]] = {
    **dict.fromkeys(("ENABLED", "ALL", "BOTH"), all),
    **dict.fromkeys(("ANY", "EITHER"), any),
    **dict.fromkeys(("DISABLED", "NONE"), lambda found: not any(found)),
}
"""Macros of Marlin (`Marlin/src/core/macros.h`) by whether their options are on: defined, and neither 0 nor false."""


class _UnknownError(Exception):
    """The condition asks for something else than the header defines."""


@dataclass(slots=True)
class CConditions:
    """The conditions around a line. What is not known counts as true, and so do the branches behind it."""

    _held: list[bool] = field(default_factory=list)
    _taken: list[bool | None] = field(default_factory=list)  # whether a branch before held; None: not known

    def take(self, line: str, defined: Mapping[str, str]) -> bool:
        """Whether a line, without comments, holds; `defined` are the names that hold before it, with their texts."""
        found = _DIRECTIVE.match(line)
        if found is None:
            return all(self._held)
        word, rest = found.groups()
        if word in ("if", "ifdef", "ifndef"):
            asks = {"if": rest, "ifdef": f"defined({rest})", "ifndef": f"!defined({rest})"}[word]
            answer = _answer(asks, defined)
            self._held.append(answer is not False)
            self._taken.append(answer)
        elif self._held and word == "endif":
            self._held.pop()
            self._taken.pop()
        elif self._held:
            before = self._taken[-1]
            answer = True if word == "else" else _answer(rest, defined)
            self._held[-1] = before is not True and answer is not False
            self._taken[-1] = True if before or answer else None if None in (before, answer) else False
        return False


def _answer(text: str, defined: Mapping[str, str]) -> bool | None:
    tokens = _TOKEN.findall(text)
    if "".join(tokens) != re.sub(r"\s", "", text):
        return None
    try:
        value = _either(tokens, defined)
    except (_UnknownError, IndexError):
        return None
    return value if not tokens else None


def _either(tokens: list[str], defined: Mapping[str, str]) -> bool:
    value = _both(tokens, defined)
    while tokens[:1] == ["||"]:
        tokens.pop(0)
        value = _both(tokens, defined) or value
    return value


def _both(tokens: list[str], defined: Mapping[str, str]) -> bool:
    value = _one(tokens, defined)
    while tokens[:1] == ["&&"]:
        tokens.pop(0)
        value = _one(tokens, defined) and value
    return value


def _one(tokens: list[str], defined: Mapping[str, str]) -> bool:
    word = tokens.pop(0)
    if word == "!":
        return not _one(tokens, defined)
    if word == "(":
        value = _either(tokens, defined)
        if tokens.pop(0) != ")":
            raise _UnknownError
        return value
    if word == "defined" or (word in _ASK and tokens[:1] == ["("]):
        names = _names(tokens)
        if word == "defined":
            return names[0] in defined
        return _ASK[word]([defined.get(name, _OFF[0]) not in _OFF for name in names])
    value_of = number_in(defined.get(word, word))
    if value_of is None:
        raise _UnknownError
    return value_of != 0.0


def _names(tokens: list[str]) -> list[str]:
    """The names behind `defined` or in the brackets of a macro."""
    if tokens[0] != "(":
        return [tokens.pop(0)]
    end = tokens.index(")") if ")" in tokens else 0
    names = [token for token in tokens[1:end] if token != ","]
    del tokens[: end + 1]
    if not names:
        raise _UnknownError
    return names
