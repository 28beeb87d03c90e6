"""`film:` of a body: how thick what is sprayed on it has to be, and where."""

from __future__ import annotations

from typing import Final

from gcodesim.cell.placing import POINT
from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import Range
from gcodesim.declarations.plain_kinds import Choice
from gcodesim.declarations.quantity import Quantity
from gcodesim.declarations.reading import Path, Reading, Unread
from gcodesim.frozen import frozen
from gcodesim.units import UM

Point = tuple[float, float, float]

_THICK: Final = Quantity("length", Range(above=0.0, most=0.1), "40 um")
_SIZE: Final = Quantity("length", Range(least=1e-5, most=1.0), "3 mm")


@frozen
class FilmRegion:
    """A box in the frame of the body."""

    min: Point = key(POINT, "least corner", example="[20, 15, -1 mm]")
    max: Point = key(POINT, "greatest corner", example="[480, 285, 5 mm]")


@frozen
class FilmSpec:
    """What the film on a body has to be. The faces that count are those that `faces` and `inside` leave."""

    least: float | None = key(_THICK, "least thickness that is allowed (dry)", default=None)
    most: float | None = key(_THICK, "greatest thickness that is allowed (dry)", default=None)
    sag: float | None = key(_THICK, "thickness of wet film that runs down a wall", default=None)
    bare: float = key(_THICK, "thinner film counts as uncovered", default=1.0 * UM)
    faces: str = key(
        Choice(("facing", "all")),
        "which faces count: `facing`, those that lie within 60 degrees across the axis of the gun in some place of the "
        "program, or `all`",
        default="facing",
    )
    inside: FilmRegion | None = key(FilmRegion, "only faces in this box count", default=None)
    resolution: float | None = key(
        _SIZE, "greatest edge of a face of the film", default=None, rule="a third of the spread of the finest gun"
    )

    def checked(self, to: Reading, path: Path) -> FilmSpec | Unread:
        if self.least is not None and self.most is not None and self.least >= self.most:
            return to.fault("GS710", to.span((*path, "most")), "`most` must be greater than `least`")
        if self.inside is not None:
            for axis, low, high in zip("XYZ", self.inside.min, self.inside.max, strict=True):
                if not low < high:
                    span = to.span((*path, "inside", "max"))
                    return to.fault("GS710", span, f"`max` must be greater than `min` in {axis}")
        return self


NO_FILM: Final = FilmSpec()
"""Of a stock without the key: nothing is asked of a coat on it."""
