"""Film: the thickness of what was sprayed on the faces of a body, in the body's own frame."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np

from gcodesim.arithmetic.matrices import dots, norms
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.material.film_kernels import FIGURES, TOGETHER, Coat, CoatRoom, lay
from gcodesim.material.film_kernels import Dabs as Dabs
from gcodesim.material.film_kernels import Pattern as Pattern
from gcodesim.material.film_kernels import Shades as Shades
from gcodesim.material.refining import refined
from gcodesim.solids.mesh_file import Triangles
from gcodesim.solids.ray_kernels import horizons
from gcodesim.solids.triangle_tree import tree_of, wider

MOST_FACES: Final = 2_000_000
"""Faces of one body: some 300 MB."""

FACING: Final = 0.5
"""Cosine of the angle (60 degrees) to the axis of the gun up to which a face counts as one that it sprays at."""

_LIKE: Final = 0.985
"""Cosine of the angle (10 degrees) below which two directions of spraying count as one."""

_NO_AREA: Final = 1e-12  # of the square of its longer side: of which rounding decides where a face looks
_RISE: Final = 0.02
"""What rises over a face by less than this share of the size of faces does not shade it."""


@frozen(kw_only=False, eq=False)
class FilmFigures:
    """What was measured on faces that count: thickness [m], areas [m²], and where it is least and most (3,) [m]."""

    area: float
    least: float
    mean: float
    most: float
    least_at: Array
    most_at: Array


class BodyFilm:
    """The film on one body: `coat` has its faces in the order of their tree, `points`, `faces` the same as triangles.

    Thickness counts at the middle of each face, where it is exact; volume is thickness times area.
    """

    def __init__(self, mesh: Triangles, size: float) -> None:
        """Over the triangles of `mesh`, no edge longer than `size` [m]; TooFineError if these are too many."""
        fine = refined(_with_areas(mesh), size, MOST_FACES)
        tree = tree_of(fine)
        self.points: Array = fine.points
        self.faces = fine.faces[tree.order]
        corners = tree.corners
        across = np.cross(corners.along, corners.across)
        twice = norms(across)
        n = len(twice)
        middle = np.ascontiguousarray(corners.corner + (corners.along + corners.across) / 3.0)
        normal = np.ascontiguousarray(across / twice[:, None])
        places, normals = np.ascontiguousarray(middle.T), np.ascontiguousarray(normal.T)
        horizon = np.zeros(n)
        horizons(tree.boxes, corners, middle, normal, _RISE * size, horizon)
        boxes = wider(tree, TOGETHER)
        self.coat = Coat(boxes, places, normals, 0.5 * twice, horizon, np.zeros(n), np.zeros(n), np.zeros(n))
        self.size = size
        self._directions: Array = np.zeros((0, 3))
        self._faces, self._told = np.zeros((2, n), dtype=np.int64), np.zeros((3, n))
        self._box = np.zeros((5, TOGETHER))

    def __len__(self) -> int:
        return len(self.faces)

    @property
    def area(self) -> float:
        """[m²]"""
        return float(self.coat.area.sum())

    @property
    def volume(self) -> float:
        """[m³] of solids."""
        return float((self.coat.dry * self.coat.area).sum())

    def lay(self, pattern: Pattern, dabs: Dabs, shades: Shades) -> Array:
        """Lay the film of some dabs, in order; what became of them (k, FIGURES), see `film_kernels`."""
        told: Array = np.zeros((len(dabs.solids), FIGURES))
        within = np.zeros(len(shades.ball), dtype=np.int64)
        face, low = self._faces
        share, towards, distance = self._told
        room = CoatRoom(face, low, share, towards, distance, self._box, within, np.zeros((2, 3)))
        lay(self.coat, pattern, dabs, shades, room, told)
        self._remember(dabs.axis)
        return told

    def _remember(self, axes: Array) -> None:
        """Keep the directions (k, 3) from which it is sprayed, those that are alike once."""
        while len(axes):
            known = self._directions
            fresh = (
                np.ones(len(axes), dtype=bool)
                if not len(known)
                else dots(axes[:, None], known[None]).max(axis=1) < _LIKE
            )
            axes = axes[fresh]
            if len(axes):
                self._directions = np.concatenate([known, axes[:1]])

    def memento(self) -> Callable[[], None]:
        """Remember the film; calling the result restores it."""
        coat, directions = self.coat, self._directions
        kept = [each.copy() for each in (coat.dry, coat.wet, coat.steep)]

        def restore() -> None:
            for each, before in zip((coat.dry, coat.wet, coat.steep), kept, strict=True):
                each[:] = before
            self._directions = directions

        return restore

    def facing(self) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
        """The faces (n,) that lie within 60 degrees across an axis of the gun, wherever it sprayed; none unless so."""
        found = np.zeros(len(self), dtype=bool)
        for axis in self._directions:
            found |= -dots(self.coat.normal, axis) >= FACING
        return found

    def runs(self, sag: float) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
        """The faces (n,) on which wet film is so thick that it runs; `sag` [m] is where it does on a wall.

        The surface of a film of thickness t on a face at the angle a to the horizontal flows at
        g rho sin(a) t² / (2 eta) (Nusselt 1916): as fast as on a wall where t = sag / sqrt(sin a). All is taken as wet
        at once.
        """
        steepness = np.sqrt(self.coat.steep)
        return self.coat.wet * np.sqrt(steepness) > sag

    def figures(self, counts: np.ndarray[tuple[int], np.dtype[np.bool_]]) -> FilmFigures | None:
        """Least, mean and most of the faces that count (n,); None when there are none."""
        at = np.flatnonzero(counts)
        if not len(at):
            return None
        dry, area = self.coat.dry[at], self.coat.area[at]
        low, high = int(at[np.argmin(dry)]), int(at[np.argmax(dry)])
        whole = float(area.sum())
        return FilmFigures(
            whole,
            float(dry.min()),
            float((dry * area).sum()) / whole,
            float(dry.max()),
            self.coat.middle[low],
            self.coat.middle[high],
        )


def _with_areas(mesh: Triangles) -> Triangles:
    """A mesh without faces that have no area, which have no side either; skins of cut stocks have a few."""
    a, b, c = (mesh.points[mesh.faces[:, k]] for k in range(3))
    along, across = b - a, c - a
    longest = np.maximum(norms(along), norms(across))
    some = norms(np.cross(along, across)) > _NO_AREA * longest * longest
    return mesh if some.all() else Triangles(points=mesh.points, faces=mesh.faces[some])
