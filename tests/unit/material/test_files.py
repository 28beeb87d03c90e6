"""STL and the stock's own file: what comes back, and that bytes repeat."""

from __future__ import annotations

import io
import tracemalloc
import zlib

import numpy as np
import pytest

from gcodesim.material import Stock, shape, stl
from gcodesim.material.stl import write_stl
from gcodesim.material.stock_file import StockFileError, load_stock, save_stock, stock_from_bytes

MM = 1e-3


@pytest.fixture
def carved():
    stock = Stock.box((0, 0, -10 * MM), (30 * MM, 20 * MM, 0), 0.8 * MM, "al6082_t6")
    points = np.random.default_rng(5).uniform((0, 0, -9), (30, 20, -1), (12, 3)) * MM
    stock.remove(points[:-1], points[1:], shape.flat(5 * MM, 2 * MM))
    return stock


def test_a_stock_comes_back_from_its_file(carved, tmp_path):
    save_stock(carved, tmp_path / "plate.stock")
    back = load_stock(tmp_path / "plate.stock")
    assert back.material == "al6082_t6" and back.resolution == 0.8 * MM
    assert back.z_range == carved.z_range and np.array_equal(back.field.grid, carved.field.grid)
    assert back.volume == carved.volume
    used = np.arange(back.field.columns.lo.shape[2]) < back.field.columns.number[:, :, None]
    k = back.field.columns.lo.shape[2]
    assert np.array_equal(back.field.columns.number, carved.field.columns.number)
    assert np.array_equal(back.field.columns.hi[used], carved.field.columns.hi[:, :, :k][used])
    # what was cut before counts as given now
    assert back.error_bound() == 0.0
    assert not back.surface().cut.any()


def test_equal_stocks_give_equal_bytes(carved, tmp_path):
    roomy = carved.copy()
    roomy.grow()
    roomy.field.columns.lo[:, :, -1] = 7.0  # beyond what is used
    save_stock(carved, tmp_path / "a.stock")
    save_stock(roomy, tmp_path / "b.stock")
    assert (tmp_path / "a.stock").read_bytes() == (tmp_path / "b.stock").read_bytes()


@pytest.mark.parametrize(
    "harm",
    [
        lambda raw: b"",
        lambda raw: b"solid cube\n" + raw,
        lambda raw: raw[:-20],
        lambda raw: raw.replace(b'"columns"', b'"colonnes"'),
        lambda raw: raw.replace(b'"columns": [38, 25]', b'"columns": [39, 25]'),
        lambda raw: raw[: raw.index(b"\n", 20)],
    ],
)
def test_damaged_files_say_so(carved, tmp_path, harm):
    save_stock(carved, tmp_path / "plate.stock")
    raw = harm((tmp_path / "plate.stock").read_bytes())
    with pytest.raises(StockFileError, match=r"plate\.stock"):
        stock_from_bytes(raw, "plate.stock")


def test_a_file_of_an_older_version_says_what_to_do(carved, tmp_path):
    path = tmp_path / "plate.stock"
    save_stock(carved, path)
    older = path.read_bytes().replace(b"gcodesim-stock/2\n", b"gcodesim-stock/1\n", 1)
    with pytest.raises(StockFileError, match=r"plate\.stock is of an older gcodesim.*run its program again"):
        stock_from_bytes(older, "plate.stock")


def test_stl_is_the_surface_in_mm(carved, tmp_path, monkeypatch):
    import trimesh

    surface = carved.surface()
    with (tmp_path / "part.stl").open("wb") as file:
        write_stl(surface, file)
    raw = (tmp_path / "part.stl").read_bytes()
    assert len(raw) == 84 + 50 * len(surface.faces)
    mesh = trimesh.load(tmp_path / "part.stl")
    assert mesh.is_watertight
    assert mesh.volume == pytest.approx(surface.volume * 1e9, rel=1e-5)
    assert mesh.bounds[1] == pytest.approx([30, 20, 0], abs=1e-5)
    again = io.BytesIO()
    monkeypatch.setattr(stl, "_AT_A_TIME", 100)
    assert len(surface.faces) % 100 > 0
    write_stl(carved.surface(), again)
    assert again.getvalue() == raw


def test_a_stock_that_would_fill_the_memory_is_refused_before(carved, tmp_path) -> None:
    """Some kilobytes of zeros, packed, are gigabytes."""
    path = tmp_path / "a.stock"
    save_stock(carved, path)
    magic, head, _ = path.read_bytes().split(b"\n", 2)
    bomb = zlib.compress(bytes(50_000_000), 9)
    for text in (head, head.replace(b"[38, 25]", b"[9999999, 9999999]")):
        path.write_bytes(b"\n".join((magic, text, bomb)))
        tracemalloc.start()
        with pytest.raises(StockFileError, match="damaged"):
            load_stock(path)
        assert tracemalloc.get_traced_memory()[1] < 10_000_000
        tracemalloc.stop()
