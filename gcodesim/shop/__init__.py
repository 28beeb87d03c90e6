"""A cell ready to run: kinematics, tools, processes and stock, each in its place."""

from gcodesim.shop.coats import skin_of
from gcodesim.shop.movers import controller_of
from gcodesim.shop.opening import open_shop, side_by_side
from gcodesim.shop.shop import PlacedStock, Shop
from gcodesim.shop.stands import BODIES, WORK_FRAME
from gcodesim.shop.stocking import with_stock

__all__ = [
    "BODIES",
    "WORK_FRAME",
    "PlacedStock",
    "Shop",
    "controller_of",
    "open_shop",
    "side_by_side",
    "skin_of",
    "with_stock",
]
