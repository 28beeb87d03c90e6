"""The run in a window: what stands where, what a click means, and that nothing else changes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pybullet as p
import pytest

from gcodesim.cell import load_cell
from gcodesim.cli.main import main
from gcodesim.diagnostics import SourceText
from gcodesim.jobs.job import Options
from gcodesim.observation.spectator import Spectator
from gcodesim.simulation import prepare, run
from gcodesim.world import WorldUnavailable
from gcodesim.world.window import BodyWindow, ray_through

CELL = """\
gcodesim: 1
robots: {arm: {model: kuka_kr10_r1100_2, home: [0, -90, 90, 0, 90, 0]}}
frames: {table: {in: world, xyz: [600, 0, 300]}}
stock: {plate: {box: [40, 30, 10], in: table, resolution: 1, zero: top-front-left}}
work_offsets: {G54: {in: table}}
orientation: {tool_axis: -Z of G54}
fixtures:
  vise: {box: [60, 60, 20], in: table, xyz: [-10, -100, -10], zero: top-front-left}
tools: {1: {type: flat_end_mill, diameter: 6, flutes: 2, length: 40 mm}}
magazine: {change_time: 0.1 s}
simulation: {world: kinematic}
"""
PROGRAM = "G21 G90 G54\nT1 M6\nG43 H1\nM3 S8000\nG0 X-8 Y15 Z20\nG1 Z-2 F3000\nG1 X45 F3000\nG0 Z30\nM5\nM2\n"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "cell.yaml").write_text(CELL)
    (tmp_path / "part.nc").write_text(PROGRAM)
    return tmp_path


def _shown(folder: Path, out: Path | None) -> tuple[Spectator, BodyWindow, list[str]]:
    window, told, made = BodyWindow(hidden=True), [], []
    job = prepare(SourceText.read(folder / "part.nc"), load_cell(folder / "cell.yaml"), Options())

    def show(job, inner):
        made.append(Spectator(job.shop, job.cell.simulation.step_ns, window, inner, told.append))
        made[0].draw_path(job.plan)
        return made[0]

    run(job, out, show=show)
    return made[0], window, told


def test_bodies_stand_in_the_window_where_the_run_left_them(folder: Path) -> None:
    spectator, window, _ = _shown(folder, None)
    try:
        names = set(window._bodies)
        assert {"stock/plate", "tool#arm#1#0"} <= names and any(name.startswith("arm/") for name in names)
        for name, parts in window._bodies.items():
            for body in parts:
                at, _ = p.getBasePositionAndOrientation(body, physicsClientId=window._client)
                assert at == pytest.approx(spectator._at[name][:3, 3], abs=1e-6), name
        X_WT = spectator._at["tool#arm#1#0"]
        assert X_WT[:3, 3] == pytest.approx([0.645, 0.015, 0.33], abs=1e-4)
        cut = spectator._shapes["stock/plate"]
        assert (
            cut[..., 2].min() < -9e-3 and ((cut[..., 2] > -2.1e-3) & (cut[..., 2] < -1.9e-3)).any()
        )  # the slot's floor
    finally:
        window.close()


@pytest.mark.parametrize(
    ("eye", "name", "line"),
    [
        ([0.605, 0.025, 0.34], "stock/plate", 4),
        ([0.62, -0.07, 0.34], "fixture/vise", 8),
        ([0.645, 0.015, 0.2], "stock", 0),
    ],
)
def test_a_click_says_what_is_there_and_where_the_cell_says_so(
    folder: Path, eye: list[float], name: str, line: int
) -> None:
    spectator, window, _ = _shown(folder, None)
    try:
        picked = spectator.picked(np.array(eye), np.array([0.0, 0.0, -1.0]))
        if not line:
            assert picked is None or not picked.name.startswith(name)
            return
        assert picked is not None and picked.name == name
        assert (picked.span.file, picked.span.line) == ("cell.yaml", line)
        assert picked.text.startswith(f"{picked.name}: frame at X") and f"cell.yaml:{line}" in picked.text
        assert spectator.picked(np.array([3.0, 3.0, 3.0]), np.array([0.0, 0.0, 1.0])) is None
    finally:
        window.close()


@pytest.mark.parametrize(
    ("state", "clicks"),
    [
        (p.KEY_IS_DOWN | p.KEY_WAS_TRIGGERED, 1),
        (p.KEY_IS_DOWN | p.KEY_WAS_TRIGGERED | p.KEY_WAS_RELEASED, 1),  # let go before anybody looked
        (p.KEY_WAS_TRIGGERED | p.KEY_WAS_RELEASED, 1),
        (p.KEY_IS_DOWN, 0),
        (p.KEY_WAS_RELEASED, 0),
    ],
)
def test_a_click_counts_however_late_one_looks(state: int, clicks: int, monkeypatch: pytest.MonkeyPatch) -> None:
    window = BodyWindow(hidden=True)
    try:
        events = [(1, 3.0, 4.0, -1, 0), (2, 10.0, 20.0, 0, state), (2, 10.0, 20.0, 1, state)]
        monkeypatch.setattr(window._p, "getMouseEvents", lambda physicsClientId: events)
        monkeypatch.setattr(window, "_ray", lambda x, y: (x, y))
        assert list(window.clicks()) == [(10.0, 20.0)] * clicks
    finally:
        window.close()


def test_the_run_is_the_same_as_without_a_window(folder: Path) -> None:
    _, window, _ = _shown(folder, folder / "seen")
    window.close()
    run(prepare(SourceText.read(folder / "part.nc"), load_cell(folder / "cell.yaml"), Options()), folder / "unseen")
    for name in ("results.json", "lines.csv", "plate.stl", "run.mcap"):
        assert (folder / "seen" / name).read_bytes() == (folder / "unseen" / name).read_bytes(), name


def test_a_ray_goes_through_its_pixel() -> None:
    """pybullet's matrices: a point that is drawn at a pixel lies on the ray through it."""
    view = np.array(p.computeViewMatrix([2.0, -1.0, 1.5], [0.3, 0.2, 0.1], [0.0, 0.0, 1.0])).reshape(4, 4).T
    projection = np.array(p.computeProjectionMatrixFOV(60.0, 4 / 3, 0.1, 10.0)).reshape(4, 4).T
    point = np.array([0.5, 0.4, 0.3])
    seen = projection @ view @ np.append(point, 1.0)
    x, y = (seen[0] / seen[3] + 1.0) * 320.0, (1.0 - seen[1] / seen[3]) * 240.0

    eye, direction = ray_through(x, y, (640, 480), view, projection)

    assert eye == pytest.approx([2.0, -1.0, 1.5], abs=1e-6)
    assert direction == pytest.approx((point - eye) / np.linalg.norm(point - eye), abs=1e-6)


@pytest.mark.parametrize("display", ["", ":4711"])
def test_without_a_screen_it_is_told(
    folder: Path, display: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("DISPLAY", display)
    with pytest.raises(WorldUnavailable, match="no screen"):
        BodyWindow()
    assert (
        main(["run", str(folder / "part.nc"), "--cell", str(folder / "cell.yaml"), "--gui", "--out", str(folder / "o")])
        == 2
    )
    assert "there is no screen here" in capsys.readouterr().err


def test_a_window_prints_nothing(folder: Path, capfd: pytest.CaptureFixture[str]) -> None:
    _, window, _ = _shown(folder, None)
    window.close()
    window.close()
    assert capfd.readouterr().out == "" and not window.is_open
