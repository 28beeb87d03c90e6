"""The file in which a run leaves a stock, and from which a later run goes on.

A line of text, a line of JSON with sorted keys, then the arrays as
little-endian bytes, compressed by zlib: count, then the intervals of all
columns one after the other, then the walls; then, where the stock has them, the ridges, count and
intervals of the columns along x and of those along y. Only what is used is stored, and equal stocks give
equal bytes.
"""

from __future__ import annotations

import json
import zlib
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.files.whole_file import write_whole
from gcodesim.material.field_kernels import PATCH, Columns, Grid
from gcodesim.material.lattice import Lattice, field_of, own_columns
from gcodesim.material.ridge_kernels import RIDGE_PLANES
from gcodesim.material.stock import Stock
from gcodesim.material.wall_kernels import TURNED_PLANES, WALL_PLANES
from gcodesim.numbers import read_json

Array = NDArray[np.float64]

SUFFIX = ".stock"
_MAGIC = b"gcodesim-stock/2\n"
_MOST_COLUMNS: Final = 100_000_000
_MOST_INTERVALS: Final = 1000  # of a column
_OLDER = b"gcodesim-stock/1\n"


class StockFileError(ValueError):
    """The file is not a stock, or is damaged; the text says which."""


def save_stock(stock: Stock, path: Path) -> None:
    """Write the stock as it is now; `original` becomes this state when it is loaded."""
    columns, grid, walls, _, _ = stock.field
    nx, ny, k = columns.lo.shape
    used = np.arange(k)[None, None, :] < columns.number[:, :, None]
    head: dict[str, Any] = {
        "grid_m": [float(v) for v in grid],
        "columns": [nx, ny],
        "material": stock.material,
        "resolution_m": float(stock.resolution),
        "z_range_m": [float(v) for v in stock.z_range],
    }
    if len(walls) != WALL_PLANES:
        head["walls"] = len(walls)
    if (stock.turn != np.eye(3)).any():
        head["turn"] = [[int(v) for v in row] for row in stock.turn]
    arrays = (
        columns.number.astype("<i4"),
        columns.lo[used].astype("<f8"),
        columns.hi[used].astype("<f8"),
        walls.astype("<f4"),
    )
    body = b"".join(array.tobytes() for array in arrays)
    ridges = stock.all_ridges()
    if ridges is not None:
        head["ridges"] = len(ridges)
        body += ridges.astype("<f4").tobytes()
    if stock.lattice is not None:
        head["offset_m3"] = float(stock.lattice.offset)
        head["across"] = [[*map(float, f.grid), *f.columns.number.shape] for f in stock.lattice.fields]
        body += b"".join(_packed(field.columns) for field in stock.lattice.fields)
    text = json.dumps(head, sort_keys=True, ensure_ascii=False).encode() + b"\n"
    write_whole(path, _MAGIC + text + zlib.compress(body, 1))


def _packed(columns: Columns) -> bytes:
    used = np.arange(columns.lo.shape[2])[None, None, :] < columns.number[:, :, None]
    arrays = (columns.number.astype("<i4"), columns.lo[used].astype("<f8"), columns.hi[used].astype("<f8"))
    return b"".join(array.tobytes() for array in arrays)


class _Unpacking:
    """Bytes that are unpacked no farther than asked for, since kilobytes may unpack to gigabytes."""

    def __init__(self, packed: bytes) -> None:
        self._rest, self._unpacking = packed, zlib.decompressobj()

    def take(self, number: int) -> bytes:
        """The next bytes; ValueError when there are fewer."""
        part = self._unpacking.decompress(self._rest, number) if number else b""
        self._rest = self._unpacking.unconsumed_tail
        if len(part) != number:
            raise ValueError("less is packed than belongs to it")
        return part

    def columns(self, nx: int, ny: int) -> Columns:
        """Columns on a grid of nx × ny."""
        if not (0 < nx <= _MOST_COLUMNS and 0 < ny <= _MOST_COLUMNS // nx):
            raise ValueError(f"{nx} x {ny} columns are none that gcodesim writes")
        count = np.frombuffer(self.take(4 * nx * ny), "<i4").astype(np.int32).reshape(nx, ny)
        if (count < 0).any() or (count > _MOST_INTERVALS).any():
            raise ValueError("its parts do not fit together")
        total = int(count.sum(dtype=np.int64))
        ends = np.frombuffer(self.take(16 * total), "<f8").astype(np.float64)
        k = max(1, int(count.max()))
        used = np.arange(k)[None, None, :] < count[:, :, None]
        lo, hi = np.zeros((nx, ny, k)), np.zeros((nx, ny, k))
        lo[used], hi[used] = ends[:total], ends[total:]
        return Columns(lo, hi, count)

    def finish(self) -> None:
        """ValueError when anything is left."""
        if self._unpacking.decompress(self._rest, 1) or not self._unpacking.eof:
            raise ValueError("more is packed than belongs to it")


def load_stock(path: Path) -> Stock:
    """The stock that `save_stock` wrote. OSError if there is no such file, StockFileError if it holds no stock."""
    return stock_from_bytes(path.read_bytes(), path.name)


def stock_from_bytes(raw: bytes, name: str) -> Stock:
    """The stock in the bytes of a file called `name`; StockFileError if they are not a stock."""
    if raw.startswith(b"gcodesim-revolved/"):
        return _revolved(raw, name)
    if raw.startswith(_OLDER):
        raise StockFileError(f"{name} is of an older gcodesim, which kept walls otherwise: run its program again")
    if not raw.startswith(_MAGIC):
        raise StockFileError(f"{name} is not a stock that gcodesim wrote")
    try:
        text, _, packed = raw[len(_MAGIC) :].partition(b"\n")
        head = read_json(text)
        nx, ny = (int(v) for v in head["columns"])
        unpacking = _Unpacking(packed)
        columns = unpacking.columns(nx, ny)
        planes = int(head.get("walls", WALL_PLANES))
        if planes not in (WALL_PLANES, TURNED_PLANES):
            raise ValueError(f"{planes} planes of walls are none that gcodesim writes")
        packed_walls = unpacking.take(4 * planes * (nx + 1) * (ny + 1))
        walls = np.frombuffer(packed_walls, "<f4").astype(np.float32).reshape(planes, nx + 1, ny + 1)
        ridges = _ridges(unpacking, int(head.get("ridges", 0)), nx, ny)
        grid = np.array(head["grid_m"], dtype=np.float64)
        z_range = (float(head["z_range_m"][0]), float(head["z_range_m"][1]))
        resolution, material = float(head["resolution_m"]), str(head["material"])
        turn = np.array(head.get("turn", np.eye(3)), dtype=np.float64)
        across = [(Grid(*map(float, row[:4])), int(row[4]), int(row[5])) for row in head.get("across", [])]
        offset = float(head.get("offset_m3", 0.0))
        fields = tuple(field_of(unpacking.columns(nu, nv), place) for place, nu, nv in across)
        unpacking.finish()
    except (ValueError, KeyError, TypeError, IndexError, zlib.error) as fault:
        raise StockFileError(f"{name} is damaged: {fault}") from fault
    fits = len(fields) == 0 or (
        len(fields) == 2
        and fields[0].columns.number.shape[0] == ny
        and fields[1].columns.number.shape == (fields[0].columns.number.shape[1], nx)
    )
    if grid.shape != (4,) or turn.shape != (3, 3) or not fits:
        raise StockFileError(f"{name} is damaged: its parts do not fit together")
    stock = Stock(columns=columns, grid=Grid(*grid.tolist()), z_range=z_range, resolution=resolution, material=material)
    stock.begin_with(walls)
    stock.first_ridges = ridges
    stock.turn = turn
    if len(fields) == 2:
        stock.lattice = Lattice(fields, (own_columns(fields[0]), own_columns(fields[1])), offset)
    return stock


def _ridges(unpacking: _Unpacking, planes: int, nx: int, ny: int) -> Array | None:
    """The ridges by patches of nx × ny columns; None where no planes of them are there."""
    if planes == 0:
        return None
    if planes != RIDGE_PLANES:
        raise ValueError(f"{planes} planes of ridges are none that gcodesim writes")
    patches = (-(-nx // PATCH), -(-ny // PATCH))
    packed = unpacking.take(4 * planes * patches[0] * patches[1])
    return np.frombuffer(packed, "<f4").astype(np.float64).reshape(planes, *patches)


def _revolved(raw: bytes, name: str) -> Stock:
    """The stock of a lathe."""
    from gcodesim.material.revolved_file import MAGIC, revolved_from_bytes

    if not raw.startswith(MAGIC):
        raise StockFileError(f"{name} is of another version of gcodesim")
    try:
        return revolved_from_bytes(raw)
    except (ValueError, KeyError, TypeError, zlib.error) as fault:
        raise StockFileError(f"{name} is damaged: {fault}") from fault
