"""The material of a stock before the first cut: new, or as an earlier run left it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Final, cast

import numpy as np

from gcodesim.arithmetic.elementary import cos, sin
from gcodesim.arithmetic.matrices import norms
from gcodesim.cell import Cell
from gcodesim.cell.leftover import NOTHING_LEFT, Leftover, no_stock
from gcodesim.cell.placement import bounds_of
from gcodesim.cell.stock import StockSpec
from gcodesim.diagnostics import Diagnostic
from gcodesim.frames import Pose
from gcodesim.shop.shop import Shop
from gcodesim.solids import Box, Cylinder, read_mesh
from gcodesim.tools.cutter import Cutter
from gcodesim.units import MM

if TYPE_CHECKING:
    from gcodesim.material.revolved import Revolved
    from gcodesim.material.stock import Stock
    from gcodesim.tools.tool import Tool

MEMORY_BUDGET: Final = 2 << 30
"""Bytes that one stock may take: what a laptop can spare."""

CELLS_PER_DIAMETER: Final = 24
"""Cells across the smallest cutter where the cell file names no resolution."""

FINEST_DEFAULT: Final = 0.05 * MM

COARSEST_DEFAULT: Final = 0.5 * MM
"""Where it is not sure that nothing is lost on coarser cells."""

COARSEST_PLAIN: Final = 2.0 * MM
"""For large cutters with plain edges on large stock."""

CELLS_ACROSS_SLOPE: Final = 2
"""Cells at the least across a rounded or slanting part of an edge that is narrower than the cutter."""

CELLS_ACROSS_STOCK: Final = 60
"""Cells at the least across the narrower side of the stock."""

LEVEL: Final = 1e-9
"""[m] that an edge may rise, or come inwards, and still be level or upright."""

MOST_DEFAULT_COLUMNS: Final = 4_000_000


def blank(shop: Shop, name: str, spec: StockSpec) -> Stock | Diagnostic:
    from gcodesim.material.stock import Stock, finest_resolution, memory_needed

    shape = spec.shape
    if isinstance(shape, Leftover):
        return blank_left(shop, name, shape.path, shape.name, spec)
    if shop.mover.lathe:
        return _revolved(shop, name, spec)
    lower, upper = bounds_of(shape)
    size = (upper[0] - lower[0], upper[1] - lower[1], upper[2] - lower[2])
    resolution = spec.resolution or default_resolution(shop.cell, size)
    needed = memory_needed(size, resolution)
    if needed > MEMORY_BUDGET:
        return _too_fine(shop, name, resolution, needed, finest_resolution(size, MEMORY_BUDGET))
    material = spec.material or ""
    if isinstance(shape, Box) and spec.heights is not None:
        from gcodesim.material.warped import Tops, warped_box

        tops = Tops(spec.heights.x, spec.heights.y, spec.heights.z)
        return warped_box(lower, upper, tops, resolution, material)
    if isinstance(shape, Box):
        return Stock.box(lower, upper, resolution, material)
    if isinstance(shape, Cylinder):
        centre = (0.0, 0.0, shape.bottom)
        return Stock.cylinder(centre, 2.0 * shape.radius, shape.top - shape.bottom, resolution, material)
    from gcodesim.material.mesh import stock_of_mesh

    return stock_of_mesh(*read_mesh(shape.path, shape.scale), resolution, material)


def blank_left(shop: Shop, name: str, path: Path, said: str, spec: StockSpec) -> Stock | Diagnostic:
    """The stock that an earlier run left in a file; `said` is how the cell calls where that is."""
    from gcodesim.material.stock_file import StockFileError, load_stock

    try:
        return _fitting(shop, name, load_stock(path), spec)
    except (OSError, StockFileError) as fault:  # it was there when the cell was read
        return Diagnostic(
            code="GS410",
            span=shop.cell.span("stock", name, "from"),
            message=no_stock(said, path.name, fault),
            hint=NOTHING_LEFT,
        )


def _fitting(shop: Shop, name: str, stock: Stock, spec: StockSpec) -> Stock | Diagnostic:
    """What an earlier run left, as this machine needs it: what a lathe has turned stands in columns on a mill."""
    if not hasattr(stock, "profile"):
        return stock
    turned = cast("Revolved", stock)
    if shop.mover.lathe:
        return _for_driven_tools(shop, name, turned, spec.resolution)
    low, high = stock.bounds
    turned.milling_cell = spec.resolution or default_resolution(shop.cell, tuple((high - low).tolist()))
    return turned.in_columns()


def _revolved(shop: Shop, name: str, spec: StockSpec) -> Stock | Diagnostic:
    """The stock of a lathe: a bar or a tube about the spindle's axis."""
    from gcodesim.material.guards import guards_of
    from gcodesim.material.revolved import Revolved

    shape = spec.shape
    X_BS = shop.X_WB.inverse() @ shop.placement.stocks.get(name, Pose.identity())
    aside = float(norms(X_BS.p[None, :2])[0])
    if not isinstance(shape, Cylinder) or aside > 1e-6 or X_BS.R[2, 2] < 1.0 - 1e-9:
        what = "is no cylinder" if not isinstance(shape, Cylinder) else f"stands {aside / MM:.3f} mm beside the spindle"
        return Diagnostic(
            code="GS436",
            span=shop.cell.span("stock", name),
            message=f"stock `{name}` {what}; a lathe turns bars and tubes about its Z axis",
            hint="`cylinder: [diameter, length]`, with `bore` for a tube, and G54 at X0",
        )
    bore = 0.5 * (spec.bore or 0.0)
    if bore >= shape.radius:
        return Diagnostic(
            code="GS436",
            span=shop.cell.span("stock", name, "bore"),
            message=f"the bore of stock `{name}` is as wide as the bar",
            hint="`bore` is the diameter of the hole",
        )
    stock = Revolved.bar(
        shape.radius,
        shape.bottom,
        shape.top,
        bore=bore,
        resolution=None if _is_driven_at(shop) else spec.resolution,
        material=spec.material or "",
        guards=guards_of(spec.chuck, spec.tailstock, shape.bottom, shape.top, shape.radius),
    )
    return _for_driven_tools(shop, name, stock, spec.resolution)


def _is_driven_at(shop: Shop) -> bool:
    """Whether the cell has driven tools; then the resolution of a lathe's stock is that of their columns."""
    return any(tool.is_driven for tool in shop.cell.tools.values())


def _for_driven_tools(shop: Shop, name: str, stock: Revolved, resolution: float | None) -> Stock | Diagnostic:
    """The stock of a lathe with the cell of the columns that driven tools cut."""
    from gcodesim.material.round_columns import finest_columns, memory_of_columns

    if not _is_driven_at(shop):
        return stock
    low, high = stock.bounds
    size = tuple((high - low).tolist())
    stock.milling_cell = resolution or default_resolution(shop.cell, size)
    needed = memory_of_columns(size, stock.milling_cell)
    if needed <= MEMORY_BUDGET:
        return stock
    return _too_fine(shop, name, stock.milling_cell, needed, finest_columns(size, MEMORY_BUDGET))


def _too_fine(shop: Shop, name: str, resolution: float, needed: int, finest: float) -> Diagnostic:
    """GS411 for a stock whose columns do not fit into memory."""
    return Diagnostic(
        code="GS411",
        span=shop.cell.span("stock", name, "resolution"),
        message=f"stock `{name}` at {resolution / MM:g} mm needs {needed / 2**30:.3g} GiB ({needed} bytes); "
        f"{MEMORY_BUDGET / 2**30:.3g} GiB are allowed",
        value=float(needed),
        limit=float(MEMORY_BUDGET),
        unit="B",
        hint=f"the finest resolution that fits is {finest / MM:g} mm",
    )


def default_resolution(cell: Cell, size: tuple[float, float, float]) -> float:
    """Grid [m] of a stock for which the cell names none: as fine as its tools can tell apart, never absurdly fine.

    Heights are exact at any cell, so a face mill of 150 mm needs none of half a millimetre.
    """
    wanted = COARSEST_DEFAULT
    widths = [width for tool in cell.tools.values() if (width := getattr(tool, "diameter", None))]
    if widths:
        across = [min(widths) / CELLS_PER_DIAMETER, min(size[:2]) / CELLS_ACROSS_STOCK, COARSEST_PLAIN]
        slopes = [width / CELLS_ACROSS_SLOPE for tool in cell.tools.values() if (width := narrowest_slope(tool))]
        wanted = min(across[0], max(COARSEST_DEFAULT, min(across + slopes)))
    fewest = float(np.sqrt(size[0] * size[1] / MOST_DEFAULT_COLUMNS))
    return max(wanted, FINEST_DEFAULT, fewest)


def narrowest_slope(tool: Tool) -> float:
    """Width [m], across the axis, of the narrowest part of a cutter's edge that is neither level nor upright; or 0."""
    if not isinstance(tool, Cutter):
        return 0.0
    widths = [0.0]
    for radius, _, _, kappa0, kappa1, length, foot, head, _ in tool.edge.tolist():
        if head - foot > LEVEL:
            widths.append(radius * abs(sin(kappa1) - sin(kappa0)) if radius > 0.0 else length * abs(cos(kappa0)))
    return float(min((width for width in widths if width > LEVEL), default=0.0))
