"""`stock: {from: …}`: which file it is, what it is hashed for, and where it comes to stand."""

from __future__ import annotations

import hashlib
from pathlib import Path

import numpy as np
import pytest

from gcodesim.cell import load_cell, place
from gcodesim.cell.leftover import Leftover
from gcodesim.cell.loader import LoadedCell
from gcodesim.declarations.mesh_shape import MeshShape
from gcodesim.frames import Pose
from gcodesim.material.shape import flat
from gcodesim.material.stock import Stock
from gcodesim.units import MM

HEAD = "gcodesim: 1\nmachine: gantry_xyz\n"  # X 0 to 1200, Y 0 to 800, Z -400 to 0


def left(folder: Path, name: str = "stock") -> Stock:
    """A block 60 x 40 x 20 with zero at top front left, of which X 0 to 10 and the upper 5 mm are gone."""
    stock = Stock.box((0.0, 0.0, -0.02), (0.06, 0.04, 0.0), 0.5 * MM, "al6082_t6")
    everywhere = np.array([[0.03, 0.02, -0.005]])
    stock.remove(everywhere, everywhere, flat(0.2, 0.1))
    edge = np.array([[-0.095, -0.2, -0.03], [-0.095, 0.2, -0.03]])
    stock.remove(edge[:1], edge[1:], flat(0.21, 0.1))
    folder.mkdir(exist_ok=True)
    stock.save(folder / f"{name}.stock")
    return stock


def cell_of(tmp_path: Path, stock: str) -> LoadedCell:
    path = tmp_path / "cell.yaml"
    path.write_text(f"{HEAD}stock: {stock}\n")
    return load_cell(path)


def test_bounds_are_those_of_what_is_left(tmp_path: Path) -> None:
    left(tmp_path / "out1")
    cell = cell_of(tmp_path, "{from: out1}").cell

    assert cell is not None
    shape = cell.stocks["stock"].shape
    assert isinstance(shape, Leftover)
    assert shape.lower == pytest.approx((0.01, 0.0, -0.02)) and shape.upper == pytest.approx((0.06, 0.04, -0.005))


@pytest.mark.parametrize(
    ("turn", "expected"),
    [
        ("", [600 - 35, 400 - 20, -100 + 5]),
        (", rpy: [180, 0, 0]", [600 - 35, 400 + 20, -100 - 20]),
        (", rpy: [180, 0, 0], xyz: [0, 40, -20]", [600 - 35, 400 - 20, -100]),
        (", rpy: [0, 0, 90]", [600 + 20, 400 - 35, -100 + 5]),
    ],
)
def test_g54_is_placed_by_what_is_left(tmp_path: Path, turn: str, expected: list[float]) -> None:
    """Its middle in the middle of the travel, its top 100 mm below the end of Z: with no tools."""
    left(tmp_path / "out1")
    cell = cell_of(tmp_path, f"{{from: out1{turn}}}").cell

    assert cell is not None
    assert place(cell).work_offsets[1].p / MM == pytest.approx(expected)


def test_stock_that_was_turned_over_before_stands_as_it_was_cut(tmp_path: Path) -> None:
    """Columns of a second setup run along another axis of the stock's own frame."""
    stock = left(tmp_path / "out1")
    stock.turn = Pose.from_xyz_rpy((0.0, 0.0, 0.0), (np.pi, 0.0, 0.0)).R.round()
    stock.save(tmp_path / "out1" / "stock.stock")
    cell = cell_of(tmp_path, "{from: out1}").cell

    assert cell is not None
    shape = cell.stocks["stock"].shape
    assert isinstance(shape, Leftover)
    assert shape.lower == pytest.approx((0.01, -0.04, 0.005)) and shape.upper == pytest.approx((0.06, 0.0, 0.02))


def test_it_is_an_input_with_a_hash(tmp_path: Path) -> None:
    left(tmp_path / "out1", "plate")
    loaded = cell_of(tmp_path, "{from: out1/}")

    (_, file) = loaded.files
    assert file.name == "out1/plate.stock"
    assert file.sha256 == hashlib.sha256((tmp_path / "out1" / "plate.stock").read_bytes()).hexdigest()


def test_of_several_stocks_that_of_its_own_name_is_taken(tmp_path: Path) -> None:
    left(tmp_path / "out1", "plate")
    left(tmp_path / "out1", "bar")
    loaded = cell_of(tmp_path, "\n  bar: {from: out1}")

    assert [file.name for file in loaded.files][1:] == ["out1/bar.stock"]


@pytest.mark.parametrize(
    ("stock", "code", "column", "says"),
    [
        ("{from: empty}", "GS410", 15, "`empty` has no stock to go on with: stock.stock: it is not there"),
        ("{from: two}", "GS410", 15, "stock.stock: it is not there; there are a.stock, b.stock"),
        ("{from: odd}", "GS410", 15, "odd.stock is not a stock that gcodesim wrote"),
        ("{from: nowhere}", "GS714", 15, "`nowhere` is not there"),
        ("{from: two, resolution: 0.1}", "GS719", 20, "`resolution` does not go with `from`"),
        ("{from: two, box: [1, 2, 3]}", "GS719", 20, "2 shapes"),
    ],
)
def test_what_is_wrong_shows_before_a_run(tmp_path: Path, stock: str, code: str, column: int, says: str) -> None:
    for name in ("empty", "two", "odd"):
        (tmp_path / name).mkdir()
    left(tmp_path / "two", "a")
    left(tmp_path / "two", "b")
    (tmp_path / "odd" / "odd.stock").write_text("nonsense")
    loaded = cell_of(tmp_path, stock)

    assert loaded.cell is None
    (found,) = loaded.findings
    assert (found.code, found.span.line, found.span.column) == (code, 3, column)
    assert says in found.message


@pytest.mark.parametrize("suffix", ["stl", "obj", "ply", "off", "glb"])
def test_meshes_of_every_format_are_placed_alike(tmp_path: Path, suffix: str) -> None:
    import trimesh

    trimesh.creation.box(extents=(80, 50, 20)).export(tmp_path / f"block.{suffix}")
    cell = cell_of(tmp_path, f"{{mesh: block.{suffix}, unit: mm}}").cell

    assert cell is not None
    shape = cell.stocks["stock"].shape
    assert isinstance(shape, MeshShape)
    assert shape.lower == pytest.approx((-0.04, -0.025, -0.01)) and shape.upper == pytest.approx((0.04, 0.025, 0.01))
    assert place(cell).work_offsets[1].p / MM == pytest.approx([600, 400, -110])


def test_a_mesh_that_a_library_refuses_is_a_finding(tmp_path: Path) -> None:
    (tmp_path / "block.ply").write_text("ply\nnot really\n")
    loaded = cell_of(tmp_path, "{mesh: block.ply, unit: mm}")

    (found,) = loaded.findings
    assert (found.code, found.span.line, found.span.column) == ("GS716", 3, 15)
