"""Tables of what is declared."""

from __future__ import annotations

from gcodesim.declarations.tables import units_as_text


def test_units_are_printed() -> None:
    (length,) = (line for line in units_as_text().splitlines() if line.startswith("length "))
    assert " in (" in length and "or a plain number" in length
    assert "N·m/rad" in units_as_text() and "24000" not in units_as_text()
