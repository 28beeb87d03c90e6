"""Kinematics of LinuxCNC by name, against the closed forms of its modules and against axes that are described."""

from __future__ import annotations

import csv
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from gcodesim.arithmetic.matrices import applied
from gcodesim.canon import PointControl, Rapid
from gcodesim.cell import place
from gcodesim.cell.language import settings_of_cell
from gcodesim.cell.machine import MachineTool
from gcodesim.diagnostics import SourceText
from gcodesim.frames import Array
from gcodesim.kinematics import kinematics_of
from gcodesim.kinematics.tool_point import ToolPoint
from gcodesim.rs274.run import interpret
from tests.unit.cell.text import codes, loaded, sound

DATA = Path(__file__).parents[2] / "data" / "five_axis"
TRAVEL = "{travel: [-2000, 2000], speed: 10 m/min}"
TURN = "{travel: unlimited, speed: 90 deg/s}"


def cell_text(kinematics: str, letters: str, more: str = "") -> str:
    axes = {**dict.fromkeys("XYZ", TRAVEL), **dict.fromkeys(letters, TURN)}
    rows = "\n".join(f"    {letter}: {row}" for letter, row in axes.items())
    tools = "tools:\n  1: {type: ball_end_mill, diameter: 6, length: 60}\n"
    return f"gcodesim: 1\nmachine:\n  kinematics: {kinematics}\n  axes:\n{rows}\n{more}{tools}"


def machine_of(kinematics: str, letters: str) -> MachineTool:
    machine = sound(cell_text(kinematics, letters)).machine
    assert machine is not None
    return machine


def tool_of(kinematics: str, letters: str) -> ToolPoint:
    tool = ToolPoint.of(kinematics_of(machine_of(kinematics, letters).chain))
    assert tool is not None
    return tool


def turned(axis: str, angle: Array, v: Array) -> Array:
    """Vectors (n, 3) turned right-handed about X, Y or Z by `angle` (n,)."""
    j, k = {"X": (1, 2), "Y": (2, 0), "Z": (0, 1)}[axis]
    out = v.copy()
    out[:, j] = np.cos(angle) * v[:, j] - np.sin(angle) * v[:, k]
    out[:, k] = np.sin(angle) * v[:, j] + np.cos(angle) * v[:, k]
    return out


def xyzac(p: dict[str, float], con: float, tip: Array, a: Array, c: Array, length: float) -> Array:
    """trtfuncs.c: the work turns by C, then by A about a point that is `tool-offset` above its place."""
    rot = np.array([p["x_rot_point"], p["y_rot_point"], p["z_rot_point"]])
    d = np.array([0.0, p["y_offset"], p["z_offset"] + length])
    found: Array = turned("X", -con * a, turned("Z", -con * c, tip - rot) - d) + d + rot
    return found


def xyzbc(p: dict[str, float], con: float, tip: Array, b: Array, c: Array, length: float) -> Array:
    rot = np.array([p["x_rot_point"], p["y_rot_point"], p["z_rot_point"]])
    d = np.array([p["x_offset"], 0.0, p["z_offset"] + length])
    found: Array = turned("Y", -con * b, turned("Z", -con * c, tip - rot) - d) + d + rot
    return found


def bridge(p: dict[str, float], con: float, tip: Array, b: Array, c: Array, length: float) -> Array:
    """5axiskins.c: the pivot stands away from the tip along spherical coordinates; `con` is not asked."""
    r = p["pivot_length"] + length
    arm = r * np.stack([np.sin(np.pi - b) * np.cos(c), np.sin(np.pi - b) * np.sin(c), np.cos(np.pi - b)], axis=1)
    found: Array = tip - arm - np.array([0.0, 0.0, r])
    return found


def max_(p: dict[str, float], con: float, tip: Array, b: Array, c: Array, length: float) -> Array:
    """maxkins.c without U, V, W."""
    r = p["pivot_length"] + length
    out = turned("Z", -c, tip)
    out[:, 0] += con * r * np.sin(b)
    out[:, 2] += r * np.cos(b) - r
    return out


CASES: dict[str, tuple[Callable[..., Array], str, tuple[str, ...]]] = {
    "xyzac-trt-kins": (xyzac, "AC", ("x_rot_point", "y_rot_point", "z_rot_point", "y_offset", "z_offset")),
    "xyzbc-trt-kins": (xyzbc, "BC", ("x_rot_point", "y_rot_point", "z_rot_point", "x_offset", "z_offset")),
    "5axiskins": (bridge, "CB", ("pivot_length",)),
    "maxkins": (max_, "CB", ("pivot_length",)),
}


@pytest.mark.parametrize("conventional", [False, True])
@pytest.mark.parametrize("name", CASES)
def test_joints_are_those_of_the_module(name: str, conventional: bool) -> None:
    if conventional and name == "5axiskins":
        return  # has no such pin
    form, letters, parameters = CASES[name]
    random = np.random.default_rng(14)
    for _ in range(5):
        p = {key: float(abs(random.normal(0.0, 0.1))) for key in parameters}
        said = "".join(f", {key}: {1e3 * value!r}" for key, value in p.items())
        said += ", conventional_directions: true" if conventional else ""
        tool = tool_of(f"{{type: {name}{said}}}", letters)
        points = np.zeros((200, 6))
        points[:, :3] = random.normal(0.0, 0.2, (200, 3))
        columns = ["ABC".index(letter) + 3 for letter in sorted(letters)]
        points[:, columns] = random.uniform(-4.0, 4.0, (200, 2))
        length = float(random.uniform(0.0, 0.1))
        offset = np.tile([0.0, 0.0, length], (200, 1))
        q = tool.joints(points, offset)
        # words count from the tip; the control adds the length before it asks the module
        tips = points[:, :3] + offset
        wanted = form(p, 1.0 if conventional else -1.0, tips, *points[:, columns].T, length)
        assert np.abs(q[:, tool.linear] - wanted).max() < 1e-12
        assert np.abs(tool.tips(q, offset) - points[:, :3]).max() < 1e-12


@pytest.mark.parametrize(
    ("kinematics", "letters", "column"),
    [
        ("{type: xyzac-trt-kins, z_offset: -20}", "AC", "ac"),
        ("{type: 5axiskins, pivot_length: 160}", "BC", "headhead"),
        ("{type: maxkins, pivot_length: 160}", "BC", "head"),
    ],
)
def test_a_program_of_the_tip_reaches_recorded_joints(kinematics: str, letters: str, column: str) -> None:
    """Without M428 too, since on that control the kinematics are in force from the start."""
    rows = list(csv.DictReader((DATA / "blade.csv").open()))[::9]
    low = [letter.lower() for letter in sorted(letters)]
    blocks = [
        f"G0 X{row['tip_x']} Y{row['tip_y']} Z{row['tip_z']} "
        + " ".join(f"{letter.upper()}{row[f'{column}_{letter}']}" for letter in low)
        for row in rows
    ]
    text = "\n".join(["G21 G90", *([] if column == "ac" else ["T1 M6", "G43 H1"]), *blocks, "M429", "M2"])
    cell = sound(cell_text(kinematics, letters))
    run = interpret(SourceText("a.ngc", text.encode()), settings_of_cell(cell, "main", place(cell))[0])
    events = list(run.stream())
    switches = [event for event in events if isinstance(event, PointControl)]
    assert [switch.on for switch in switches][:1] == [True] and not switches[-1].on
    tips = np.array([event.end for event in events if isinstance(event, Rapid)])
    machine = cell.machine
    assert machine is not None
    tool = ToolPoint.of(kinematics_of(machine.chain))
    assert tool is not None
    offset = np.tile([0.0, 0.0, 0.0 if column == "ac" else 0.060], (len(tips), 1))
    q = tool.joints(tips, offset)[:, tool.linear] - offset
    wanted = np.array([[float(row[f"{column}_{letter}"]) for letter in "xyz"] for row in rows]) / 1e3
    assert np.abs(q - wanted).max() < 1e-8


def test_a_switched_off_program_begins_with_axes() -> None:
    for name, word in (("xyzac-trt-kins", "identity_first: true"), ("5axiskins", "identity_first: true")):
        cell = sound(cell_text(f"{{type: {name}, {word}}}", "ABC"))
        run = interpret(SourceText("a.ngc", b"G0 X1 A30\nM2\n"), settings_of_cell(cell, "main", place(cell))[0])
        assert not any(isinstance(event, PointControl) for event in run.stream())


def test_it_gives_what_axes_in_words_give() -> None:
    named = machine_of("{type: 5axiskins, pivot_length: 180}", "BC")
    assert [axis.letter for axis in named.axes] == ["X", "Y", "Z", "C", "B"]
    by_hand = f"""
gcodesim: 1
machine:
  axes:
    X: {TRAVEL}
    Y: {TRAVEL}
    Z: {TRAVEL}
    C: {TURN[:-1]}, side: tool, at: [0, 0, 180]}}
    B: {TURN[:-1]}, side: tool, at: [0, 0, 180], direction: [0, -1, 0]}}
"""
    own = sound(by_hand).machine
    assert own is not None
    q = np.random.default_rng(3).normal(0.0, 1.0, (20, 5))
    one, other = kinematics_of(named.chain), kinematics_of(own.chain)
    assert np.array_equal(one.forward(q), other.forward(q))
    assert np.array_equal(applied(one.table(q)[:, :3, :3], q[:, :3]), applied(other.table(q)[:, :3, :3], q[:, :3]))


def test_home_as_a_list_is_in_the_order_of_the_file() -> None:
    text = cell_text("5axiskins", "BC").replace("kinematics: 5axiskins", "kinematics: {type: 5axiskins}")
    machine = sound(text.replace("  axes:", "  home: [1, 2, 3, 40, 50]\n  axes:")).machine
    assert machine is not None
    assert {axis.letter: round(float(np.degrees(axis.home))) for axis in machine.axes if axis.rotary} == {
        "B": 40,
        "C": 50,
    }


@pytest.mark.parametrize(
    ("text", "code"),
    [
        (cell_text("{type: xyzac-trt-kins}", "C"), "GS705"),
        (cell_text("{type: xyzac}", "AC"), "GS711"),
        (cell_text("{y_offset: 3}", "AC"), "GS705"),
        (cell_text("{type: xyzac-trt-kins, pivot_length: 3}", "AC"), "GS704"),
        (cell_text("{type: maxkins, pivot_length: -3}", "BC"), "GS710"),
        (cell_text("{type: xyzac-trt-kins}", "AC").replace(TURN, TURN[:-1] + ", at: [0, 0, 0]}"), "GS719"),
        ("gcodesim: 1\nmachine: {model: gantry_xyz, kinematics: {type: maxkins, pivot_length: 3}}\n", "GS719"),
    ],
)
def test_what_does_not_fit_is_said(text: str, code: str) -> None:
    assert code in codes(text), [finding.message for finding in loaded(text).findings]


def test_show_has_what_was_given() -> None:
    from gcodesim.cell.machine import MachineKind

    shown: dict[str, Any] = MachineKind().show(machine_of("{type: xyzac-trt-kins, y_offset: 20}", "AC"))
    assert shown["kinematics"]["type"] == "xyzac-trt-kins" and shown["kinematics"]["y_offset"] == "20 mm"
    assert shown["axes"]["A"]["at"] == ["0 mm", "20 mm", "0 mm"]
