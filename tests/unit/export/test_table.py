"""A log as one table with units in its head."""

import csv
import io

import numpy as np
import pytest

from gcodesim.export.select import TimeRange
from gcodesim.export.table import NoTableError, seconds_text, write_table
from tests.log_columns import read_columns


def table(recording, topics=(), part=None, units="si"):
    out = io.StringIO()
    count = write_table(recording, out, topics, part, units)
    rows = list(csv.DictReader(io.StringIO(out.getvalue())))
    assert len(rows) == count
    return rows


def column(rows, name):
    return np.array([float(row[name]) for row in rows])


def test_numbers_are_those_of_the_log(slot):
    rows = table(slot)
    truth = read_columns(slot.log.path, "/process", ["force_n", "removed_m3"])

    assert np.array_equal(column(rows, "process.force_N"), truth["force_n"])
    assert np.array_equal(column(rows, "process.removed_m3"), truth["removed_m3"])
    assert np.array_equal(np.round(column(rows, "time_s") * 1e9).astype(int), truth["t_ns"])


def test_units_of_the_shop_floor_follow_in_name_and_number(slot):
    si, floor = table(slot), table(slot, units="mm")

    assert np.allclose(column(floor, "motion.x_mm"), 1e3 * column(si, "motion.x_m"), rtol=1e-8)
    assert np.allclose(column(floor, "process.spindle_rpm").max(), 8000.0)
    assert np.allclose(column(floor, "motion.feed_mm_min"), 60_000 * column(si, "motion.feed_m_s"), rtol=1e-8)
    assert "joint.machine/X.position_mm" in floor[0] and "joint.machine/X.position_m" in si[0]


def test_commands_stand_beside_what_was_reached_and_nothing_stands_twice(slot):
    rows = table(slot)

    assert np.allclose(column(rows, "target.x_m"), column(rows, "tcp.x_m"), atol=1e-9)
    assert np.array_equal(column(rows, "joint.machine/X.command_m"), column(rows, "joint.machine/X.position_m"))
    for units in ("si", "mm"):
        with io.StringIO() as out:
            write_table(slot, out, units=units)
            head = out.getvalue().splitlines()[0].split(",")
        assert len(set(head)) == len(head) and not any(name.endswith("_shown") for name in head)
    assert "motion.feed_mm_min" not in rows[0] and "process.removed_cm3" not in rows[0]


def test_each_row_names_the_line_that_runs(slot):
    rows = table(slot, ["/process"])
    # line 9 is the first cut along X
    begin, end = slot.timeline.span_of_lines(9, 9, slot.end_ns)
    inside = [row for row in rows if begin < float(row["time_s"]) * 1e9 < end]

    assert len(inside) > 100 and {(row["file"], row["line"], row["tool"]) for row in inside} == {("slot.nc", "9", "1")}
    assert {row["process.kind"] for row in rows} == {"", "milling"}


def test_a_part_of_the_time_at_a_period(slot):
    part = TimeRange(first_ns=5_000_000_000, last_ns=6_000_000_000, period_ns=100_000_000)

    times = column(table(slot, ["/motion"], part), "time_s")

    assert np.allclose(times, np.arange(5.0, 6.05, 0.1))


def test_events_are_a_table_of_their_own(slot):
    rows = table(slot, ["/event"])

    assert [row["code"] for row in rows if row["code"] == "toolchange"]
    assert {"time_s", "code", "severity", "file", "line", "message"} <= set(rows[0])


@pytest.mark.parametrize("topics", [["/nothing"], ["/event", "/process"], ["/scene/cell"], ["/program", "/event"]])
def test_what_makes_no_table_is_refused(slot, topics):
    with pytest.raises(NoTableError):
        table(slot, topics)


def test_times_keep_all_their_digits():
    assert seconds_text(3_600_000_000_001) == "3600.000000001"


def test_a_period_takes_the_first_of_each_slot():
    t_ns = np.array([0, 10, 20, 35, 50, 51, 90])

    assert TimeRange(period_ns=20).chosen(t_ns).tolist() == [0, 2, 4, 6]
    assert TimeRange(first_ns=20, last_ns=50).chosen(t_ns).tolist() == [2, 3, 4]
    assert TimeRange(first_ns=100).chosen(t_ns).tolist() == []
