"""Tables of probed points: how high the top of a stock really is."""

from __future__ import annotations

from gcodesim.declarations.file_kind import FileValue
from gcodesim.declarations.kind import short
from gcodesim.declarations.reading import Path, Reading, Unread
from gcodesim.declarations.units import find
from gcodesim.frozen import frozen

_SAME = 1e-6
"""Lengths [m] closer than this are one line of the grid."""


@frozen
class HeightMap:
    """Heights over a grid, all [m] in the frame of the stock: at x[i], y[j] it is z[i][j]; both rise."""

    x: tuple[float, ...]
    y: tuple[float, ...]
    z: tuple[tuple[float, ...], ...]

    @property
    def highest(self) -> float:
        return max(max(row) for row in self.z)

    @property
    def lowest(self) -> float:
        return min(min(row) for row in self.z)


def height_map_of(file: FileValue, unit: str | None, to: Reading, path: Path) -> HeightMap | Unread:
    """What the file says that the key at `path` names: a line a point, x y z, in `unit` (mm).

    Commas, semicolons or blanks stand between the numbers; further numbers of a line do not count, nor do lines
    before the first point. A fault (GS714) where the points are no grid.
    """
    scale = find(unit or "mm", "length")
    assert scale is not None
    points: list[tuple[float, float, float]] = []
    for number, line in enumerate(to.shelf.sources[file.name].raw.decode("utf-8-sig", "replace").splitlines(), 1):
        words = line.replace(",", " ").replace(";", " ").split()
        values = [value for word in words[:3] if (value := _number(word)) is not None]
        if len(values) == 3:
            points.append((values[0] * scale.factor, values[1] * scale.factor, values[2] * scale.factor))
        elif words and points:
            return _fault(file, f"line {number} has no three numbers", to, path)
    x, y = _lines_of([point[0] for point in points]), _lines_of([point[1] for point in points])
    heights = {(_place(x, point[0]), _place(y, point[1])): point[2] for point in points}
    if len(x) < 2 or len(y) < 2:
        return _fault(file, f"it has {len(points)} points; at least two by two are needed", to, path)
    if len(heights) != len(x) * len(y) or len(points) != len(heights):
        what = f"its {len(points)} points are no grid of {len(x)} by {len(y)}"
        return _fault(file, what, to, path)
    return HeightMap(
        x=tuple(x), y=tuple(y), z=tuple(tuple(heights[i, j] for j in range(len(y))) for i in range(len(x)))
    )


def _fault(file: FileValue, why: str, to: Reading, path: Path) -> Unread:
    hint = "a line for each point of a grid: `x y z`, in mm or in the `unit` beside it"
    return to.fault("GS714", to.span(path), f"`{short(file.name)}` is no map of heights: {why}", hint)


def _number(word: str) -> float | None:
    try:
        value = float(word) if word.isascii() and "_" not in word else None
    except ValueError:
        return None
    return value if value is not None and abs(value) < 1e6 else None


def _lines_of(places: list[float]) -> list[float]:
    """Places that differ, in rising order."""
    lines: list[float] = []
    for place in sorted(places):
        if not lines or place - lines[-1] > _SAME:
            lines.append(place)
    return lines


def _place(lines: list[float], place: float) -> int:
    return min(range(len(lines)), key=lambda i: abs(lines[i] - place))
