"""Tasks: which processes a tool carries out at which targets, and what the rows of a path tell them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from gcodesim.cell.loader import read_cell
from gcodesim.diagnostics import SourceText
from gcodesim.executor.targets import NoTarget, standing_bodies, targets_of
from gcodesim.executor.tasks import RowColumns, Tasks
from gcodesim.motion import build_tool_path, linear_interpolation
from gcodesim.processes.signal import ACTIVE, SPINDLE, Signal
from gcodesim.shop import Shop, open_shop, with_stock

CELL = """gcodesim: 1
machine: gantry_xyz
frames: {table: {in: world, xyz: [400, 300, -400]}}
work_offsets: {G54: {in: table}}
stock:
  plate: {min: [0, 0, -20], max: [60, 40, 0], in: table, material: al6082_t6, resolution: 2}
  block: {box: [10, 20, 30], in: table, xyz: [80, 0, 0], resolution: 2}
fixtures:
  post: {box: [10, 10, 10], in: table, xyz: [0, 50, 0]}
  pin: {cylinder: {diameter: 8, height: 20}, in: table, xyz: [20, 60, 0]}
tools:
  1: {type: flat_end_mill, diameter: 10}
  2: {type: extruder, bead_width: 2, bead_height: 1}
"""


@pytest.fixture(scope="module")
def shop() -> Shop:
    loaded = read_cell(SourceText("cell.yaml", CELL.encode()), Path("cell.yaml"))
    assert loaded.cell is not None, [finding.message for finding in loaded.findings]
    made, findings = with_stock(open_shop(loaded.cell))
    assert not findings
    return made


def test_a_tool_has_a_task_at_each_stock(shop: Shop) -> None:
    tasks = Tasks(shop)

    assert [(t.process.kind, t.target.name) for t in tasks.of(1)] == [("milling", "plate"), ("milling", "block")]
    assert tasks.of(1)[0].process.law is not None and tasks.of(1)[1].process.law is None  # of another material
    assert [t.process.kind for t in tasks.of(2)] == ["extrusion", "extrusion"]
    assert tasks.of(0) == tasks.of(77) == []


def test_a_tool_starts_afresh_when_it_comes_again(shop: Shop) -> None:
    tasks = Tasks(shop)
    first = tasks.of(1)

    assert tasks.of(1) is first
    tasks.of(2)
    assert tasks.of(1)[0].state is not first[0].state


def test_a_tool_that_is_kept_from_cutting_goes_on_with_what_takes_nothing(shop: Shop) -> None:
    tasks = Tasks(shop)
    mill, nozzle = tasks.of(1), Tasks(shop)
    mill[0].state.values[:] = 1.0
    nozzle.of(2)

    assert tasks.kept(1) == []
    again = tasks.of(1)
    assert not again[0].state.values.any() and mill[0].state.values.all()  # who is still at work keeps its own
    before = nozzle.of(2)
    assert all(a is b for a, b in zip(nozzle.kept(2), before, strict=True))


def test_targets_of_each_sort(shop: Shop) -> None:
    plate, block = targets_of(shop, "stock")
    assert plate.given is shop.stocks["plate"].stock
    assert block.room is not None and np.allclose((block.room[1] - block.room[0])[:2], [0.01, 0.02])
    assert np.isinf(block.room[1][2])  # an extruder may lay above it
    skin, _ = targets_of(shop, "surface")
    points, faces = skin.given.triangles()
    assert np.allclose(points.min(axis=0), skin.given.box[0], atol=1e-5)
    assert np.allclose(points.max(axis=0), skin.given.box[1], atol=1e-5) and len(faces) >= 12
    (bodies,) = targets_of(shop, "bodies")
    assert [(body.name, body.role) for body in bodies.given] == [
        ("post", "fixture"), ("pin", "fixture"), ("plate", "stock"), ("block", "stock"),
    ]  # fmt: skip
    (nothing,) = targets_of(shop, "nothing")
    assert isinstance(nothing, NoTarget) and nothing.given is None and nothing.room is None and nothing.filled() is None


def test_bodies_stand_where_the_cell_says(shop: Shop) -> None:
    for body in standing_bodies(shop):
        points, faces = body.triangles()
        low, high = body.box
        assert np.allclose(points.min(axis=0), low, atol=2e-5) and np.allclose(points.max(axis=0), high, atol=2e-5)
        a, b, c = (points[faces[:, i]] - low for i in range(3))
        volume = np.einsum("ni,ni->n", np.cross(a, b), c).sum() / 6.0
        assert 0.0 < volume <= np.prod(high - low) * 1.001, body.name  # closed, outside counter-clockwise
    post = standing_bodies(shop)[0]
    assert np.allclose(post.box[0], [0.4, 0.35, -0.4]) and np.allclose(post.box[1] - post.box[0], 0.01)


def test_what_a_process_only_looks_at_need_not_be_put_back(shop: Shop) -> None:
    for sort in ("surface", "bodies", "nothing"):
        for target in targets_of(shop, sort):  # type: ignore[arg-type]
            target.memento()()


def test_rows_give_signals_and_their_defaults() -> None:
    path = linear_interpolation(np.array([0.0, 0.0, 0.0]), np.array([0.1, 0.0, 0.0]), 3)
    rows = RowColumns.of(path)
    row = np.array([0, 0, 1])

    assert rows.signal(SPINDLE, row).shape == (3,) and rows.signal(ACTIVE, row).dtype == bool
    assert rows.signal(Signal("flow", "m^3/s", 2.5), row).tolist() == [2.5, 2.5, 2.5]


def test_a_program_without_moves_has_one_row_at_rest() -> None:
    rows = RowColumns.of(build_tool_path([], (0.0,) * 6, path_control=None, tilts=None))

    assert rows.tool.tolist() == [0] and rows.rapid.tolist() == [False]
    assert {name: values.tolist() for name, values in rows.signals.items()} == {"spindle": [0.0], "active": [False]}
