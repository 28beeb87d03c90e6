"""Stock: removal, deposition, queries, surfaces, persistence. Knows no tools, robots or programs."""

from gcodesim.material import shape
from gcodesim.material.stock import SMALL_STOCK_COLUMNS, Deposition, Removal, Stock, finest_resolution, memory_needed

__all__ = ["SMALL_STOCK_COLUMNS", "Deposition", "Removal", "Stock", "finest_resolution", "memory_needed", "shape"]
