"""Bodies that spray may coat, and what stands in its way."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from gcodesim.arithmetic.distinct import distinct
from gcodesim.arithmetic.matrices import norms
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.solids import MeshError
from gcodesim.solids.mesh_file import Triangles

if TYPE_CHECKING:
    from gcodesim.material.film import BodyFilm, Shades
    from gcodesim.material.refining import TooFineError

Skin = Callable[[], Triangles]
"""The surface of a body as it is now, in its own frame."""


class Shading:
    """The bodies that may stand between a gun and what it coats: the name of the frame of each, and its skin.

    Their skins are taken once, when the first of them is coated. One without a skin shades nothing.
    """

    def __init__(self, bodies: Sequence[tuple[str, Skin]]) -> None:
        self._bodies = bodies
        self._frames: tuple[str, ...] = ()
        self._shades: Shades | None = None

    def frames(self) -> tuple[str, ...]:
        """The frames of the bodies, in order."""
        self._made()
        return self._frames

    def before(self, frame: str) -> Shades:
        """The bodies as the one in `frame` sees them."""
        own = self._frames.index(frame) if frame in self.frames() else -1
        return self._made()._replace(own=own)

    def _made(self) -> Shades:
        if self._shades is None:
            from gcodesim.material.film import Shades
            from gcodesim.solids.triangle_tree import joined, tree_of

            skins = {frame: skin for frame, take in self._bodies if (skin := _taken(take)) is not None}
            boxes, corners, first = joined([tree_of(skin) for skin in skins.values()])
            balls = np.array([_ball(skin) for skin in skins.values()]).reshape(-1, 4)
            self._frames, self._shades = tuple(skins), Shades(boxes, corners, first, balls, -1)
        return self._shades


def _taken(skin: Skin) -> Triangles | None:
    """The triangles of a skin; None of a body without any, of which others tell."""
    try:
        found = skin()
    except (MeshError, ValueError):
        return None
    return found if len(found.faces) else None


def _ball(skin: Triangles) -> Array:
    """A ball (4,) around a skin: its middle and radius [m]."""
    points = skin.points[distinct(skin.faces)]
    middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
    return np.append(middle, norms(points - middle).max())


@frozen(eq=False)
class _Begun:
    """A film, and the volume [m³] of its stock when it was begun."""

    film: BodyFilm
    volume: float


class Coated:
    """A body that may be coated. Its film is begun when the first gun sprays, on the skin that it has then.

    `frame` is its name in the scene, `size` [m] the greatest edge of a face of the film; `volume` measures a body that
    may be cut, `in_part` turns points (n, 3) of its frame into those of the part as it was described.
    """

    def __init__(
        self,
        frame: str,
        skin: Skin,
        size: float,
        shading: Shading,
        *,
        volume: Callable[[], float] | None = None,
        in_part: Callable[[Array], Array] | None = None,
    ) -> None:
        self.frame, self.skin, self.size, self.shading = frame, skin, size, shading
        self.in_part = in_part or (lambda points: points)
        self.too_fine: TooFineError | None = None
        self._volume = volume or (lambda: 0.0)
        self._begun: _Begun | None = None

    @property
    def name(self) -> str:
        """As in the cell."""
        return self.frame.rpartition("/")[2]

    @property
    def film(self) -> BodyFilm | None:
        """What was sprayed on it; None as long as no gun was on."""
        return None if self._begun is None else self._begun.film

    @property
    def cut_since(self) -> bool:
        """Whether it was cut after its film was begun."""
        return self._begun is not None and self._volume() < self._begun.volume

    def begin(self) -> BodyFilm | None:
        """Its film, begun now if there is none; None of a body that has no skin or would need too many faces."""
        if self._begun is None and self.too_fine is None:
            from gcodesim.material.film import BodyFilm
            from gcodesim.material.refining import TooFineError

            skin = _taken(self.skin)
            if skin is None:
                return None
            try:
                self._begun = _Begun(film=BodyFilm(skin, self.size), volume=self._volume())
            except TooFineError as fault:
                self.too_fine = fault
        return self.film

    def memento(self) -> Callable[[], None]:
        """Remember the film; calling the result restores it."""
        begun = self._begun
        back = None if begun is None else begun.film.memento()

        def restore() -> None:
            self._begun = begun
            if back is not None:
                back()

        return restore
