"""What a log tells, whole, cut off or damaged."""

import numpy as np
import pytest

from gcodesim.log.logfile import LogFile, LogReadError
from gcodesim.log.reader import read_messages
from gcodesim.log.summary import summary
from tests.log_columns import read_columns

MS = 1_000_000


@pytest.fixture(scope="module")
def long_log(run, tmp_path_factory):
    """Several chunks."""
    return run.write(tmp_path_factory.mktemp("log") / "run.mcap", seconds=3.0, period_ns=2 * MS)


def test_the_summary_says_what_it_is_and_from_what_it_came(run, tmp_path):
    found = summary(run.write(tmp_path / "run.mcap"))

    assert found.complete and found.state == "finished" and found.verdict == "finished"
    assert found.problem == "" and found.duration_ns == 2000 * MS
    assert found.run["program"] == "part.nc" and found.run["log_format"] == "1"
    assert found.result == {"state": "finished", "duration_ns": "2000000000", "blocks": "6", "removed_m3": "2e-07"}
    assert found.events == {"note": 3, "warning": 0, "error": 1}
    assert found.attachments["program.nc"] == len(run.PROGRAM)
    tf = next(topic for topic in found.topics if topic.name == "/tf")
    assert (tf.schema, tf.count, tf.rate) == ("foxglove.FrameTransforms", 101, 50.5)


def test_an_interrupted_run_is_incomplete_although_its_file_is_whole(run, new_log, tmp_path):
    t = np.arange(10) * 20 * MS
    log = new_log(tmp_path / "run.mcap")
    log.program(50 * MS, file="sub.nc", line=14, text="G1 X30")
    log.window(t, **run.columns(t))
    log.event(180 * MS, "interrupted", "stopped by the user", severity="error", file="sub.nc", line=14)
    log.close(180 * MS, "failed")

    found = summary(tmp_path / "run.mcap")
    assert not found.complete and found.problem == "" and found.state == "interrupted"
    assert found.verdict == "incomplete, stopped at sub.nc:14"


def test_a_failed_run_names_its_line(run, new_log, tmp_path):
    log = new_log(tmp_path / "run.mcap")
    log.program(0, file="part.nc", line=4, text="G1 Z-1 F200")
    log.close(0, "failed")

    assert summary(tmp_path / "run.mcap").verdict == "failed at part.nc:4"


@pytest.mark.parametrize("seed", range(8))
def test_a_log_cut_off_anywhere_tells_all_up_to_its_last_whole_chunk(long_log, tmp_path, seed):
    whole = long_log.read_bytes()
    file = LogFile.open(long_log)
    # from the first chunk on: before it there is nothing to tell
    cut = int(np.random.default_rng(seed).integers(file.chunks[1].offset, len(whole) - 1))
    path = tmp_path / "cut.mcap"
    path.write_bytes(whole[:cut])
    found = summary(path)

    chunks = [chunk for chunk, after in zip(file.chunks, file.chunks[1:], strict=False) if after.offset <= cut]
    assert not found.complete and "ends before its index" in found.problem
    assert found.duration_ns >= chunks[-1].last_ns
    assert found.run == summary(long_log).run
    t = read_columns(path, "/wrench", ["force.x"])["t_ns"]
    expected = read_columns(long_log, "/wrench", ["force.x"])["t_ns"]
    assert len(t) > 0 and np.array_equal(t, expected[: len(t)]) and t[-1] >= chunks[-1].last_ns - 2 * MS


def test_damage_anywhere_is_told_or_harmless_and_never_a_crash(run, tmp_path):
    path = run.write(tmp_path / "run.mcap", seconds=1.0)
    truth = read_columns(path, "/process", ["force_n"])["force_n"]
    whole = path.read_bytes()
    rng = np.random.default_rng(11)
    refused = 0
    for _ in range(150):
        data = bytearray(whole)
        data[int(rng.integers(8, len(data)))] ^= 1 << int(rng.integers(8))
        path.write_bytes(data[: int(rng.integers(len(data) // 4, 2 * len(data)))])
        summary(path)
        try:
            found = read_columns(path, "/process", ["force_n"])["force_n"]
        except (LogReadError, KeyError):
            refused += 1
        else:
            assert np.array_equal(found, truth[: len(found)])
    assert 0 < refused < 150


def test_what_is_no_log_is_refused(tmp_path):
    (tmp_path / "a.mcap").write_text("G21\n")
    with pytest.raises(LogReadError, match="no log"):
        summary(tmp_path / "a.mcap")
    with pytest.raises(FileNotFoundError):
        summary(tmp_path / "b.mcap")
    (tmp_path / "empty.mcap").write_bytes(b"\x89MCAP0\r\n")
    assert summary(tmp_path / "empty.mcap").verdict == "incomplete"


@pytest.mark.parametrize("size", [0, 5, 8, 12])
def test_a_run_that_was_killed_at_its_very_begin_left_what_it_left(tmp_path, size):
    (tmp_path / "run.mcap.part").write_bytes(b"\x89MCAP0\r\n\x01\x00\x00\x00"[:size])
    log = LogFile.open(tmp_path / "run.mcap")
    assert (log.size, log.whole, log.complete, log.chunks) == (size, min(size, 8), False, [])
    assert summary(tmp_path / "run.mcap").missing[0] == "every message"


def test_columns_of_repeated_fields_have_an_axis(run, long_log):
    names = ["joints[2].position", "joints.position", "joints.name", "joints[arm/joint_3].position"]
    found = read_columns(long_log, "/joint_states", names)

    assert found["joints.position"].shape == (len(found["t_ns"]), 6)
    assert np.array_equal(found["joints[2].position"], found["joints.position"][:, 2])
    assert np.array_equal(found["joints[2].position"], found["joints[arm/joint_3].position"])
    assert found["joints.name"][0, 0] == "arm/joint_1"


@pytest.mark.parametrize(
    ("topic", "field", "error"),
    [
        ("/nothing", "x", KeyError),
        ("/process", "nothing", ValueError),
        ("/process", "force_n.x", ValueError),
        ("/process", "force_n[0]", ValueError),
        ("/joint_states", "joints[6].position", ValueError),
        ("/joint_states", "joints[arm/joint_7].position", ValueError),
    ],
)
def test_a_field_that_is_not_there_is_named(long_log, topic, field, error):
    with pytest.raises(error):
        read_columns(long_log, topic, [field])


def test_fields_that_come_unequally_often_are_refused(run, tmp_path):
    path = run.write(tmp_path / "run.mcap")
    with pytest.raises(ValueError, match="not equally many"):
        read_columns(path, "/scene/tool", ["entities.id"])


def test_attachments_and_messages_can_be_read(run, tmp_path):
    path = run.write(tmp_path / "run.mcap")
    assert LogFile.open(path).attachment("program.nc") == run.PROGRAM
    with pytest.raises(KeyError):
        LogFile.open(path).attachment("nothing")
    times = [t for t, _ in read_messages(path, "/scene/tool")]
    assert times == [0, 500 * MS]
    file = LogFile.open(path)
    some = [m.t_ns for m in file.messages([file.channel_id("/tf")], first_ns=30 * MS, last_ns=90 * MS)]
    assert some == [40 * MS, 60 * MS, 80 * MS]
    last = next(file.messages([file.channel_id("/program")], backwards=True))
    assert last.t_ns == 2000 * MS
