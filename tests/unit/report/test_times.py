"""The parts of the time add up."""

import pytest

from gcodesim.report.times import slowest, time_report


@pytest.fixture
def report(slot):
    return time_report(slot)


def test_each_way_of_dividing_adds_up_to_the_total(report, slot):
    assert report.total == pytest.approx(slot.results["time"]["total_s"], abs=1e-9)
    for parts in (report.lines, report.tools, report.layers):
        assert sum(part.seconds for part in parts) == pytest.approx(report.total, abs=1e-9)


def test_lines_have_their_time_with_dwell_and_tool_change(report, slot):
    by_line = {line.line: line for line in report.lines}

    assert by_line[19].text == "G1 Z-3 F300" and by_line[19].seconds == pytest.approx(5 / 300 * 60, rel=0.02)
    assert by_line[20].text == "G4 P0.5" and by_line[20].seconds == pytest.approx(0.5)
    assert by_line[14].text == "T2 M6" and by_line[14].seconds == pytest.approx(4.0)
    assert by_line[9].removed == pytest.approx(120e-9, rel=0.15)  # 20 mm × 6 mm × 1 mm
    csv = {int(row["line"]): row for row in slot.line_rows}
    assert by_line[9].seconds == pytest.approx(float(csv[9]["time_s"]), abs=1e-5)
    assert by_line[9].force == pytest.approx(float(csv[9]["max_force_N"]), rel=0.1)


def test_tools_have_the_time_of_their_change(report, slot):
    first, second = report.tools

    assert (first.number, second.number) == (1, 2)
    assert second.seconds > 4.0 and second.engaged < second.seconds
    assert first.removed + second.removed == pytest.approx(
        slot.results["stocks"]["stock"]["removed_mm3"] * 1e-9, rel=1e-6
    )


def test_heights_at_which_work_was_done_are_layers(report):
    # 20 mm at 400 mm/min along X, at Z−1 and at Z−2, where what comes later at no height of its own is added: a hole
    levels = {round(layer.z * 1e3, 3): layer.engaged for layer in report.layers}

    assert levels[-1.0] == pytest.approx(3.0, abs=0.25)
    assert levels[-2.0] == pytest.approx(3.0 + 0.75, abs=0.25)


def test_the_slowest_come_first(report):
    top = slowest(report.lines, 3)

    assert len(top) == 3 and top[0].seconds >= top[1].seconds >= top[2].seconds
    assert all(line.seconds <= top[2].seconds for line in report.lines if line not in top)


def test_json_has_units_in_its_names(report):
    value = report.as_json()

    assert value["total_s"] == pytest.approx(report.total)
    assert {"number", "name", "time_s", "engaged_s", "removed_mm3", "max_force_N", "max_power_W"} == set(
        value["tools"][0]
    )


def test_a_block_counts_once_whatever_states_it_goes_through(report, slot):
    by_line = {line.line: line for line in report.lines}

    assert by_line[14].count == 1  # the tool change, which stops and goes on
    assert all(line.count == 1 for line in report.lines)  # no loop in this program, and its end counts once


def test_the_greatest_of_a_tool_is_that_of_the_results(report, slot):
    for tool, known in zip(report.tools, slot.results["tools"], strict=True):
        assert (tool.force, tool.power) == pytest.approx((known["max_force_N"], known["max_power_W"]))
