"""All compiled kernels of the stock that other packages call from their own compiled loops.

Common arguments: `lo`, `hi` (nx, ny, k) [m] and `count` (nx, ny) are the columns, `grid` (4,) is the outer corner
x, y and the cell size dx, dy [m], `dirty` (patches) u1 marks patches of 16 x 16 columns that changed, `tops` (patches)
[m] bounds their height from above. Everything is in the stock frame S.
"""

from gcodesim.material.bead_kernels import add_bead
from gcodesim.material.query_kernels import (
    difference,
    fill_slices,
    highest,
    highest_under,
    is_material,
    occupancy,
    patch_tops,
    surrounding,
    volume_of,
)
from gcodesim.material.removal_kernels import (
    PATCH_SHIFT,
    overlap,
    patch_top,
    remove,
    remove_piece,
    scratch,
    touch_piece,
)
from gcodesim.material.sweep_kernels import underside
from gcodesim.material.tilted_kernels import remove_tilted
from gcodesim.material.wall_kernels import beyond_columns

__all__ = [
    "PATCH_SHIFT",
    "add_bead",
    "beyond_columns",
    "difference",
    "fill_slices",
    "highest",
    "highest_under",
    "is_material",
    "occupancy",
    "overlap",
    "patch_top",
    "patch_tops",
    "remove",
    "remove_piece",
    "remove_tilted",
    "scratch",
    "surrounding",
    "touch_piece",
    "underside",
    "volume_of",
]
