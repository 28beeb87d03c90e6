"""The heights of the part at the end of a run, seen from the spindle: as numbers and as a picture."""

from __future__ import annotations

from io import BytesIO
from typing import TYPE_CHECKING, Any, BinaryIO, ClassVar, Literal

import numpy as np

from gcodesim.export.exporter import Exporter, NoExportError, Option, Request
from gcodesim.export.part import frame_of, stock_file_of
from gcodesim.files.png import deep_grey_png
from gcodesim.units import MM

if TYPE_CHECKING:
    from gcodesim.material.relief import Relief
    from gcodesim.playback.recording import Recording

_DEEPEST = 1
"""Grey of the lowest place in a picture; 0 is where there is no material."""


def heights_of(recording: Recording, stock: str | None) -> Relief:
    """The relief of a stock as the run has computed it; NoExportError without its file, or for turned work."""
    from gcodesim.material.stock import Stock
    from gcodesim.material.stock_file import SUFFIX, load_stock

    frame_of(recording, stock)
    file = stock_file_of(recording, stock, SUFFIX)
    if file is None:
        raise NoExportError("heights are read from the stock file that a run leaves beside its log; it is not there")
    loaded = load_stock(file)
    if not isinstance(loaded, Stock):
        raise NoExportError("work that turns has no heights; --section shows its profile")
    return loaded.relief()


class HeightNumbers(Exporter):
    """`--to npz`."""

    kind: ClassVar[str] = "npz"
    says: ClassVar[str] = "heights of the part for numpy: x_mm (n), y_mm (m), z_mm (n, m), NaN where nothing is left"
    suffix: ClassVar[str] = ".npz"
    writes: ClassVar[Literal["text", "bytes", "folder"]] = "bytes"
    takes: ClassVar[frozenset[Option]] = frozenset(("stock",))

    def write(self, recording: Recording, out: BinaryIO, request: Request) -> str:
        relief = heights_of(recording, request.stock)
        (x, y), (dx, dy), (nx, ny) = relief.corner, relief.cell, relief.tops.shape
        content = BytesIO()
        values: dict[str, Any] = {
            "x_mm": (x + (np.arange(nx) + 0.5) * dx) / MM,
            "y_mm": (y + (np.arange(ny) + 0.5) * dy) / MM,
            "z_mm": relief.tops / MM,
        }
        np.savez_compressed(content, **values)
        out.write(content.getvalue())
        return f"{nx} x {ny} heights"


class HeightPicture(Exporter):
    """`--to png`."""

    kind: ClassVar[str] = "png"
    says: ClassVar[str] = "heights of the part as a picture: 16 bit grey, white is high, black nothing; Y upwards"
    suffix: ClassVar[str] = ".png"
    writes: ClassVar[Literal["text", "bytes", "folder"]] = "bytes"
    takes: ClassVar[frozenset[Option]] = frozenset(("stock",))

    def write(self, recording: Recording, out: BinaryIO, request: Request) -> str:
        relief = heights_of(recording, request.stock)
        there = np.isfinite(relief.tops)
        if not there.any():
            raise NoExportError("nothing is left of the part")
        low, high = float(relief.tops[there].min()), float(relief.tops[there].max())
        grey = np.zeros(relief.tops.shape)
        span = (np.iinfo(np.uint16).max - _DEEPEST) / max(high - low, 1e-12)
        grey[there] = np.rint(_DEEPEST + (relief.tops[there] - low) * span)
        (dx, dy), (nx, ny) = relief.cell, relief.tops.shape
        text = f"height: {_DEEPEST} is Z{low / MM:.6g} mm, 65535 is Z{high / MM:.6g} mm; a point is "
        text += f"{dx / MM:.6g} x {dy / MM:.6g} mm"
        out.write(deep_grey_png(grey.astype(np.uint16).T[::-1], text))
        return f"{nx} x {ny} points, Z {low / MM:g} to {high / MM:g} mm,"
