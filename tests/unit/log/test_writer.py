"""A log holds to the table of topics, whatever the order in which its messages were given."""

import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from gcodesim.log import BlockColumns, BlockMessages, ByteStrings, ProgramShown
from gcodesim.log.logfile import LogFile
from gcodesim.log.reader import read_messages
from gcodesim.log.summary import summary
from tests.log_columns import read_columns

MS = 1_000_000


def test_a_run_passes_the_checker(run, complaints, tmp_path):
    assert complaints(run.write(tmp_path / "run.mcap")) == []


@pytest.mark.parametrize("window", [1, 7, 101, 4000])
def test_the_bytes_do_not_depend_on_the_windows(run, complaints, tmp_path, window):
    path = run.write(tmp_path / "a.mcap", window=window)

    assert complaints(path) == []
    assert path.read_bytes() == run.write(tmp_path / "b.mcap").read_bytes()


def test_another_process_with_other_hashes_writes_the_same_bytes(run, tmp_path):
    script = Path(run.__file__)
    for seed in ("1", "2"):
        folder = tmp_path / seed
        folder.mkdir()
        env = {"PYTHONHASHSEED": seed, "PATH": ""}
        subprocess.run([sys.executable, str(script), "run.mcap"], check=True, cwd=folder, env=env)

    assert (tmp_path / "1" / "run.mcap").read_bytes() == (tmp_path / "2" / "run.mcap").read_bytes()


def test_many_chunks_pass_the_checker(run, complaints, tmp_path):
    """20 s at 1 kHz are tens of megabytes in as many chunks."""
    path = run.write(
        tmp_path / "run.mcap",
        seconds=4.0,
        period_ns=MS,
        run={**run.description().run, "log_period_ns": str(MS)},
    )

    assert complaints(path) == []
    assert len(LogFile.open(path).chunks) > 5


def test_a_process_that_goes_on_and_off_keeps_every_instant(run, complaints, tmp_path):
    kinds = np.random.default_rng(7).integers(0, 3, 101)
    path = run.write(tmp_path / "run.mcap", kinds=kinds, window=13)

    assert complaints(path) == []
    names = run.description().process_kinds
    assert read_columns(path, "/process", ["kind"])["kind"].tolist() == [names[k] for k in kinds]


def test_columns_come_back_as_they_went_in(run, tmp_path):
    path = run.write(tmp_path / "run.mcap")
    t = np.arange(0, 2000 * MS + 1, 20 * MS)
    given = run.columns(t)

    joints = read_columns(path, "/joint_states", ["joints.position", "joints.velocity", "joints.effort", "joints.name"])
    assert np.array_equal(joints["t_ns"], t)
    assert np.array_equal(joints["joints.position"], given["joint_position"])
    assert np.array_equal(joints["joints.velocity"], given["joint_velocity"])
    assert np.array_equal(joints["joints.effort"], given["joint_effort"])
    assert joints["joints.name"][5].tolist() == list(run.description().joint_names)

    tf = read_columns(path, "/tf", ["transforms.translation.z", "transforms.rotation.x", "transforms.rotation.w"])
    assert np.array_equal(tf["transforms.translation.z"], given["tf"][:, :, 2])
    # given with w < 0; the same turn is stored with w > 0
    assert np.allclose(tf["transforms.rotation.x"], -given["tf"][:, :, 3], rtol=0, atol=1e-15)
    assert (tf["transforms.rotation.w"] > 0).all()

    wrench = read_columns(path, "/wrench", ["force.x", "force.z", "torque.z", "frame_id"])
    assert np.array_equal(wrench["force.x"], given["wrench"][:, 0])
    assert np.array_equal(wrench["force.z"], given["wrench"][:, 2])
    assert np.array_equal(wrench["torque.z"], given["wrench"][:, 5])
    assert set(wrench["frame_id"]) == {"world"}

    motion = read_columns(path, "/motion", ["x_m", "z_m", "block_fraction", "limit", "position_error_m"])
    assert np.array_equal(motion["x_m"], given["motion"].position[:, 0])
    assert np.array_equal(motion["z_m"], given["motion"].position[:, 2])
    assert np.array_equal(motion["block_fraction"], given["motion"].block_fraction)
    assert np.array_equal(motion["limit"], given["motion"].limit)

    names = {"spindle_rad_s": "spindle", "torque_nm": "torque", "removal_m3_s": "removal", "removed_m3": "removed"}
    names |= {"engaged": "engaged", "force_n": "force", "power_w": "power"}
    names |= {"max_force_n": "max_force", "max_torque_nm": "max_torque", "max_power_w": "max_power"}
    process = read_columns(path, "/process", list(names))
    for stored, name in names.items():
        assert np.array_equal(process[stored], getattr(given["process"], name)), name

    tip = read_columns(path, "/tcp", ["pose.position.x", "pose.orientation.x", "pose.orientation.w"])
    assert np.array_equal(tip["pose.position.x"], given["tcp"][:, 0])
    assert (tip["pose.orientation.x"] == 1.0).all() and (tip["pose.orientation.w"] == 0.0).all()


def test_every_topic_starts_at_time_0_also_when_nothing_is_said(run, complaints, new_log, tmp_path):
    log = new_log(tmp_path / "run.mcap")
    log.window(np.array([0, 20 * MS]), **run.columns([0, 20 * MS]))
    log.close(20 * MS, "finished", attachments={"results.json": b"{}"})

    assert complaints(tmp_path / "run.mcap") == []
    file = LogFile.open(tmp_path / "run.mcap")
    at_start = {file.channels[message.channel].topic for message in file.messages(last_ns=0)}
    assert at_start == {channel.topic for channel in file.channels.values()}
    assert {"/scene/stock/03", "/scene/added/01", "/scene/force", "/program"} <= at_start


def test_a_run_that_fails_before_its_first_instant_has_a_log(run, complaints, new_log, tmp_path):
    log = new_log(tmp_path / "run.mcap")
    log.event(0, "GS501", "no way to reach the start", severity="error", file="part.nc", line=3)
    log.close(0, "failed", attachments={"results.json": b"{}"})

    assert complaints(tmp_path / "run.mcap") == []


def test_the_last_state_is_repeated_when_the_end_is_no_log_instant(run, complaints, new_log, tmp_path):
    log = new_log(tmp_path / "run.mcap")
    log.window(np.arange(0, 100 * MS, 20 * MS), **run.columns(np.arange(0, 100 * MS, 20 * MS)))
    log.close(93 * MS, "failed", {"stopped_at": "part.nc:4"}, {"results.json": b"{}"})

    assert complaints(tmp_path / "run.mcap") == []
    found = read_columns(tmp_path / "run.mcap", "/process", ["removed_m3"])
    assert found["t_ns"].tolist() == [0, 20 * MS, 40 * MS, 60 * MS, 80 * MS, 93 * MS]
    assert found["removed_m3"][-1] == found["removed_m3"][-2]
    assert summary(tmp_path / "run.mcap").result["duration_ns"] == str(93 * MS)


def test_messages_of_one_time_follow_the_table(run, tmp_path):
    path = run.write(tmp_path / "run.mcap")
    file = LogFile.open(path)
    order = [(message.t_ns, message.channel) for message in file.messages()]
    sequence = {}
    for message in file.messages():
        assert message.sequence == sequence.get(message.channel, 0)
        sequence[message.channel] = message.sequence + 1

    assert order == sorted(order)
    assert [file.channels[c].topic for c in (1, 2, 3, 4, 5, 6, 7, 8, 9)] == (
        ["/tf_static", "/tf", "/joint_states", "/target", "/tcp", "/motion", "/process", "/wrench", "/program"]
    )


def test_many_blocks_at_once_say_what_single_calls_say(run, complaints, new_log, tmp_path):
    rng = np.random.default_rng(3)
    lines = run.PROGRAM.decode().splitlines()
    m = len(lines)
    counts = np.array([2, 5, 0, 60, 2, 1])
    starts = np.concatenate([[0], np.cumsum(counts)])
    points = rng.random((starts[-1], 3))
    times = np.array([0, 0, 35, 40, 40, 90]) * MS
    modals = [
        ProgramShown(file="part.nc", motion="G0", wcs="G54"),
        ProgramShown(file="part.nc", motion="G1", wcs="G54", tool=300, tool_name="Fräser", feed=0.01, spindle=-5.0),
    ]
    modal = np.array([0, 0, 0, 1, 1, 1])
    t = np.arange(0, 101 * MS, 20 * MS)

    many = new_log(tmp_path / "many.mcap")
    many.blocks(
        BlockMessages(
            BlockColumns(
                t_ns=times,
                line=np.arange(1, m + 1),
                block=np.arange(m),
                text=ByteStrings.of(text.encode() for text in lines),
                modal=modal,
                modals=modals,
                points=points,
                point_starts=starts,
            )
        )
    )
    single = new_log(tmp_path / "single.mcap")
    for i in range(m):
        rest = {name: getattr(modals[modal[i]], name) for name in ("motion", "tool", "tool_name", "feed", "spindle")}
        single.program(times[i], file="part.nc", line=i + 1, text=lines[i], block=i, wcs="G54", **rest)
        single.block_polyline(times[i], points[starts[i] : starts[i + 1]])
    for log in (many, single):
        log.window(t, **run.columns(t))
        log.close(100 * MS, "finished", attachments={"results.json": b"{}"})

    assert complaints(tmp_path / "many.mcap") == []
    for topic in ("/program", "/log", "/scene/block"):
        found = [list(read_messages(tmp_path / name, topic)) for name in ("many.mcap", "single.mcap")]
        assert str(found[0]) == str(found[1])


def test_the_program_is_written_when_it_changes(run, new_log, tmp_path):
    log = new_log(tmp_path / "run.mcap")
    log.program(0, file="part.nc", line=1, text="G21 G90")
    log.program(5 * MS, file="part.nc", line=1, text="G21 G90")
    log.program(7 * MS, tool=3, state="toolchange")
    log.window(np.array([0, 20 * MS]), **run.columns([0, 20 * MS]))
    log.close(20 * MS, "finished")

    program = read_columns(tmp_path / "run.mcap", "/program", ["line", "tool", "state"])
    assert program["t_ns"].tolist() == [0, 7 * MS, 20 * MS]
    assert program["state"].tolist() == ["running", "toolchange", "finished"]
    assert program["tool"].tolist() == [0, 3, 3]
    said = [message.message for _, message in read_messages(tmp_path / "run.mcap", "/log")]
    assert said == ["start: part.nc starts", "G21 G90", "end: finished"]


def test_an_event_names_its_place_also_for_people(run, tmp_path):
    path = run.write(tmp_path / "run.mcap")
    event = next(m for _, m in read_messages(path, "/event") if m.code == "GS602")
    line = next(m for _, m in read_messages(path, "/log") if "GS602" in m.message)

    assert (event.severity, event.file, event.line, event.value) == ("error", "part.nc", 3, 0.003)
    assert (line.level, line.file, line.line) == (4, "part.nc", 3)
    assert line.message == "GS602: rapid through material"


def nan_column(given):
    given["joint_position"][3, 2] = np.nan


def short_column(given):
    given["wrench"] = given["wrench"][:, :3]


def long_quaternion(given):
    given["tcp"][:, 3:] *= 1.1


@pytest.mark.parametrize(
    ("damage", "says"),
    [(nan_column, "'joint_position' is not finite at 0.060000 s"), (short_column, "'wrench' has shape"),
     (long_quaternion, "not of unit length")],
)  # fmt: skip
def test_columns_that_cannot_be_shown_are_refused(run, new_log, tmp_path, damage, says):
    t = np.arange(5) * 20 * MS
    given = run.columns(t)
    damage(given)
    log = new_log(tmp_path / "run.mcap")
    with pytest.raises(ValueError, match=says):
        log.window(t, **given)
        log.flush_before(100 * MS)


def test_what_comes_late_is_refused(run, new_log, tmp_path):
    log = new_log(tmp_path / "run.mcap")
    t = np.arange(5) * 20 * MS
    with pytest.raises(ValueError, match="starts at 1 ns"):
        log.window(np.array([1]), **run.columns([1]))
    log.window(t, **run.columns(t))
    with pytest.raises(ValueError, match="do not increase"):
        log.window(t, **run.columns(t))
    log.flush_before(60 * MS)
    log.event(60 * MS, "GS602", "in time")
    with pytest.raises(ValueError, match="late"):
        log.event(59 * MS, "GS602", "late")
    with pytest.raises(ValueError, match="80000000 ns is logged"):
        log.close(70 * MS, "finished")


def test_frames_have_to_make_one_tree(run, new_log, tmp_path):
    for frames, says in (
        ((("world", "tool"), ("arm/base", "tool")), "two parents"),
        ((("a", "b"), ("b", "a")), "does not hang on"),
        ((("nowhere", "tool"),), "does not hang on"),
    ):
        with pytest.raises(ValueError, match=says):
            new_log(tmp_path / "run.mcap", moving_frames=frames, cell=())
    log = new_log(tmp_path / "run.mcap")
    with pytest.raises(ValueError, match="frame 'spindle'"):
        log.tool(0, [], frame="spindle")


def test_big_tiles_make_chunks_that_a_viewer_takes(run, checker, new_log, tmp_path):
    path = tmp_path / "run.mcap"
    log = new_log(path)
    t = np.arange(3) * 20 * MS
    for at in t:
        log.stock_tile(at, 0, run.tile(0.0, 1e-3, n=200))
    log.window(t, **run.columns(t))
    log.close(t[-1], "finished", attachments={"results.json": b"{}"})

    assert checker.check_log(str(path))[0] == []
    assert all(a.last_ns <= b.first_ns for a, b in pairwise(LogFile.open(path).chunks))
