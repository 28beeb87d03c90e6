"""A printer as lines of a cell, whoever's firmware it has."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import sqrt

from gcodesim.importers.axes import ImportedAxis, machine_lines
from gcodesim.importers.importer import written

_BED = 2.0  # mm thick
_LARGEST_GRAIN = 1.0  # mm
_COLUMNS = 2e6
_WIDER = 1.2  # of a bead, as a share of its nozzle
_FLATTER = 0.5  # its height
_FILAMENT = 1.75  # mm


def printer_lines(
    dialect: str,
    axes: Mapping[str, ImportedAxis],
    nozzles: Mapping[int, tuple[float, float | None]],
    firmware: Mapping[str, str],
) -> Iterator[str]:
    """Axes, an empty bed under their whole travel, and `nozzles`: diameter and that of the filament [mm] by number;
    `firmware` has the limits of the planner by their keys in a cell."""
    yield f"dialect: {dialect}"
    if firmware:
        yield "firmware:"
        yield from (f"  {name}: {value}" for name, value in firmware.items())
    yield from machine_lines(axes)
    yield "work_offsets: {G54: {xyz: [0, 0, 0]}}"
    x, y, z = (axes[letter] for letter in "XYZ")
    low, high = (x.lower or 0.0, y.lower or 0.0), (x.upper or 0.0, y.upper or 0.0)
    grain = min(_LARGEST_GRAIN, max(0.1, sqrt((high[0] - low[0]) * (high[1] - low[1]) / _COLUMNS)))
    corners = [f"{written(low[0])}, {written(low[1])}, {written(-_BED)}", f"{written(high[0])}, {written(high[1])}, 0"]
    size = f"min: [{corners[0]}], max: [{corners[1]} mm]"
    yield f"stock: {{{size}, in: G54, resolution: {written(round(grain, 2))} mm}}  # the bed"
    if z.lower is not None and z.lower > -_BED:
        yield "# the bed lies below Z0"
    yield "tools:  # beads are guessed from the nozzle: take those of your slicer"
    for number, (nozzle, filament) in (nozzles or {0: (0.4, None)}).items():
        sizes = f"bead_width: {written(_WIDER * nozzle)}, bead_height: {written(_FLATTER * nozzle)}"
        thick = written(filament or _FILAMENT)
        yield f"  {number}: {{type: extruder, {sizes}, filament_diameter: {thick}, length: 40}}"


def four(values: Sequence[float], unit: str) -> str:
    """Values of X, Y, Z and the filament as a list of a cell."""
    return f"[{', '.join(written(value) for value in values)} {unit}]"
