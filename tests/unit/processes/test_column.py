"""Columns as processes declare them: names in each file, units, and the columns of a whole cell."""

from __future__ import annotations

from typing import ClassVar

import pytest

from gcodesim.processes import PROCESSES
from gcodesim.processes.column import FORCE, HOUSE, LINES, LOG, REMOVED, RESULTS, TORQUE, Column, Shown
from gcodesim.processes.protocol import Process
from gcodesim.processes.sheet import Sheet
from gcodesim.tools import TOOLS
from gcodesim.tools.tool import Tool


@pytest.mark.parametrize(
    ("column", "key", "field"),
    [
        (REMOVED, "removed_mm3", "removed_m3"),
        (FORCE, "max_force_N", "force_n"),
        (TORQUE, "max_torque_Nm", "torque_nm"),
        (Column("film", "m", "last"), "film_mm", "film_m"),
        (Column("flow", "m^3/s", "greatest"), "max_flow_mm3_s", "flow_m3_s"),
        (Column("heat", "J"), "heat_J", "heat_j"),
        (Column("dose", "W/m^2", "greatest"), "max_dose_W_m2", "dose_w_m2"),
        (Column("pictures"), "pictures", "pictures"),
        (Column("gripping", of="any"), "gripping_s", "gripping"),
    ],
)
def test_names_end_in_the_unit_of_the_file(column: Column, key: str, field: str) -> None:
    assert (column.key, column.field) == (key, field)


def test_a_length_is_shown_in_millimetres_and_an_unknown_unit_as_it_is() -> None:
    assert Column("depth", "m").divisor == 1e-3
    assert Column("heat", "J").divisor == 1.0
    assert Column("held", "m", of="any").divisor == 1.0  # a flag is counted in seconds


def test_a_name_that_no_file_could_hold_is_refused() -> None:
    for name in ("Film", "film thickness", "2nd", ""):
        with pytest.raises(ValueError, match="lower case"):
            Column(name)


def test_what_one_step_adds_up_and_what_many_keep() -> None:
    assert REMOVED.adds and TORQUE.adds
    assert not Column("depth", "m", of="greatest").adds


def test_a_cell_with_mills_and_nozzles_has_the_columns_of_both() -> None:
    mill = TOOLS["flat_end_mill"](number=1, diameter=1e-2)
    nozzle = TOOLS["extruder"](number=2, bead_width=1e-3, bead_height=1e-3)

    assert Sheet.of([]) == Sheet(kinds=("",), columns=HOUSE)
    assert Sheet.of([nozzle, mill]).kinds == Sheet.of([mill, nozzle]).kinds == ("", "milling", "extrusion")
    sheet = Sheet.of([mill, mill])
    assert sheet.columns[: len(HOUSE)] == HOUSE
    assert {"shank_depth", "rapid_cut"} <= {column.name for column in sheet.columns}
    assert "entry" not in {column.name for column in sheet.columns}  # shown to nobody
    assert [column.name for column in sheet.own(RESULTS)] == ["peak_force", "peak_torque"]
    logged = [column.name for column in sheet.own(LOG)]
    cut, tool_axes = ["axial_depth", "radial_width", "chip_thickness"], ["feed_force", "side_force", "axial_force"]
    assert logged == ["peak_force", "peak_torque", *cut, *tool_axes]
    assert sheet.own(LINES) == ()


def test_one_name_has_one_meaning(monkeypatch: pytest.MonkeyPatch) -> None:
    class First(Process):
        kind: ClassVar[str] = "first"
        writes: ClassVar[tuple[Column, ...]] = (Column("film", "m", "last"), Column("own", shown_in=Shown.NOWHERE))

    class Second(Process):
        kind: ClassVar[str] = "second"
        writes: ClassVar[tuple[Column, ...]] = (Column("film", "m^3"), Column("own", "m", shown_in=Shown.NOWHERE))

    class Both(Tool):
        processes: ClassVar[tuple[str, ...]] = ("first", "second")

    monkeypatch.setattr(PROCESSES, "_loaded", {"first": First, "second": Second})
    with pytest.raises(ValueError, match="`film` of second is another one in first"):
        Sheet.of([Both()])
