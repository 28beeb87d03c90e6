"""Logs as tables and as lines of JSON."""

import csv
import io
import json

import numpy as np
import pytest

from gcodesim.log.export import seconds_text, write_csv, write_json_lines
from gcodesim.log.reader import read_columns


@pytest.fixture(scope="module")
def log(run, tmp_path_factory):
    return run.write(tmp_path_factory.mktemp("log") / "run.mcap")


def table(log, topic, fields=()):
    out = io.StringIO()
    count = write_csv(log, topic, out, fields)
    rows = list(csv.reader(io.StringIO(out.getvalue())))
    assert len(rows) == count + 1
    return rows


def test_numbers_survive_the_table(log):
    rows = table(log, "/wrench", ["force.x", "torque.z"])
    truth = read_columns(log, "/wrench", ["force.x", "torque.z"])

    assert rows[0] == ["time_s", "force.x", "torque.z"]
    assert rows[2][0] == "0.020000000"
    assert np.array_equal([float(row[1]) for row in rows[1:]], truth["force.x"])
    assert np.array_equal([float(row[2]) for row in rows[1:]], truth["torque.z"])


def test_without_fields_a_table_has_all_of_a_topic(log):
    assert table(log, "/process")[0] == (
        ["time_s", "kind", "engaged", "spindle_rad_s", "force_n", "torque_nm", "power_w", "removal_m3_s", "removed_m3"]
    )
    header = table(log, "/joint_states")[0]
    assert "joints[arm/joint_3].position" in header and len(header) == 1 + 6 * 4  # name, position, velocity, effort


def test_items_can_be_named(log):
    by_name = table(log, "/tf", ["transforms[tool].translation.z"])
    by_number = table(log, "/tf", ["transforms[7].translation.z"])

    assert by_name[1:] == by_number[1:]


def test_texts_with_commas_stay_whole(log):
    texts = [row[1] for row in table(log, "/program", ["text"])]
    assert texts[1:] == [*["G21 G90", "T1 M6", "G0 X0 Y0 Z5", "G1 Z-1 F200", "G1 X30", "M2", "M2"]]


@pytest.mark.parametrize("field", ["joints.position", "joints", "nothing", "joints[7].name", "joints[", "", "a..b"])
def test_what_is_no_single_value_is_refused(log, field):
    with pytest.raises(ValueError):
        table(log, "/joint_states", [field])


def test_json_lines_hold_topic_time_and_message(log):
    out = io.StringIO()
    count = write_json_lines(log, out, ["/program", "/event"])
    lines = [json.loads(line) for line in out.getvalue().splitlines()]

    assert len(lines) == count == 11
    assert [line["t_ns"] for line in lines] == sorted(line["t_ns"] for line in lines)
    start = next(line for line in lines if line["topic"] == "/event")
    assert start["message"]["code"] == "start" and start["message"]["line"] == 0
    everything = io.StringIO()
    assert write_json_lines(log, everything) > 700
    with pytest.raises(KeyError):
        write_json_lines(log, everything, ["/nothing"])


def test_times_keep_all_their_digits():
    assert seconds_text(3_600_000_000_001) == "3600.000000001"
