"""Kinds made of other kinds."""

from __future__ import annotations

import math

from gcodesim.declarations.composed import Either, ListOf
from gcodesim.declarations.kind import POSITIVE
from gcodesim.declarations.plain_kinds import Text
from gcodesim.declarations.quantity import Quantity
from gcodesim.declarations.reading import UNREAD
from tests.unit.declarations.text import codes, read

EFFORT = Either((("none", math.inf),), Quantity("force", POSITIVE))


def test_each_entry_of_a_list_is_read_for_itself() -> None:
    forces = ListOf(Quantity("force", POSITIVE))

    assert read(forces, "[1 N, 2 kN]")[0] == (1.0, 2000.0) and read(forces, "[]")[0] == ()
    assert codes(read(forces, "[0 N, 2, 3 W]")[1]) == ["GS710", "GS708", "GS709"]
    assert codes(read(forces, "1 N")[1]) == ["GS706"]


def test_a_single_one_may_stand_without_brackets() -> None:
    assert read(ListOf(Text(), single=True), "a")[0] == ("a",)


def test_a_word_stands_for_a_value() -> None:
    assert read(EFFORT, "none")[0] == math.inf and read(EFFORT, "3 N")[0] == 3.0
    value, to = read(EFFORT, "non")
    assert value is UNREAD and codes(to) == ["GS707"]
    assert EFFORT.show(math.inf) == "none" and EFFORT.plain(math.inf) == ("_N", "none") and EFFORT.show(3.0) == "3 N"
