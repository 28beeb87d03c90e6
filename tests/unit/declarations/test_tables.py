"""Tables of what is declared."""

from __future__ import annotations

from gcodesim.declarations.tables import unit_table, units_as_text


def test_units_are_printed() -> None:
    assert unit_table()["length"]["plain"] and "in" in unit_table()["length"]["units"]
    assert "N·m/rad" in units_as_text() and "24000" not in units_as_text()
