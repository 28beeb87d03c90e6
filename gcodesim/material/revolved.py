"""Stock of a lathe: a body of revolution about Z of its frame S, as a profile that may have undercuts and bores.

A profile is the section with the half plane r >= 0. It is kept disc by disc (`revolved_kernels`), so radii are exact,
and faces are exact where they lie between two discs. A thread is no body of revolution; its grooves are cut into
`thread`, the section at the spindle's zero mark, and what they take is told beside the volume.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import ceil, pi
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.elementary import cos, sin
from gcodesim.frozen import frozen
from gcodesim.material.field_kernels import Array, Ints
from gcodesim.material.revolved_kernels import label_rings, profile_volume
from gcodesim.material.round_columns import in_columns, within
from gcodesim.material.stock import Stock
from gcodesim.material.surface import Facets, Surface, Tile

if TYPE_CHECKING:
    from gcodesim.material.relief import Relief

AROUND: Final = 96
"""Corners of a drawn circle."""

DRAWN: Final = 5.0e-6
"""By how much [m] a drawn profile may be beside the real one."""

ALONG: Final = 160
"""Columns along the longest side by which the log draws what driven tools have cut."""

MILLING_CELL: Final = 0.2e-3
"""How far [m] columns for driven tools are apart where nobody says."""

FINEST: Final = 1.0e-5
MOST_DISCS: Final = 40_000


class Profile(NamedTuple):
    """n discs from `z` on, `dz` thick [m]; the first `number` (n,) of up to k rings lo..hi (n, k) [m] hold material."""

    lo: Array
    hi: Array
    number: Ints
    z: float
    dz: float

    def copy(self) -> Profile:
        return Profile(self.lo.copy(), self.hi.copy(), self.number.copy(), self.z, self.dz)

    @property
    def volume(self) -> float:
        """[m³]"""
        return float(profile_volume(self.lo, self.hi, self.number, self.dz))

    @property
    def top(self) -> float:
        """Where the last disc ends [m]."""
        return self.z + self.dz * len(self.number)

    def heights(self, begins: NDArray[np.int64]) -> Array:
        """Where runs of discs that begin so begin (n + 1,) [m], and where the last of them ends."""
        ends: Array = self.z + self.dz * np.append(begins, len(self.number))
        return ends

    def same(self, other: Profile) -> bool:
        """Whether both are the same body."""
        pairs = ((self.lo, other.lo), (self.hi, other.hi), (self.number, other.number))
        return all(np.array_equal(one, another) for one, another in pairs)

    def wider(self) -> Profile:
        """The same with room for twice as many rings."""
        empty = np.zeros_like(self.lo)
        return self._replace(lo=np.hstack((self.lo, empty)), hi=np.hstack((self.hi, empty)))


FACE, CORNER, ROUND = 1.0 / 4.0, 1.0 / 8.0, 1.0 / 12.0
"""Of a disc by how much the step of the section from disc to disc changes: see `missed_between`."""


def missed_between(profile: Profile) -> float:
    """Area [m²], by the thickness of a disc a volume, by which sections in the middles of discs may miss the whole.

    A sum over middles errs by a 24th of the second difference where a wall is round; it is taken twice. A corner
    between two discs errs by up to an eighth of the change of slope. A face may be half a disc aside: that is two
    changes, there and back. Beyond both ends a way back is taken for granted. The outer wall and what is within it
    count each by itself, so that a groove over an inner one does not hide both.
    """
    used = np.arange(profile.lo.shape[1])[None] < profile.number[:, None]
    widest = np.where(used, profile.hi, 0.0).max(axis=1, initial=0.0)
    outer = widest * widest
    rings = np.where(used, profile.hi * profile.hi - profile.lo * profile.lo, 0.0).sum(axis=1)
    return pi * (_missed(outer) + _missed(outer - rings))


def _missed(section: Array) -> float:
    if len(section) < 3:
        return 0.5 * float(np.abs(np.diff(section)).sum())
    change = np.diff(section, 2)
    change = np.concatenate([-change[:1], change, -change[-1:]])
    size, sign = np.abs(change), np.sign(change)
    before, after = np.pad(change, (1, 0))[:-1] * sign, np.pad(change, (0, 1))[1:] * sign
    even = np.clip(np.minimum(before, after), 0.0, size)  # as much as on both sides: the wall is round
    back = np.clip(-np.minimum(before, after), 0.0, size)  # there and back: a face
    return float((ROUND * even + FACE * back + CORNER * (size - even - back)).sum())


@frozen(eq=False)
class LoosePiece:
    """What fell off: its profile, volume [m³], and from where to where along Z [m].

    `milled`: the same in columns, where driven tools have cut it.
    """

    profile: Profile
    volume: float
    z_range: tuple[float, float]
    milled: Stock | None = None


@frozen
class Guard:
    """Something beside the stock that no tool may touch: a convex outline (m, 2) (z, r), counter-clockwise [m] in S."""

    name: str
    outline: Array


def disc_thickness(length: float, wanted: float | None) -> float:
    """Thickness [m] of discs that divide `length` evenly; `wanted` or finer."""
    size = wanted if wanted is not None else max(FINEST, length / MOST_DISCS)
    return length / max(1, ceil(length / size * (1.0 - 1e-9)))


class Revolved(Stock):
    """A bar or tube in a chuck, which holds it at its least z.

    `milled` is the same in columns, from the first cut of a driven tool on, for the profile `milled_of`: the part is
    what lies in both. Columns are at most `milling_cell` [m] apart.
    """

    __slots__ = ("_full", "fallen", "guards", "last_fall", "milled", "milled_of", "milling_cell", "profile", "thread")

    def __init__(self, *, profile: Profile, radius: float, material: str = "", guards: Sequence[Guard] = ()) -> None:
        self.profile = profile
        self.thread: Profile | None = None
        self.fallen: list[LoosePiece] = []
        self.last_fall = False
        self.guards = tuple(guards)
        self.material, self.resolution = material, profile.dz
        self.z_range = (profile.z, profile.z + profile.dz * len(profile.number))
        self.turn = np.eye(3)
        self.lattice = None
        self.exact = None
        self._full = radius
        self.milling_cell = MILLING_CELL
        self.milled: Stock | None = None
        self.milled_of = profile

    @classmethod
    def bar(
        cls,
        radius: float,
        bottom: float,
        top: float,
        *,
        bore: float = 0.0,
        resolution: float | None = None,
        material: str = "",
        guards: Sequence[Guard] = (),
    ) -> Revolved:
        """A bar about Z from `bottom` to `top`, with a hole of radius `bore` right through [m]."""
        dz = disc_thickness(top - bottom, resolution)
        count = round((top - bottom) / dz)
        profile = Profile(
            lo=np.full((count, 1), bore),
            hi=np.full((count, 1), radius),
            number=np.ones(count, dtype=np.int32),
            z=bottom,
            dz=dz,
        )
        return cls(profile=profile, radius=radius, material=material, guards=guards)

    # ---- cutting

    def drop_loose(self) -> LoosePiece | None:
        """Let fall what the chuck does not hold any more; None if all hangs together."""
        profile = self.profile
        mark = np.zeros(profile.lo.shape, dtype=np.int32)
        label_rings(profile.lo, profile.hi, profile.number, mark)
        used = np.arange(profile.lo.shape[1])[None, :] < profile.number[:, None]
        loose = used & (mark == 0)
        if not loose.any():
            return None
        fallen, kept = _only(profile, loose), _only(profile, used & (mark == 1))
        milled = None if self.milled is None else within(self.milled, fallen, self._full)
        self.profile = kept
        if self.thread is not None:
            self.thread = _within(self.thread, kept)
        at = np.flatnonzero(fallen.number)
        piece = LoosePiece(
            profile=fallen,
            milled=milled,
            volume=fallen.volume if milled is None else milled.volume,
            z_range=(profile.z + float(at[0]) * profile.dz, profile.z + float(at[-1] + 1) * profile.dz),
        )
        self.fallen.append(piece)
        self.last_fall = True
        return piece

    def in_columns(self) -> Stock:
        """What is in the chuck in columns, for a driven tool to cut; from then on it is no body of revolution."""
        if self.milled is None:
            self.milled = in_columns(self.profile, self._full, self.milling_cell, self.material)
        elif not self.milled_of.same(self.profile):
            self.milled = within(self.milled, self.profile, self._full)
        else:
            return self.milled
        self.milled_of = self.profile.copy()
        return self.milled

    @property
    def all_volume(self) -> float:
        """What is in the chuck and what fell off [m³]."""
        return self._held + sum(piece.volume for piece in self.fallen)

    @property
    def _held(self) -> float:
        return self.profile.volume if self.milled is None else self.in_columns().volume

    @property
    def _milled(self) -> list[Stock]:
        """The finished part in columns; none where no driven tool has cut."""
        if self._parted:
            return [piece.milled for piece in self.fallen if _is_part(piece, self) and piece.milled is not None]
        return [] if self.milled is None else [self.in_columns()]

    def thread_section(self) -> Profile:
        """The section in which threads are cut; the profile itself until the first one."""
        if self.thread is None:
            self.thread = self.profile.copy()
        return self.thread

    @property
    def thread_volume(self) -> float:
        """What the grooves of threads take [m³]; not part of `volume`, which is that of the body of revolution."""
        return 0.0 if self.thread is None else max(0.0, self.profile.volume - self.thread.volume)

    @property
    def finished(self) -> list[Profile]:
        """The profiles of the part: what was parted off, if the last cut did that, else what is in the chuck."""
        return [piece.profile for piece in self.fallen if _is_part(piece, self)] if self._parted else [self.profile]

    @property
    def _parted(self) -> bool:
        return self.last_fall and any(_is_part(piece, self) for piece in self.fallen)

    @property
    def in_chuck(self) -> float:
        """What the chuck still holds after parting [m³]; 0 when the part itself is in the chuck."""
        return self._held if self._parted else 0.0

    @property
    def scrap(self) -> float:
        """Loose pieces that are not the part [m³]."""
        whole = sum(piece.volume for piece in self.fallen)
        return whole - (self.volume if self._parted else 0.0)

    # ---- what every stock can tell

    @property
    def volume(self) -> float:
        if self._parted:
            return sum(piece.volume for piece in self.fallen if _is_part(piece, self))
        return self._held

    def error_bound(self) -> float:
        """By how much [m³] the volume may be wrong: what sections in the middles of discs miss, and driven tools.

        What is narrower than a disc may slip between two middles, and is not included.
        """
        turned = sum(p.dz * missed_between(p) for p in self.finished) if self.changed else 0.0
        return float(turned) + sum(stock.error_bound() for stock in self._milled)

    @property
    def changed(self) -> bool:
        first = self.profile.hi[0, 0]
        same = (self.profile.number == 1).all() and (self.profile.hi[:, 0] == first).all()
        return not same or (self.profile.lo[:, 0] != self.profile.lo[0, 0]).any() or bool(self.fallen)

    @property
    def bounds(self) -> tuple[Array, Array]:
        r = self._full
        return np.array([-r, -r, self.z_range[0]]), np.array([r, r, self.z_range[1]])

    def extent(self) -> tuple[Array, Array]:
        at = np.flatnonzero(self.profile.number)
        if not len(at):
            return self.bounds
        r = float(self.profile.hi.max(where=self._used, initial=0.0))
        z = self.profile.z + self.profile.dz * np.array([at[0], at[-1] + 1])
        return np.array([-r, -r, z[0]]), np.array([r, r, z[1]])

    @property
    def _used(self) -> Any:
        return np.arange(self.profile.lo.shape[1])[None, :] < self.profile.number[:, None]

    @property
    def top(self) -> float:
        return self.z_range[1]

    @property
    def cell(self) -> float:
        return float(self.profile.dz)

    @property
    def spacing(self) -> Array:
        return np.array([self.profile.dz, self.profile.dz])

    @property
    def origin(self) -> Array:
        return np.array([-self._full, -self._full])

    def spacing_for(self, columns: int) -> float:
        del columns
        return DRAWN

    def memento(self) -> Callable[[], None]:
        profile = self.profile.copy()
        thread = None if self.thread is None else self.thread.copy()
        fallen, last = list(self.fallen), self.last_fall
        milled, its, again = self.milled, self.milled_of, None if self.milled is None else self.milled.memento()

        def restore() -> None:
            self.profile = profile.copy()
            self.milled, self.milled_of = milled, its
            if again is not None:
                again()
            self.thread = None if thread is None else thread.copy()
            self.fallen, self.last_fall = list(fallen), last

        return restore

    def copy(self) -> Revolved:
        twin = Revolved(profile=self.profile.copy(), radius=self._full, material=self.material, guards=self.guards)
        twin.thread = None if self.thread is None else self.thread.copy()
        twin.fallen, twin.last_fall = list(self.fallen), self.last_fall
        twin.milled, twin.milled_of = None if self.milled is None else self.milled.copy(), self.milled_of.copy()
        twin.milling_cell = self.milling_cell
        return twin

    def piece_volumes(self) -> Array:
        return np.array([self._held, *(piece.volume for piece in self.fallen)])

    def relief(self) -> Relief:
        """The profile as heights: the outer radius of each disc."""
        from gcodesim.material.relief import Relief

        used = self.profile.number > 0
        last = np.maximum(self.profile.number - 1, 0)
        outer = np.where(used, self.profile.hi[np.arange(len(last)), last], np.nan)
        thickness = ((self.profile.hi - self.profile.lo) * self._used).sum(axis=1)
        return Relief(
            corner=(self.z_range[0], 0.0),
            cell=(self.profile.dz, self.profile.dz),
            tops=outer[:, None],
            lengths=thickness[:, None],
        )

    # ---- surfaces

    def outlines(self, profile: Profile, tolerance: float = DRAWN) -> list[Array]:
        """Closed outlines (k, 2) (z, r) of a profile, material on the left, with points left out up to `tolerance`."""
        return [_thinned(loop, tolerance) for loop in _loops(profile)]

    def surface(self, spacing: float | None = None) -> Surface:
        """The closed surface of the finished part, with threads left out; circles have 96 corners.

        Where driven tools have cut, it comes from columns that are about `spacing` [m] apart (default: all of them).
        """
        milled = self._milled
        if not milled:
            return self._skin(self.finished)
        skins = [stock.surface(0.0 if spacing is None else max(spacing, stock.cell)) for stock in milled]
        ends = np.cumsum([0, *(len(skin.vertices) for skin in skins)])
        return Surface(
            vertices=np.concatenate([skin.vertices for skin in skins]),
            faces=np.concatenate([skin.faces + at for skin, at in zip(skins, ends[:-1], strict=True)]).astype(np.int32),
            cut=np.concatenate([skin.cut for skin in skins]),
        )

    def _skin(self, profiles: Sequence[Profile]) -> Surface:
        points, faces, count = [], [], 0
        for profile in profiles:
            for loop in self.outlines(profile):
                p, f = _turned(loop)
                points.append(p)
                faces.append(f + count)
                count += len(p)
        if not points:
            return Surface(
                vertices=np.zeros((0, 3)), faces=np.zeros((0, 3), dtype=np.int32), cut=np.zeros(0, dtype=np.uint8)
            )
        triangles = np.concatenate(faces).astype(np.int32)
        return Surface(vertices=np.concatenate(points), faces=triangles, cut=np.ones(len(triangles), dtype=np.uint8))

    def tiles(self, across: int = 4, spacing: float | None = None) -> Any:
        del across
        return _RevolvedTiles(self, spacing)

    def save(self, path: Path) -> None:
        from gcodesim.material.revolved_file import save_revolved

        save_revolved(self, path)


def _is_part(piece: LoosePiece, stock: Revolved) -> bool:
    """Whether a piece that fell off counts: the splinter that a facing cut leaves at the middle does not."""
    return piece.volume > 0.02 * max(other.volume for other in stock.fallen)


def _only(profile: Profile, chosen: Any) -> Profile:
    """The chosen (n, k) rings of a profile."""
    lo, hi = np.zeros_like(profile.lo), np.zeros_like(profile.hi)
    place = np.cumsum(chosen, axis=1) - 1
    rows, columns = np.nonzero(chosen)
    lo[rows, place[rows, columns]] = profile.lo[rows, columns]
    hi[rows, place[rows, columns]] = profile.hi[rows, columns]
    return profile._replace(lo=lo, hi=hi, number=chosen.sum(axis=1).astype(np.int32))


def _within(thread: Profile, kept: Profile) -> Profile:
    """The discs of a thread's section that still have material."""
    chosen = (np.arange(thread.lo.shape[1])[None, :] < thread.number[:, None]) & (kept.number > 0)[:, None]
    return _only(thread, chosen)


def _loops(profile: Profile) -> list[Array]:
    """Outlines of all rings, joined where those of neighbouring discs overlap.

    Rings that follow one another one to one are a strand; each strand becomes one closed outline. Where a strand
    forks, the outlines of its parts touch at the face between two discs.
    """
    edges: Array = profile.z + profile.dz * np.arange(len(profile.number) + 1, dtype=float)
    if profile.number.max(initial=0) <= 1:
        return [_around(profile, [(j, 0) for j in run], edges) for run in _plain_runs(profile)]
    strands: list[list[tuple[int, int]]] = []
    open_: dict[int, int] = {}
    for j in range(len(profile.number)):
        now: dict[int, int] = {}
        for i in range(int(profile.number[j])):
            partners = [s for s in open_ if _overlap(profile, j, i, j - 1, s)]
            sole = len(partners) == 1 and _sole(profile, j, partners[0])
            if sole:
                now[i] = open_[partners[0]]
                strands[now[i]].append((j, i))
            else:
                strands.append([(j, i)])
                now[i] = len(strands) - 1
        open_ = now
    return [_around(profile, strand, edges) for strand in strands]


def _plain_runs(profile: Profile) -> list[list[int]]:
    """Runs of discs with one ring each that hang together."""
    filled = np.flatnonzero(profile.number)
    if not len(filled):
        return []
    low, high = profile.lo[filled, 0], profile.hi[filled, 0]
    parts = (np.diff(filled) > 1) | (np.minimum(high[1:], high[:-1]) <= np.maximum(low[1:], low[:-1]))
    return [run.tolist() for run in np.split(filled, np.flatnonzero(parts) + 1)]


def _overlap(profile: Profile, j: int, i: int, k: int, s: int) -> bool:
    return bool(min(profile.hi[j, i], profile.hi[k, s]) > max(profile.lo[j, i], profile.lo[k, s]))


def _sole(profile: Profile, j: int, s: int) -> bool:
    return sum(_overlap(profile, j, i, j - 1, s) for i in range(int(profile.number[j]))) == 1


def _around(profile: Profile, strand: Sequence[tuple[int, int]], edges: Array) -> Array:
    """The outline of a strand: outwards at its first face, along the outside, inwards, back along the inside.

    Between two discs whose radii differ by no more than a slope of 80 degrees would, the outline is straight.
    """
    rows = np.array([j for j, _ in strand])
    columns = np.array([i for _, i in strand])
    z, dz = edges[rows] + 0.5 * profile.dz, profile.dz
    outer, inner = (_line(z, values[rows, columns], dz) for values in (profile.hi, profile.lo))
    loop: Array = np.concatenate([outer, inner[::-1]])
    return loop


def _line(z: Array, r: Array, dz: float) -> Array:
    """The line (k, 2) through the middles of discs, with upright steps where radii jump, to the faces at both ends."""
    steep = np.abs(np.diff(r)) > 6.0 * dz
    points = [np.array([[z[0] - 0.5 * dz, r[0]]])]
    middle = np.stack([z, r], axis=1)
    cuts = np.flatnonzero(steep) + 1
    for number, part in enumerate(np.split(middle, cuts)):
        if number:
            points.append(np.array([[part[0, 0] - 0.5 * dz, part[0, 1]]]))
        points.append(part)
        points.append(np.array([[part[-1, 0] + 0.5 * dz, part[-1, 1]]]))
    return np.concatenate(points)


def _thinned(loop: Array, tolerance: float) -> Array:
    """`loop` without points that lie within `tolerance` [m] of the line between those that are kept."""
    keep = [0]
    begin, count = 0, len(loop)
    while begin < count - 1:
        reach = 1
        while begin + reach < count and _straight(loop[begin : begin + reach + 1], tolerance):
            reach *= 2
        low, high = reach // 2, min(reach, count - 1 - begin)
        while low < high:
            middle = (low + high + 1) // 2
            if _straight(loop[begin : begin + middle + 1], tolerance):
                low = middle
            else:
                high = middle - 1
        begin += max(1, low)
        keep.append(begin)
    thin: Array = loop[keep]
    same = np.abs(np.diff(thin, axis=0, append=thin[:1])).max(axis=1) < 1e-12
    kept: Array = thin[~same]
    return kept


def _straight(points: Array, tolerance: float) -> bool:
    way = points[-1] - points[0]
    length = float(np.sqrt((way * way).sum()))
    off = points[1:-1] - points[0]
    if length == 0.0:
        return not len(off)
    across = np.abs(off[:, 0] * way[1] - off[:, 1] * way[0]) / length
    return bool((across <= tolerance).all())


def _turned(loop: Array) -> tuple[Array, Any]:
    """Points (v, 3) and triangles (t, 3) of a closed outline (k, 2) turned about Z, outwards; points on the axis once.

    The corners lie outside of the circle so that a polygon has its area: with 96 of them by 0.07 %.
    """
    angles = 2.0 * np.pi * np.arange(AROUND) / AROUND
    step = 2.0 * np.pi / AROUND
    scale = float(np.sqrt(step / sin(step)))
    on_axis = np.abs(loop[:, 1]) < 1e-9
    firsts, points, count = [], [], 0
    for (z, r), single in zip(loop, on_axis, strict=True):
        firsts.append(count)
        if single:
            points.append(np.array([[0.0, 0.0, z]]))
            count += 1
        else:
            points.append(np.stack([scale * r * cos(angles), scale * r * sin(angles), np.full(AROUND, z)], axis=1))
            count += AROUND
    turn, following = np.arange(AROUND), (np.arange(AROUND) + 1) % AROUND
    faces = []
    for a in range(len(loop)):
        b = (a + 1) % len(loop)
        if on_axis[a] and on_axis[b]:
            continue
        p, q = firsts[a], firsts[b]
        pa, pb = (np.full(AROUND, p),) * 2 if on_axis[a] else (p + turn, p + following)
        qa, qb = (np.full(AROUND, q),) * 2 if on_axis[b] else (q + turn, q + following)
        if not on_axis[a]:
            faces.append(np.stack([pa, pb, qb], axis=1))
        if not on_axis[b]:
            faces.append(np.stack([pa, qb, qa], axis=1))
    return np.concatenate(points), np.concatenate(faces)


class _RevolvedTiles:
    """The surface of a lathe's stock for the log, as one tile."""

    def __init__(self, stock: Revolved, spacing: float | None) -> None:
        self._stock, self._spacing = stock, spacing
        self._before: bytes = b""

    def __len__(self) -> int:
        return 1

    def all(self) -> list[Tile]:
        self._before = b""
        return self.changed().draw()

    def changed(self) -> _RevolvedGlimpse:
        stock = self._stock
        if stock.milled is None:
            return _RevolvedGlimpse(self, stock.profile.copy(), None)
        columns = stock.in_columns()
        low, high = stock.bounds
        return _RevolvedGlimpse(
            self, stock.profile, columns.surface(max(columns.cell, float((high - low).max()) / ALONG))
        )

    def draw(self, profile: Profile, milled: Surface | None) -> list[Tile]:
        """The tile, unless it looks as before."""
        if milled is not None:
            return self._draw_milled(milled)
        state = profile.lo.tobytes() + profile.hi.tobytes() + profile.number.tobytes()
        if state == self._before:
            return []
        self._before = state
        skin = self._stock._skin([profile])
        empty = Facets(points=np.zeros((0, 3)), triangles=np.zeros((0, 3), dtype=np.int32))
        drawn = Facets(points=skin.vertices, triangles=skin.faces)
        raw = bool((profile.number == 1).all() and np.ptp(profile.hi[:, 0]) == 0.0)
        return [Tile(number=0, original=drawn if raw else empty, changed=empty if raw else drawn)]

    def _draw_milled(self, skin: Surface) -> list[Tile]:
        """The tile of a part that driven tools have cut, what they made apart from the rest."""
        state = skin.vertices.tobytes() + skin.faces.tobytes()
        if state == self._before:
            return []
        self._before = state
        turned, cut = (Facets(points=skin.vertices, triangles=skin.faces[skin.cut == k]) for k in (0, 1))
        return [Tile(number=0, original=turned, changed=cut)]


@frozen(kw_only=False, eq=False)
class _RevolvedGlimpse:
    tiles: _RevolvedTiles
    profile: Profile
    milled: Surface | None

    def draw(self) -> list[Tile]:
        return self.tiles.draw(self.profile, self.milled)
