"""Arguments of G65, G66 and G66.1: which letter gives which variable."""

from __future__ import annotations

from gcodesim.rs274.fault import Fault

_NUMBERS = (1, 2, 3, 7, 8, 9, 11, 4, 5, 6, 13, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26)
LIST_ONE = dict(zip("abcdefhijkmqrstuvwxyz", _NUMBERS, strict=True))
_EVERY_BLOCK = {**LIST_ONE, "g": 10, "l": 12, "p": 16}  # G66.1 takes whole blocks
_FIRST_OF_LIST_TWO = 4
_MOST_TRIPLES = 10


def arguments_of(
    words: list[tuple[str, float]], places: list[tuple[int, int]], *, whole: bool = False
) -> dict[int, float]:
    """Variables by number. I, J, K more than once, or out of their order, are list II: #4 to #33 in triples.

    List I and II may be mixed; where both give a variable, the later word wins.
    `whole` also takes G, L and P, as G66.1 does. Raises `Fault` for a letter
    that cannot be an argument.
    """
    table = _EVERY_BLOCK if whole else LIST_ONE
    variables: dict[int, float] = {}
    triple, last = 0, ""
    for (letter, value), place in zip(words, places, strict=True):
        if letter in "ijk":
            if last and letter <= last:
                triple += 1
            last = letter
            if triple >= _MOST_TRIPLES:
                raise Fault("GS133", f"more than {_MOST_TRIPLES} groups of I, J, K", at=place, limit=_MOST_TRIPLES)
            variables[_FIRST_OF_LIST_TWO + 3 * triple + "ijk".index(letter)] = value
            continue
        number = table.get(letter)
        if number is None:
            raise Fault("GS106", f"{letter.upper()} cannot be an argument of a macro", at=place)
        variables[number] = value
    return variables
