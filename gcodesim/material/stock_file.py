"""The file in which a run leaves a stock, and from which a later run goes on.

A line of text, a line of JSON with sorted keys, then the arrays as
little-endian bytes, compressed by zlib: count, then the intervals of all
columns one after the other, then the walls. Only what is used is stored, and equal stocks give
equal bytes.
"""

from __future__ import annotations

import json
import zlib
from pathlib import Path
from typing import Any, Final

import numpy as np

from gcodesim.files.whole_file import write_whole
from gcodesim.material.field_kernels import Columns, Grid
from gcodesim.material.stock import WALL_PLANES, Stock

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
    if (stock.turn != np.eye(3)).any():
        head["turn"] = [[int(v) for v in row] for row in stock.turn]
    arrays = (
        columns.number.astype("<i4"),
        columns.lo[used].astype("<f8"),
        columns.hi[used].astype("<f8"),
        walls.astype("<f4"),
    )
    body = b"".join(array.tobytes() for array in arrays)
    text = json.dumps(head, sort_keys=True, ensure_ascii=False).encode() + b"\n"
    write_whole(path, _MAGIC + text + zlib.compress(body, 1))


def _unpacked(packed: bytes, nx: int, ny: int) -> bytes:
    """The arrays of nx × ny columns, and no more than they can hold, since kilobytes may unpack to gigabytes."""
    if not (0 < nx <= _MOST_COLUMNS and 0 < ny <= _MOST_COLUMNS // nx):
        raise ValueError(f"{nx} x {ny} columns are none that gcodesim writes")
    unpacking = zlib.decompressobj()
    first = unpacking.decompress(packed, 4 * nx * ny)
    total = int(np.frombuffer(first, "<i4").clip(0, _MOST_INTERVALS).sum(dtype=np.int64))
    rest = 16 * total + 4 * WALL_PLANES * (nx + 1) * (ny + 1)
    body = first + unpacking.decompress(unpacking.unconsumed_tail, rest + 1)
    if not unpacking.eof:
        raise ValueError("more is packed than belongs to it")
    return body


def load_stock(path: Path) -> Stock:
    """The stock that `save_stock` wrote. OSError if there is no such file, StockFileError if it holds no stock."""
    return stock_from_bytes(path.read_bytes(), path.name)


def stock_from_bytes(raw: bytes, name: str) -> Stock:
    """The stock in the bytes of a file called `name`; StockFileError if they are not a stock."""
    if raw.startswith(_OLDER):
        raise StockFileError(f"{name} is of an older gcodesim, which kept walls otherwise: run its program again")
    if not raw.startswith(_MAGIC):
        raise StockFileError(f"{name} is not a stock that gcodesim wrote")
    try:
        text, _, packed = raw[len(_MAGIC) :].partition(b"\n")
        head = json.loads(text)
        nx, ny = (int(v) for v in head["columns"])
        body = _unpacked(packed, nx, ny)
        grid = np.array(head["grid_m"], dtype=np.float64)
        z_range = (float(head["z_range_m"][0]), float(head["z_range_m"][1]))
        resolution, material = float(head["resolution_m"]), str(head["material"])
        turn = np.array(head.get("turn", np.eye(3)), dtype=np.float64)
        count = np.frombuffer(body, "<i4", nx * ny).astype(np.int32).reshape(nx, ny)
        total = int(count.sum())
        ends = np.frombuffer(body, "<f8", 2 * total, 4 * nx * ny).astype(np.float64)
        kept = WALL_PLANES * (nx + 1) * (ny + 1)
        walls = np.frombuffer(body, "<f4", kept, 4 * nx * ny + 16 * total).astype(np.float32)
    except (ValueError, KeyError, TypeError, IndexError, zlib.error) as fault:
        raise StockFileError(f"{name} is damaged: {fault}") from fault
    if (
        grid.shape != (4,)
        or turn.shape != (3, 3)
        or min(nx, ny) < 1
        or (count < 0).any()
        or len(body) != 4 * (nx * ny + walls.size) + 16 * total
    ):
        raise StockFileError(f"{name} is damaged: its parts do not fit together")
    k = max(1, int(count.max()))
    used = np.arange(k)[None, None, :] < count[:, :, None]
    lo, hi = np.zeros((nx, ny, k)), np.zeros((nx, ny, k))
    lo[used], hi[used] = ends[:total], ends[total:]
    columns = Columns(lo, hi, count)
    stock = Stock(columns=columns, grid=Grid(*grid.tolist()), z_range=z_range, resolution=resolution, material=material)
    stock.field.walls[:] = walls.reshape(stock.field.walls.shape)
    stock.turn = turn
    return stock
