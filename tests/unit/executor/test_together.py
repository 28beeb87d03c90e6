"""Several programs in one run: one stock, cuts by steps; nothing depends on windows or on the order of names."""

from __future__ import annotations

import json
from math import pi
from pathlib import Path
from random import Random
from typing import Any

import pytest

from gcodesim.cell import load_cell
from gcodesim.diagnostics import SourceText
from gcodesim.executor import pacing
from gcodesim.executor.weave import Weave
from gcodesim.executor.window_order import Windows
from gcodesim.jobs.job import Options
from gcodesim.log.logfile import LogFile
from gcodesim.simulation import prepare, run

LEFT = "G21 G90\nT1 M6\nS9000 M3\nG0 X-15 Y0 Z4\nM200\nG1 Z-1 F400\nG1 X8 F900\nG0 Z6\nM201\nM5\nM2\n"
RIGHT = "G21 G90\nT2 M6\nS9000 M3\nG0 X0 Y-12 Z4\nM200\nG1 Z-1 F400\nG1 Y12 F900\nG0 Z6\nM201\nG4 P0.5\nM5\nM2\n"


def cell(order: tuple[str, ...] = ("left", "right"), **more: Any) -> dict[str, Any]:
    """Two arms on both sides of one block."""
    marks = {"M200": {"wait": "ready"}, "M201": {"wait": "done"}}
    channel = {"work_offsets": {"G54": {"in": "table"}}, "m_codes": marks}
    return {
        "gcodesim": 1,
        "frames": {"table": {"in": "world", "xyz": [650, 0, 300]}},
        "robots": {
            "left": {"model": "kuka_kr10_r1100_2", "stiffness": "rigid"},
            "right": {
                "model": "kuka_kr10_r1100_2",
                "stiffness": "rigid",
                "base": {"in": "world", "xyz": [1300, 0, 0], "rpy": [0, 0, 180]},
            },
        },
        "channels": {name: {**channel, "robot": name} for name in order},
        "tools": {
            "1": {"type": "flat_end_mill", "diameter": 6, "length": 40},
            "2": {"type": "flat_end_mill", "diameter": 5, "length": 40},
        },
        "stock": {
            "block": {
                "min": [-30, -20, -10],
                "max": [30, 20, 0],
                "in": "table",
                "material": "al6082_t6",
                "resolution": 0.5,
            }
        },
        "simulation": {"world": "kinematic"},
        "checks": {"GS311": "note"},  # their wrists meet over so small a block
        **more,
    }


def ran(folder: Path, made: dict[str, Any], left: str = LEFT, right: str = RIGHT) -> dict[str, Any]:
    folder.mkdir()
    (folder / "cell.yaml").write_text(json.dumps(made))
    options = Options(channels={"right": SourceText("right.nc", right.encode())})
    job = prepare(SourceText("left.nc", left.encode()), load_cell(folder / "cell.yaml"), options)
    results, _ = run(job, folder / "out")
    return results.as_json()


def content(folder: Path) -> tuple[dict[str, bytes], list[tuple[str, int, bytes]]]:
    """The files beside the log, without the hash of the cell; and all messages."""
    log = LogFile.open(folder / "out" / "run.mcap")
    messages = [(log.channels[m.channel].topic, m.t_ns, bytes(m.data)) for m in log.messages()]
    files = {file.name: file.read_bytes() for file in (folder / "out").iterdir() if file.suffix in (".csv", ".stl")}
    return files, messages


def unseen(messages: list[tuple[str, int, bytes]]) -> list[tuple[str, int, bytes]]:
    """Without the stock as it is drawn: it is looked at where a window ends."""
    return [message for message in messages if not message[0].startswith("/scene/stock")]


def test_two_slots_that_cross(tmp_path: Path) -> None:
    """What both remove is the area of two crossing slots with round ends, and 1 mm deep."""
    results = ran(tmp_path / "run", cell())

    stock = results["stocks"]["block"]
    slots = 6.0 * 23.0 + pi * 9.0 + 5.0 * 24.0 + pi * 6.25
    crossing = 6.0 * 5.0
    assert stock["removed_mm3"] == pytest.approx(slots - crossing, abs=stock["error_bound_mm3"])
    assert stock["initial_mm3"] - stock["removed_mm3"] == pytest.approx(stock["remaining_mm3"], abs=1e-3)
    assert [tool["channel"] for tool in results["tools"]] == ["left", "right"]
    assert sum(tool["removed_mm3"] for tool in results["tools"]) == pytest.approx(stock["removed_mm3"], rel=1e-6)


def test_nothing_depends_on_the_length_of_windows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Both tools pass the crossing at nearly the same time: who cuts first decides what each one feels."""
    whole = ran(tmp_path / "whole", cell())
    monkeypatch.setattr(pacing, "MOST_STEPS", 7)

    divided = ran(tmp_path / "divided", cell())

    assert divided == whole
    assert content(tmp_path / "divided")[0] == content(tmp_path / "whole")[0]
    assert unseen(content(tmp_path / "divided")[1]) == unseen(content(tmp_path / "whole")[1])


def crossing(seed: int) -> tuple[str, str]:
    """Two programs whose tools go to and fro through the same part of the block, each at its own feed."""
    draw, programs = Random(seed), []
    for tool in (1, 2):
        moves = [
            f"G1 X{draw.uniform(-12, 12):.2f} Y{draw.uniform(-8, 8):.2f} F{draw.randint(1500, 3500)}" for _ in range(6)
        ]
        start = f"G21 G90\nT{tool} M6\nS9000 M3\nG0 X{draw.uniform(-12, 12):.2f} Y0 Z4\n"
        start += f"G1 Z-{draw.uniform(0.5, 2):.2f} F900"
        programs.append("\n".join([start, *moves, "G0 Z6", "M5", "M2", ""]))
    return programs[0], programs[1]


@pytest.mark.parametrize(
    ("seed", "world"), [(1, "kinematic"), (2, "kinematic"), (3, "bullet"), pytest.param(4, "bullet", id="weak motors")]
)
def test_cut_together_or_step_by_step_is_the_same(
    seed: int, world: str, tmp_path: Path, request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Files and log byte for byte; and windows whose tools cross are divided only where a motor is too weak."""
    if world == "bullet":
        pytest.importorskip("pybullet")
    weak = "weak" in request.node.name
    made = cell(simulation={"world": world})
    if weak:
        tip = {"mass": "5.5 kg", "xyz": [0, 0, 80]}
        for robot in made["robots"].values():
            robot["payload"] = tip
    left, right = crossing(seed)
    divisions: list[int] = []
    divide = Windows.divide
    monkeypatch.setattr(Windows, "divide", lambda self: (divisions.append(len(self._ticks)), divide(self))[1])
    together = ran(tmp_path / "together", made, left, right)
    few = len(divisions)
    monkeypatch.setattr(Weave, "fits", staticmethod(lambda cuts: False))

    by_steps = ran(tmp_path / "by_steps", made, left, right)

    assert together == by_steps
    assert together["status"] == "ok"
    assert content(tmp_path / "together") == content(tmp_path / "by_steps")
    assert len(divisions) > few + 50
    assert few < 3 or weak  # where a tool comes into the spindle


def test_nothing_depends_on_the_order_in_the_cell(tmp_path: Path) -> None:
    ran(tmp_path / "one", cell())
    ran(tmp_path / "other", cell(("right", "left")))

    (files, messages), (same_files, same_messages) = content(tmp_path / "one"), content(tmp_path / "other")
    assert files == same_files
    assert messages == same_messages


def test_both_are_in_the_log_all_the_time(tmp_path: Path) -> None:
    results = ran(tmp_path / "run", cell())
    log = LogFile.open(tmp_path / "run" / "out" / "run.mcap")
    counts = {log.channels[number].topic: count for number, count in log.counts.items()}

    assert counts["/right/tcp"] == counts["/tcp"] > 50
    assert counts["/right/program"] > 5
    assert log.metadata["gcodesim.channels"] == {"left": "left.nc", "right": "right.nc"}
    assert log.end_ns == pytest.approx(results["meetings"]["total_s"] * 1e9, abs=4e6)
    times = [m.t_ns for m in log.messages()]
    assert times == sorted(times)


def test_alone_or_beside_one_that_is_far_away(tmp_path: Path) -> None:
    """A program feels the same forces and takes the same time when another one works elsewhere."""
    elsewhere = "G21 G90\nT2 M6\nG0 X25 Y15 Z30\nG4 P2\nM2\n"
    alone = LEFT.replace("M200\n", "").replace("M201\n", "")
    beside = ran(tmp_path / "beside", cell(), left=alone, right=elsewhere)
    (tmp_path / "alone").mkdir()
    (tmp_path / "alone" / "cell.yaml").write_text(json.dumps(cell()))
    job = prepare(SourceText("left.nc", alone.encode()), load_cell(tmp_path / "alone" / "cell.yaml"))
    results, _ = run(job, tmp_path / "alone" / "out")

    own = beside["channels"]["left"]
    assert own["time"] == results.as_json()["time"] | {"wait_s": 0}
    assert {**beside["tools"][0], "channel": ""} == {**results.as_json()["tools"][0], "channel": ""}
    assert beside["stocks"] == results.as_json()["stocks"]


def test_in_the_world_with_dynamics(tmp_path: Path) -> None:
    pytest.importorskip("pybullet")
    results = ran(tmp_path / "run", cell(simulation={"world": "bullet"}))
    still = ran(tmp_path / "still", cell())

    assert results["status"] == "ok"
    assert results["stocks"]["block"]["removed_mm3"] == pytest.approx(still["stocks"]["block"]["removed_mm3"], rel=1e-3)
    assert all(joint["max_effort"] > 0.0 for joint in results["joints"] if joint["name"].endswith("joint_2"))


def test_a_circle_ends_the_run_where_it_stands(tmp_path: Path) -> None:
    crossed = RIGHT.replace("M200", "M999").replace("M201", "M200").replace("M999", "M201")
    results = ran(tmp_path / "run", cell(), right=crossed)

    assert results["status"] == "failed"
    assert results["meetings"]["total_s"] is None
    assert results["stocks"]["block"]["removed_mm3"] == 0
    assert [f["code"] for f in results["findings"] if f["severity"] == "error"] == ["GS620"]
    assert results["time"]["total_s"] == pytest.approx(results["meetings"]["stopped_at_s"])
