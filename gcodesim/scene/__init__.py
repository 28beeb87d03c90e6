"""Where everything is: bodies, what moves them, and the frames they stand in. Knows no cell and no program."""

from gcodesim.scene.body import PUT, Body, Role
from gcodesim.scene.carried import CarriedParts, Fall, PartChange
from gcodesim.scene.mover import WORK, Mover
from gcodesim.scene.past import Past
from gcodesim.scene.scene import Hold, Scene, Stand
from gcodesim.scene.stay import Stay

__all__ = [
    "PUT",
    "WORK",
    "Body",
    "CarriedParts",
    "Fall",
    "Hold",
    "Mover",
    "PartChange",
    "Past",
    "Role",
    "Scene",
    "Stand",
    "Stay",
]
