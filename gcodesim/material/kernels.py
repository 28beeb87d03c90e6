"""All compiled kernels of the stock that other packages call from their own compiled loops.

They take a `Field` whole, as `Stock.view` gives it, and pass it on; only this package names its contents.
Everything is in the stock frame S.
"""

from gcodesim.material.bead_kernels import Bead, add_bead
from gcodesim.material.field_kernels import (
    Field,
    breadth_along,
    coarsest,
    diagonal,
    patch_at,
    patch_tops,
    tighten_tops,
    top_nearby,
)
from gcodesim.material.form_kernels import remove_form, touch_form
from gcodesim.material.loose_kernels import BodyWays
from gcodesim.material.near_wall_kernels import NearWall, wall_near, walled_at
from gcodesim.material.pass_kernels import PassPieces
from gcodesim.material.place_kernels import (
    ELSEWHERE,
    Places,
    Spots,
    ToColumns,
    ask_places,
    ask_spots,
    share_between,
    to_columns,
)
from gcodesim.material.query_kernels import (
    difference,
    fill_slices,
    highest_at,
    occupancy,
    surface_around,
    volume_of,
)
from gcodesim.material.removal_kernels import (
    Found,
    Scratch,
    remove,
    remove_piece,
    scratch,
    touch_piece,
)
from gcodesim.material.revolved_kernels import discs_across, ring_at, swept_outline, take_ring
from gcodesim.material.sweep_kernels import Shape, shape_in, underside
from gcodesim.material.wall_gap_kernels import AT_RIM, LINES, NOTHING, Rim, first_away, gap_outside
from gcodesim.material.wall_kernels import beyond_columns

__all__ = [
    "AT_RIM",
    "ELSEWHERE",
    "LINES",
    "NOTHING",
    "Bead",
    "BodyWays",
    "Field",
    "Found",
    "NearWall",
    "PassPieces",
    "Places",
    "Rim",
    "Scratch",
    "Shape",
    "Spots",
    "ToColumns",
    "add_bead",
    "ask_places",
    "ask_spots",
    "beyond_columns",
    "breadth_along",
    "coarsest",
    "diagonal",
    "difference",
    "discs_across",
    "fill_slices",
    "first_away",
    "gap_outside",
    "highest_at",
    "occupancy",
    "patch_at",
    "patch_tops",
    "remove",
    "remove_form",
    "remove_piece",
    "ring_at",
    "scratch",
    "shape_in",
    "share_between",
    "surface_around",
    "swept_outline",
    "take_ring",
    "tighten_tops",
    "to_columns",
    "top_nearby",
    "touch_form",
    "touch_piece",
    "underside",
    "volume_of",
    "wall_near",
    "walled_at",
]
