"""Stock: removal, deposition, queries, surfaces, persistence. Knows no tools, robots or programs."""

from gcodesim.material import shape
from gcodesim.material.stock import Deposition, Removal, Stock, finest_resolution, memory_needed

__all__ = ["Deposition", "Removal", "Stock", "finest_resolution", "memory_needed", "shape"]
