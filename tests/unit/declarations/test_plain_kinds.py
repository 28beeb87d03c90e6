"""Values without a unit."""

from __future__ import annotations

from typing import Any

import pytest

from gcodesim.declarations.kind import Kind, Range
from gcodesim.declarations.plain_kinds import Choice, Switch, Text, Whole
from gcodesim.declarations.reading import UNREAD
from tests.unit.declarations.text import codes, read

TEETH = Whole(Range(least=1.0, most=10.0))
SIDE = Choice(("tool", "table"))


@pytest.mark.parametrize(
    ("kind", "text", "value"),
    [
        (TEETH, "3", 3),
        (Switch(), "true", True),
        (Text(), "on", "on"),
        (Text("[a-z]+"), "abc", "abc"),
        (SIDE, "tool", "tool"),
    ],
)
def test_values(kind: Kind, text: str, value: Any) -> None:
    assert read(kind, text)[0] == value


@pytest.mark.parametrize(
    ("kind", "text", "code", "hint"),
    [
        (TEETH, "3.5", "GS707", ""),
        (TEETH, "11", "GS710", ""),
        (Switch(), "on", "GS706", "`on` is a text in YAML 1.2"),
        (Text("[a-z]+", "small letters"), "ABC", "GS711", ""),
        (SIDE, "tabel", "GS711", "did you mean `table`?"),
    ],
)
def test_faults(kind: Kind, text: str, code: str, hint: str) -> None:
    value, to = read(kind, text)

    assert value is UNREAD and codes(to) == [code]
    assert next(iter(to.findings)).hint.startswith(hint)
