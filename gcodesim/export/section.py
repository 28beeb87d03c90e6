"""A section of the part, as SVG in mm."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar, Literal, TextIO

import numpy as np

from gcodesim.export.exporter import Exporter, NoExportError, Option, Request
from gcodesim.export.part import part_surface
from gcodesim.units import MM

if TYPE_CHECKING:
    from gcodesim.frames import Array
    from gcodesim.material.surface import Surface
    from gcodesim.playback.recording import Recording

_MARGIN = 2.0  # [mm] around the part
_ASIDE = 1e-9  # [m]: no point of the surface lies in the plane itself


class SectionDrawing(Exporter):
    """`--to svg`."""

    kind: ClassVar[str] = "svg"
    says: ClassVar[str] = "a section of the part in mm, halfway up or where --section says (z=-2)"
    suffix: ClassVar[str] = ".svg"
    writes: ClassVar[Literal["text", "bytes", "folder"]] = "text"
    takes: ClassVar[frozenset[Option]] = frozenset(("at", "stock", "world", "section"))

    def write(self, recording: Recording, out: TextIO, request: Request) -> str:
        surface, _ = part_surface(recording, t_ns=request.at_ns, stock=request.stock, world=request.world)
        letter, place = request.section or ("z", _halfway_up(surface))
        axis = "xyz".index(letter)
        low, high = surface.vertices[:, axis].min(), surface.vertices[:, axis].max()
        loops = loops_at(surface, axis, place)
        if not loops:
            reach = f"{low / MM:g} to {high / MM:g} mm"
            raise NoExportError(f"the part is nowhere at {letter.upper()}{place / MM:g}; it reaches from {reach}")
        area = abs(sum(area_of(loop) for loop in loops))
        out.write(_svg(loops, surface, axis, f"section at {letter.upper()}{place / MM:g} mm"))
        return f"a section of {area / (MM * MM):.6g} mm² in {len(loops)} outline{'s' if len(loops) > 1 else ''}"


def _halfway_up(surface: Surface) -> float:
    """Where a part is cut if nobody says: in the middle of its height [m]."""
    return float(0.5 * (surface.vertices[:, 2].min() + surface.vertices[:, 2].max()))


def loops_at(surface: Surface, axis: int, place: float) -> list[Array]:
    """Closed outlines (n, 2) [m] where a plane across `axis` cuts a closed surface; material on their left.

    The two coordinates are those that follow the axis (y, z for x; z, x for y; x, y for z).
    """
    points, faces = surface.vertices, surface.faces
    above = points[:, axis] > place + _ASIDE
    cut = faces[(above[faces].any(axis=1)) & ~above[faces].all(axis=1)]
    following: dict[tuple[int, int], tuple[int, int]] = {}
    for face in cut.tolist():
        ups: list[tuple[int, int]] = []
        downs: list[tuple[int, int]] = []
        for k in range(3):
            a, b = face[k], face[(k + 1) % 3]
            if above[a] != above[b]:
                (downs if above[a] else ups).append((min(a, b), max(a, b)))
        following[downs[0]] = ups[0]
    other = [(axis + 1) % 3, (axis + 2) % 3]
    loops = []
    while following:
        edge = next(iter(following))
        edges = []
        while edge in following:
            edges.append(edge)
            edge = following.pop(edge)
        a, b = points[[e[0] for e in edges]], points[[e[1] for e in edges]]
        share = (place + _ASIDE - a[:, axis]) / (b[:, axis] - a[:, axis])
        loops.append((a + share[:, None] * (b - a))[:, other])
    return loops


def area_of(loop: Array) -> float:
    """Area [m²] of an outline, positive where material is on its left."""
    x, y = loop.T
    return 0.5 * float((x * np.roll(y, -1) - np.roll(x, -1) * y).sum())


def _svg(loops: list[Array], surface: Surface, axis: int, title: str) -> str:
    other = [(axis + 1) % 3, (axis + 2) % 3]
    if axis == 1:  # seen from the front: X to the right, Z upwards
        other, loops = other[::-1], [loop[:, ::-1] for loop in loops]
    low = surface.vertices.min(axis=0)[other] / MM - _MARGIN
    high = surface.vertices.max(axis=0)[other] / MM + _MARGIN
    width, height = high - low
    ways = " ".join("M" + " L".join(f"{x / MM:.4f},{-y / MM:.4f}" for x, y in loop.tolist()) + " Z" for loop in loops)
    box = f"{low[0]:.4f} {-high[1]:.4f} {width:.4f} {height:.4f}"
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.4f}mm" height="{height:.4f}mm" viewBox="{box}">\n'
        f"<title>{title}</title>\n"
        f'<path fill="#b8c4d0" stroke="#20303c" stroke-width="{max(width, height) / 400:.4f}" '
        f'fill-rule="evenodd" d="{ways}"/>\n</svg>\n'
    )
