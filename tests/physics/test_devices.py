"""Devices that a program switches: what lies on a belt, where a door is, and what inputs read of them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from gcodesim.cell.device import Device, DeviceHistory
from gcodesim.cell.signals import signal_word
from gcodesim.playback import Recording
from tests.physics.runs import Ran, run_texts

CELL = """
gcodesim: 1
machine: gantry_xyz
frames: {table: {in: world, xyz: [400, 300, -400]}}
work_offsets: {G54: {in: table}}
devices:
  belt: {box: [400, 100, 20], zero: top-center, in: table, word: M64 P2, speed: 100 mm/s}
  door: {box: [10, 200, 200], zero: bottom-center, in: table, xyz: [300, 0, 0], word: M10/M11, travel: [0, 0, 250], travel_time: 2 s}
inputs: {P0: {device: door}, P1: {device: belt}}
parts:
  box: {box: [40, 40, 40], zero: bottom-center, in: table, xyz: [-150, 0, 0]}
"""  # noqa: E501


def go(program: str, out: Path | None = None, world: str = "kinematic") -> Ran:
    return run_texts("G21 G90\n" + program + "M2\n", CELL, out, world=world)


@pytest.mark.parametrize("world", ["kinematic", "bullet"])
def test_a_belt_moves_what_lies_on_it_while_it_is_on(world: str, tmp_path: Path) -> None:
    ran = go("G0 Z110\nM64 P2\nG4 P1.5\nM65 P2\nG4 P1\nG0 Z120\n", tmp_path, world)

    assert not ran.bad
    end = ran.results.as_json()["parts"]["box"]
    assert end["x_mm"] == pytest.approx(400 - 150 + 150, abs=1e-6) and end["on"] == "belt"
    x = Recording.open(tmp_path).frames().in_world("part/box")[:, 0, 3]
    speed = np.diff(x) / 0.02
    assert speed.max() == pytest.approx(0.1, rel=1e-6) and speed.min() == 0.0


def test_a_belt_ends_with_a_stop() -> None:
    end = go("G0 Z110\nM64 P2\nG4 P9\nG0 Z120\n").results.as_json()["parts"]["box"]

    assert end["x_mm"] == pytest.approx(400 + 200 - 20, abs=1e-6)  # its front is at the end of the belt


def test_a_wait_for_a_door_is_as_long_as_its_travel(tmp_path: Path) -> None:
    ran = go("G0 Z110\nM10\nM66 P0 L3 Q5\nG0 Z120\n", tmp_path)
    waited = ran.results.times.dwell

    assert not ran.bad and not ran.results.not_simulated
    assert waited == pytest.approx(2.0, abs=0.005)
    z = Recording.open(tmp_path).frames().in_world("device/door")[:, 2, 3]
    assert z[0] == pytest.approx(-0.4) and z[-1] == pytest.approx(-0.15)
    assert (np.diff(z) >= 0.0).all()


def test_an_input_reads_0_before_the_door_is_there() -> None:
    program = "G0 Z110\nM10\nG4 P1\nM66 P0 L0\no1 if [#5399 EQ 0]\nG0 Z130\no1 endif\n"

    assert go(program).results.rapid_distance == pytest.approx(go("G0 Z110\nG0 Z130\n").results.rapid_distance)


def test_a_history_turns_back_on_the_way() -> None:
    word = signal_word("M64 P1")
    assert word is not None
    door = DeviceHistory(Device(word=word, travel=(0.0, 0.0, 0.4), travel_time=2.0), [1.0, 2.0, 5.0], [1.0, 0.0, 1.0])

    assert [door.share(t) for t in (0.5, 2.0, 2.5, 4.0, 6.0, 9.0)] == pytest.approx([0.0, 0.5, 0.25, 0.0, 0.5, 1.0])
    assert door.state(6.0) == (0.0, 7.0) and door.state(8.0) == (1.0, None)


def test_an_input_of_a_device_that_is_not_there_is_told() -> None:
    from gcodesim.cell.loader import read_cell
    from gcodesim.diagnostics import SourceText

    text = CELL.replace("P0: {device: door}", "P0: {device: dor}")
    loaded = read_cell(SourceText("cell.yaml", text.encode()), Path("cell.yaml"))

    assert loaded.cell is None
    assert [(f.code, "dor" in f.message) for f in loaded.findings] == [("GS712", True)]
