"""Films as the log draws them: on the bodies that are coated, coloured by thickness, while they grow."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from gcodesim.arithmetic.distinct import distinct
from gcodesim.frames import Array, Pose
from gcodesim.frozen import frozen
from gcodesim.log import DrawnMesh
from gcodesim.log.topics import MOST_TILES
from gcodesim.recorder.frames import stock_frame, things_of

if TYPE_CHECKING:
    from gcodesim.material.film import BodyFilm
    from gcodesim.recorder.frames import Frames
    from gcodesim.scene.coated import Coated

MOST_FILM_LOOKS: Final = 20
"""Looks at films in a whole run: each writes all of a film."""

MOST_DRAWN_FACES: Final = 60_000
"""A film of more faces is drawn at the end only; `NAME.film.ply` has all of any."""

CLASSES: Final = 8
"""Colours from the least film that counts to the most."""

LIFT: Final = 0.2e-3
"""How far [m] a film is drawn above its body, so that the body does not show through."""


@frozen(kw_only=False, eq=False)
class FilmGlimpse:
    """The thickness (n,) [m] of film `number` on the faces of a body at one moment."""

    number: int
    thickness: Array


class Films:
    """The films of a cell by number; `look` is called in the thread that lays them, `draw` in the one that writes."""

    def __init__(self, coated: Sequence[Coated], most: Sequence[float | None], bare: Sequence[float]) -> None:
        """`most` [m] has the lightest colour, None: the greatest thickness that there is; `bare` counts as none."""
        self._coated, self._most, self._bare = coated[:MOST_TILES], most, bare
        self._seen = [0.0] * len(self._coated)

    def __len__(self) -> int:
        return len(self._coated)

    def frame(self, number: int, frames: Frames) -> tuple[str, str, Pose]:
        """The name of a film, the frame of the log in which it is drawn, and where its body stands in that."""
        name = self._coated[number].frame
        if name in things_of(frames.shop):
            return name, name, Pose.identity()
        stocks = [placed.frame for placed in frames.shop.stocks.values()]
        if name in stocks:
            index = stocks.index(name)
            return name, stock_frame(index, list(frames.shop.stocks)[index]), Pose.identity()
        return name, *frames.carrier(name)

    def look(self, *, last: bool = False) -> list[FilmGlimpse]:
        """Those that have grown since the last look."""
        found = []
        for number, film in enumerate(each.film for each in self._coated):
            if film is None or (len(film) > MOST_DRAWN_FACES and not last):
                continue
            total = float(film.coat.dry.sum())
            if total != self._seen[number]:
                self._seen[number] = total
                found.append(FilmGlimpse(number, film.coat.dry.copy()))
        return found

    def draw(self, glimpse: FilmGlimpse, X: Pose) -> list[DrawnMesh]:
        """One mesh for each class of thickness, at X of the frame in which it is drawn."""
        from gcodesim.material.film_file import colours

        film = self._coated[glimpse.number].film
        assert film is not None
        bare, most = self._bare[glimpse.number], self._most[glimpse.number]
        top = max(float(glimpse.thickness.max()), bare) if most is None else most
        share = np.clip(glimpse.thickness / top, 0.0, 1.0)
        kind = np.where(glimpse.thickness < bare, -1, np.minimum(share * CLASSES, CLASSES - 1).astype(np.int64))
        meshes = []
        for each in distinct(kind[kind >= 0]).tolist():
            red, green, blue = (colours(np.array([(each + 0.5) / CLASSES * top]), top, 0.0)[0] / 255.0).tolist()
            points = _corners(film, kind == each)
            triangles = np.arange(len(points), dtype=np.int32).reshape(-1, 3)
            meshes.append(
                DrawnMesh(points=X.apply(points), triangles=triangles, tight=True, color=(red, green, blue, 1.0))
            )
        return meshes


def _corners(film: BodyFilm, some: np.ndarray[tuple[int], np.dtype[np.bool_]]) -> Array:
    """Corners (3 n, 3) of some faces, a little in front of these."""
    lifted = film.points[film.faces[some]] + LIFT * film.coat.normal[some][:, None]
    corners: Array = lifted.reshape(-1, 3)
    return corners
