"""Stock that an earlier run left in its folder: which file, and where its material ends."""

from __future__ import annotations

from itertools import product
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Final

import numpy as np

from gcodesim.declarations.file_kind import FileValue
from gcodesim.declarations.files import Refused
from gcodesim.declarations.kind import short
from gcodesim.declarations.reading import Path, Reading, Unread
from gcodesim.frozen import frozen
from gcodesim.solids import Point

if TYPE_CHECKING:
    from gcodesim.material.stock import Stock

NOTHING_LEFT: Final = "name the folder that `gcodesim run --out` wrote"


@frozen
class Leftover:
    """What an earlier run left of its stock: the folder as named in the cell, the file, its least and greatest corner
    [m] in the stock's own frame."""

    name: str
    path: FilePath
    lower: Point
    upper: Point


def leftover(folder: FileValue, stock: str, to: Reading, path: Path) -> Leftover | Unread:
    """The file in `folder` for the stock called `stock`: the one of that name, else the only one there is.

    The file is hashed like all others. GS410 if there is none, or none that can be read.
    """
    from gcodesim.material.stock_file import SUFFIX, StockFileError, stock_from_bytes

    found = sorted(file.name for file in folder.path.glob(f"*{SUFFIX}"))
    own = f"{stock}{SUFFIX}"
    file = found[0] if len(found) == 1 else own
    where = to.shelf.locate(f"{folder.name.rstrip('/')}/{file}")
    if isinstance(where, Refused):
        others = f"; there are {', '.join(found)}" if found else ""
        return to.fault("GS410", to.span(path), no_stock(folder.name, file, f"it is not there{others}"), NOTHING_LEFT)
    try:
        source = to.shelf.open(f"{folder.name.rstrip('/')}/{file}", where)
        lower, upper = corners(stock_from_bytes(source.raw, file))
    except (OSError, StockFileError) as fault:
        return to.fault("GS410", to.span(path), no_stock(folder.name, file, fault), NOTHING_LEFT)
    return Leftover(name=folder.name, path=where, lower=lower, upper=upper)


def no_stock(folder: str, file: str, fault: Exception | str) -> str:
    """The finding that says why there is no stock to go on with."""
    text = fault.strerror if isinstance(fault, OSError) and fault.strerror else str(fault)
    return f"`{short(folder)}` has no stock to go on with: {file}: {text}"


def corners(stock: Stock) -> tuple[Point, Point]:
    """Least and greatest corner [m] of what is left, in the stock's own frame; of its grid when nothing is left."""
    points = stock.in_part(np.array(list(product(*zip(*stock.extent(), strict=True)))))
    low, high = points.min(axis=0), points.max(axis=0)
    return (float(low[0]), float(low[1]), float(low[2])), (float(high[0]), float(high[1]), float(high[2]))
