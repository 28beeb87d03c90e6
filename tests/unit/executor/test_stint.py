"""Stints: one process at one target, asked when its zone comes near, at once or step by step."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from gcodesim.executor.stint import NEAR, Stint
from gcodesim.executor.tasks import Task
from gcodesim.frames import rotation_about
from gcodesim.processes.protocol import Process
from gcodesim.processes.window import ProcessState, ProcessStep, Window
from gcodesim.processes.zone import EVERYWHERE, Zone

BOX = (np.array([0.0, 0.0, -0.02]), np.array([0.06, 0.04, 0.0]))


class Pushing(Process):
    """Pushes along X of S, once for each time that it is asked."""

    pushes = True

    def __init__(self, zone: Zone) -> None:
        self._zone, self.asked = zone, 0

    @property
    def zone(self) -> Zone:
        return self._zone

    def run(self, target: Any, window: Window, state: ProcessState) -> ProcessStep:
        self.asked += 1
        state.values[0] += window.steps
        step = ProcessStep.free(window.steps, {"engaged": np.ones(window.steps, dtype=bool)})
        step.wrench[:, 0] = 10.0
        return step

    def loop(self, target: Any, window: Window, state: ProcessState) -> Any:
        return Stepping(window)


class Stepping:
    def __init__(self, window: Window) -> None:
        self.moved: list[np.ndarray] = []
        self.steps = window.steps

    def step(self, k: int, moved_before: np.ndarray, moved: np.ndarray, share: np.ndarray) -> np.ndarray:
        self.moved.append(moved)
        return np.array([1.0, 0.0, 0.0, 0.0, 0.0, 0.0])

    def finish(self) -> ProcessStep:
        step = ProcessStep.free(self.steps)
        step.wrench[:, 0] = 1.0
        return step


def stint(zone: Zone, height: float, filled: Any = BOX, R: np.ndarray | None = None) -> tuple[Stint, Pushing]:
    n = 4
    points = np.column_stack([np.linspace(0.0, 0.05, n + 1), np.full(n + 1, 0.02), np.full(n + 1, height)])
    window = Window(
        piece_start=points[:-1],
        piece_end=points[1:],
        piece_step=np.arange(n),
        axis=np.tile([0.0, 0.0, 1.0], (n, 1)),
        velocity=np.zeros((n, 3)),
        rapid=np.zeros(n, dtype=bool),
        signals={},
        dt=0.01,
    )
    process = Pushing(zone)
    X = np.tile(np.eye(4), (n, 1, 1))
    if R is not None:
        X[:, :3, :3] = R
    target: Any = SimpleNamespace(name="plate", given=None, filled=lambda: filled)
    task = Task(tool=None, target=target, process=process, state=ProcessState(values=np.zeros(1)))  # type: ignore[arg-type]
    share, row = np.tile([0.0, 1.0], (n, 1)), np.zeros(n, dtype=np.int64)
    return Stint(task=task, begin=0, end=n, window=window, X_BS=X, share=share, row=row), process


@pytest.mark.parametrize(
    ("zone", "height", "asked"),
    [
        (Zone(radius=1e-3), 0.5 * NEAR, 1),
        (Zone(radius=1e-3), 2.0 * NEAR, 0),
        (Zone(radius=1e-3, below=0.3), 0.3, 1),
        (Zone(radius=1e-3, below=0.3), 0.3 + 2.0 * NEAR, 0),
        (EVERYWHERE, 9.0, 1),
    ],
)
def test_its_zone_decides_whether_a_process_is_asked(zone: Zone, height: float, asked: int) -> None:
    made, process = stint(zone, height)
    made.run()

    assert process.asked == asked
    assert (made.answer is not None) == bool(asked)


def test_without_a_box_it_is_asked_wherever_it_is() -> None:
    made, process = stint(Zone(radius=1e-3), 5.0, filled=None)
    made.run()

    assert process.asked == 1


def test_what_the_tool_feels_is_told_in_base_axes() -> None:
    made, _ = stint(EVERYWHERE, 0.0, R=rotation_about(np.array([0.0, 0.0, 1.0]), np.pi / 2))
    made.run()

    assert made.wrench is not None
    assert made.wrench[0] == pytest.approx([0.0, 10.0, 0.0, 0.0, 0.0, 0.0])


def test_step_by_step_it_hears_in_its_own_axes_how_far_the_tip_is_off() -> None:
    made, process = stint(EVERYWHERE, 0.0, R=rotation_about(np.array([0.0, 0.0, 1.0]), np.pi / 2))
    wrenches = [made.step(k, np.zeros(3), np.array([0.0, 1e-3, 0.0]), np.zeros((6, 6))) for k in range(4)]
    loop = made._loop
    made.finish()

    assert process.asked == 0
    assert loop.moved[0] == pytest.approx([1e-3, 0.0, 0.0])
    assert wrenches[0] == pytest.approx([0.0, 1.0, 0.0, 0.0, 0.0, 0.0])
    assert made.answer is not None and made.wrench == pytest.approx(np.array(wrenches))


def test_finishing_asks_who_was_not_asked_step_by_step() -> None:
    made, process = stint(EVERYWHERE, 0.0)
    made.finish()
    made.finish()

    assert process.asked == 1


def test_what_was_taken_back_is_done_again() -> None:
    made, process = stint(EVERYWHERE, 0.0)
    made.run()
    made.forget()
    assert made.answer is None and made.wrench is None

    made.run()
    assert process.asked == 2
