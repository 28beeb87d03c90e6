"""Maps of what beams gave a stock: a picture to look at, and the numbers."""

from __future__ import annotations

import io
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from gcodesim.files.output_folder import dose_names
from gcodesim.files.png import grey_png
from gcodesim.files.whole_file import write_whole
from gcodesim.processes.beam import DOSES

if TYPE_CHECKING:
    from gcodesim.material.stock import Stock


def write_doses(stock: Stock, name: str, out: Path) -> None:
    """Write each map of `stock` as PNG, +Y up, white where most was given, and as numpy's array (ny, nx), in the unit
    of the results, row 0 at the lowest y."""
    for kind, dose in sorted(stock.doses.items()):
        unit = DOSES[kind]
        values = (dose.T / unit.per_area).astype("<f4")
        most = float(values.max())
        grey = np.zeros(values.shape, dtype=np.uint8) if most <= 0.0 else np.rint(values[::-1] * (255.0 / most))
        picture, numbers = dose_names(name, kind)
        write_whole(out / picture, grey_png(grey.astype(np.uint8), f"{kind}, white is {most:.6g} {unit.of_area}"))
        file = io.BytesIO()
        np.save(file, values, allow_pickle=False)
        write_whole(out / numbers, file.getvalue())
