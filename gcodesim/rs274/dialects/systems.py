"""Where a control keeps its work systems: the nine of RS274, and more if its dialect has more."""

from __future__ import annotations

from functools import cache

from gcodesim.canon.systems import SYSTEMS
from gcodesim.rs274.dialects import DIALECTS
from gcodesim.rs274.parameters import FIRST_SYSTEM

APART = 20  # parameters from one system to the next


@cache
def first_of_system(index: int) -> int:
    """The parameter that holds X of a work system; the numbers of systems are those of `canon.systems`.

    Each dialect declares its further systems. No two have the same number, so the number alone says where X is, even
    while nobody knows in which dialect a program will be read. KeyError if no dialect has the system.
    """
    if 1 <= index <= len(SYSTEMS):
        return FIRST_SYSTEM + APART * (index - 1)
    block = next(block for block in DIALECTS[dialect_with(index)].further_systems if index in block.systems)
    return int(block.first + APART * block.systems.index(index))


def dialect_with(index: int) -> str:
    """The dialect that has a system besides the nine; KeyError if none has."""
    for name in (*DIALECTS.own(), *DIALECTS):
        if any(index in block.systems for block in DIALECTS[name].further_systems):
            return str(name)
    raise KeyError(index)
