"""Where everything is: bodies, what moves them, and the frames that they stand in. Knows no cell and no program."""

from gcodesim.scene.mover import WORK, Mover
from gcodesim.scene.scene import WORLD, Hold, Scene, Stand

__all__ = ["WORK", "WORLD", "Hold", "Mover", "Scene", "Stand"]
