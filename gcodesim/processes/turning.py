"""Turning: the work turns, a tool that stands still takes what its outline sweeps, and feels the force of the chip.

The profile of revolution is exact whatever the feed is; marks of the feed are left out. Forces come from elements of
the edges: h = f (u · n) with the feed f of a turn along u, force per width by the law of the material (Kienzle 1952);
their widths are scaled so that the section of all chips is what is removed over the way of the cut. Main, feed and
passive force follow from the direction of each element, and with it from the lead angle. Where a driven tool has cut
before, the force is that of a full turn, without the knocks of an interrupted cut.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from functools import cached_property
from itertools import pairwise
from math import pi
from typing import TYPE_CHECKING, ClassVar, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.frozen import frozen
from gcodesim.processes.column import (
    ENGAGED,
    FINDINGS,
    LINES,
    LOG,
    POWER,
    REMOVED,
    RESULTS,
    TORQUE,
    Column,
)
from gcodesim.processes.drill_point import edge_law, edge_pieces
from gcodesim.processes.protocol import ActsOn, Process
from gcodesim.processes.signal import PITCH, SPINDLE, SURFACE_SPEED, Signal
from gcodesim.processes.turning_misuse import turning_findings
from gcodesim.processes.window import ProcessState, ProcessStep, Window

if TYPE_CHECKING:
    from gcodesim.diagnostics import Diagnostic
    from gcodesim.material.revolved import Profile, Revolved
    from gcodesim.processes.laws import Law
    from gcodesim.processes.materials import Material
    from gcodesim.processes.rows import Rows
    from gcodesim.processes.turning_kernels import Blade, BladeWay, Discs
    from gcodesim.processes.zone import Zone
    from gcodesim.tools.drill import Drill
    from gcodesim.tools.lathe_tool import LatheTool

Array = NDArray[np.float64]

_FIRST: Final = 0.02e-3
_GROWS: Final = 1.15
_MOST: Final = 0.25e-3
"""Elements of an edge [m]: the first at the nose, how much longer each next one is, and the longest."""

ON_PLANE: Final = 1e-9
"""Distance [m] from the plane y = 0 of S within which a tool counts as in it."""


@frozen(slots=False, eq=False)
class Turning(Process):
    """The cutting process of one tool on a lathe; without a law it removes but feels no force."""

    kind: ClassVar[str] = "turning"
    acts_on: ClassVar[ActsOn] = "revolved"
    takes: ClassVar[bool] = True
    reads: ClassVar[tuple[Signal, ...]] = (SPINDLE, SURFACE_SPEED, PITCH)
    writes: ClassVar[tuple[Column, ...]] = (
        REMOVED,
        ENGAGED,
        TORQUE,
        POWER,
        Column("main_force", "N", "greatest", LOG | LINES | RESULTS, "on the tool, along the cutting speed"),
        Column("feeding_force", "N", "greatest", LOG | LINES | RESULTS, "on the tool, against the feed"),
        Column("passive_force", "N", "greatest", LOG | LINES | RESULTS, "on the tool, across the feed"),
        Column("uncut_chip", "m", "greatest", LOG | RESULTS, "the thickest chip of the edge"),
        Column("threaded", "m^3", "sum", LINES | RESULTS, "what grooves of threads take of the section"),
        Column("lathe_shank", "m", "greatest", FINDINGS, "how deep the shank is in material"),
        Column("lathe_guard", "m", "greatest", FINDINGS, "how deep the tool is in chuck or tailstock"),
        Column("back_edge", "m^3", "sum", FINDINGS, "taken by an edge that should not cut"),
        Column("lathe_rapid", "m^3", "sum", FINDINGS, "taken in rapids"),
        Column("lathe_still", "m^3", "sum", FINDINGS, "taken with the spindle at rest"),
        Column("lathe_inside", "", "any", FINDINGS, "in material that it may not cut: it was put there"),
        Column("lathe_aside", "", "any", FINDINGS, "a drill works beside the middle"),
    )

    outline: Array
    cutting: NDArray[np.bool_]
    shank: Array
    blunt: Array | None = None
    pressed: Array | None = None
    teeth: int = 1
    behind: int = 0
    law: Law | None = None
    beside: bool = False

    @classmethod
    def of(cls, tool: LatheTool, material: Material | None) -> Turning:
        """The process of a lathe tool in stock of `material`."""
        return cls(
            outline=tool.blade,
            cutting=tool.main_edges,
            shank=tool.shank,
            behind=tool.behind,
            law=None if material is None else material.law_for(tool.rake),
        )

    def begin(self) -> ProcessState:
        from gcodesim.processes.turning_kernels import STATE

        return ProcessState(values=np.zeros(STATE))

    @property
    def zone(self) -> Zone:
        from gcodesim.processes.zone import EVERYWHERE

        return EVERYWHERE

    @classmethod
    def findings(cls, rows: Rows) -> Iterable[Diagnostic]:
        """GS401, GS431 to GS434, GS501."""
        return turning_findings(rows)

    @property
    def swept(self) -> Array | None:
        return np.ascontiguousarray(self.outline[:, ::-1])

    @cached_property
    def elements(self) -> Array:
        """Elements of the edges; see `turning_kernels.Blade`."""
        return edge_elements(self.outline, self.cutting, self.blunt, self.pressed)

    def run(self, stock: Revolved | None, window: Window, state: ProcessState) -> ProcessStep:
        """Cut `stock` (in place) along `window`; `state` is updated."""
        from gcodesim.processes import turning_kernels as kernels

        n = window.steps
        if stock is None:
            return ProcessStep.free(n)
        out = np.zeros((n, kernels.OUTPUTS))
        blade, way = self._blade(stock), _way_of(window)
        whole = None if stock.milled is None else stock.all_volume
        room = len(self.outline) + max(len(self.shank), 4) + 8
        hull, scratch = np.zeros((2 * room, 2)), np.zeros((room, 2))
        done = 0
        threads = bool((way.pitch > 0.0).any())
        while done < len(way.step):
            lathe = _lathe_of(stock, threads)
            before = done
            done, news = kernels.turn(lathe, blade, way, done, state.values, hull, scratch, out)
            if out[way.step[before:done], kernels.REMOVED].any():
                stock.last_fall = False
            if news:
                _settle(stock)
        stock.drop_loose()
        if whole is not None and out[:, kernels.REMOVED].any():
            # the profile is that of the whole turn: where a driven tool has been, part of it was gone already
            out[:, kernels.REMOVED] *= (whole - stock.all_volume) / out[:, kernels.REMOVED].sum()
        turned = out[:, kernels.TORQUE] * 2.0 * pi * way.spindle
        columns = {
            "removed": out[:, kernels.REMOVED],
            "engaged": out[:, kernels.BUSY] > 0.0,
            "torque": out[:, kernels.TORQUE],
            "power": turned,
            "main_force": out[:, kernels.MAIN],
            "feeding_force": out[:, kernels.FEEDING],
            "passive_force": out[:, kernels.PASSIVE],
            "uncut_chip": out[:, kernels.CHIP],
            "threaded": out[:, kernels.THREADED],
            "lathe_shank": out[:, kernels.SHANK],
            "lathe_guard": out[:, kernels.GUARD],
            "back_edge": out[:, kernels.BACK],
            "lathe_rapid": out[:, kernels.RAPID],
            "lathe_still": out[:, kernels.STILL],
            "lathe_inside": out[:, kernels.INSIDE] > 0.0,
        }
        if self.beside:
            off = np.zeros(n, dtype=bool)
            off[way.step[np.abs(way.start[:, 1]) > 1e-6]] = True
            columns["lathe_aside"] = off & (out[:, kernels.BUSY] > 0.0)
        wrench = np.zeros((n, 6))
        wrench[:, :3] = out[:, [kernels.FX, kernels.FY, kernels.FZ]]
        return ProcessStep(wrench=wrench, deflection=np.zeros((n, 3)), columns=columns)

    def _blade(self, stock: Revolved) -> Blade:
        from gcodesim.processes.turning_kernels import Blade

        guards = np.zeros((len(stock.guards), 8, 2))
        corners = np.zeros(len(stock.guards), dtype=np.int32)
        for g, guard in enumerate(stock.guards):
            guards[g, : len(guard.outline)] = guard.outline
            corners[g] = len(guard.outline)
        outward = 1.0 if self.outline[:, 1].mean() >= 0.0 else -1.0
        return Blade(
            outline=np.ascontiguousarray(self.outline, dtype=float),
            shank=np.ascontiguousarray(self.shank, dtype=float).reshape(-1, 2),
            elements=self.elements,
            teeth=float(self.teeth),
            law=np.zeros((3, 3)) if self.law is None else self.law.packed,
            feels=self.law is not None,
            outward=outward,
            behind=float(self.behind),
            guards=guards,
            corners=corners,
        )


def drilling_of(drill: Drill, material: Material | None) -> Turning:
    """The process of a drill in a tailstock: the same cut, with the lips sharing the feed of a turn.

    Both halves of the outline are in the work, and each bears half of what the lips do together.
    """
    from gcodesim.processes.edge_kernels import AT_R, AT_Z, PUSH, WEIGHT

    corrected = None if material is None else material.law_for(drill.rake)
    law = None if corrected is None else edge_law(drill, corrected)
    teeth = max(2, drill.flutes)
    pieces = edge_pieces(replace(drill, flutes=teeth), law)
    pressed = pieces[:, PUSH] * pieces[:, WEIGHT]
    own = np.column_stack([np.ones(len(pieces)), pieces[:, WEIGHT], pressed])
    corners = np.array([(drill.tip_height, drill.radius), (drill.flute_length, drill.radius)])
    half = np.vstack([pieces[1:, [AT_Z, AT_R]], corners[: 1 + (drill.flute_length > drill.tip_height)]])
    wall = np.tile([0.0, 1.0, 0.0], (2 * (len(half) - len(pieces)) + 1, 1))
    edges = np.vstack([own, wall, own[::-1]])
    return Turning(
        outline=np.vstack([np.zeros((1, 2)), half * [1.0, -1.0], half[::-1]]),
        cutting=edges[:, 0] > 0.0,
        shank=np.zeros((0, 2)),
        blunt=edges[:, 1],
        pressed=edges[:, 2],
        teeth=teeth,
        law=law,
        beside=True,
    )


def edge_elements(
    outline: Array, cutting: NDArray[np.bool_], blunt: Array | None = None, pressed: Array | None = None
) -> Array:
    """Elements (e, 8) of all edges (m,) of a convex outline (m, 2); short near its corners, where thin chips are.

    See `turning_kernels.Blade` for what `blunt` [-] and `pressed` [N/m] edges say of theirs; none: all are sharp.
    """
    weight = np.ones(len(outline)) if blunt is None else blunt
    push = np.zeros(len(outline)) if pressed is None else pressed
    found: list[tuple[float, ...]] = []
    for i in range(len(outline)):
        a, b = outline[i], outline[(i + 1) % len(outline)]
        way = b - a
        length = float(np.sqrt((way * way).sum()))
        if length < 1e-9:
            continue
        normal = (way[1] / length, -way[0] / length)
        for begin, end in _parts(length):
            middle = a + way * (0.5 * (begin + end) / length)
            what = float(cutting[i]), float(weight[i]), float(push[i])
            found.append((middle[0], middle[1], normal[0], normal[1], end - begin, *what))
    return np.array(found, dtype=float).reshape(-1, 8)


def _parts(length: float) -> Iterable[tuple[float, float]]:
    """Parts of an edge from both of its ends to the middle."""
    knots, size, at = [0.0], _FIRST, 0.0
    while at + size < 0.5 * length:
        at += size
        knots.append(at)
        size = min(_MOST, size * _GROWS)
    both = [*knots, *(length - knot for knot in reversed(knots))]
    return pairwise(both)


def _settle(stock: Revolved) -> None:
    """Let loose pieces fall, and make room for one ring more in every disc."""
    stock.drop_loose()
    if stock.profile.number.max(initial=0) >= stock.profile.lo.shape[1]:
        stock.profile = stock.profile.wider()


def _lathe_of(stock: Revolved, threads: bool) -> Discs:
    from gcodesim.processes.turning_kernels import Discs

    profile = stock.profile
    if profile.lo.shape[1] < 2:
        profile = stock.profile = profile.wider()
    section: Profile = stock.thread_section() if threads or stock.thread is not None else profile
    if stock.thread is not None and section.number.max(initial=0) >= section.lo.shape[1] - 1:
        section = stock.thread = section.wider()
    n = len(profile.number)
    return Discs(
        lo=profile.lo,
        hi=profile.hi,
        number=profile.number,
        thread_lo=section.lo,
        thread_hi=section.hi,
        thread_number=section.number,
        z=profile.z,
        dz=profile.dz,
        low=np.zeros(n),
        high=np.zeros(n),
        threaded=stock.thread is not None,
    )


def _half_plane(window: Window) -> tuple[Array, Array]:
    """Where pieces begin and end as (c, 2) (z, x) in the plane in which the tool moves, however far a C axis has

    turned S: the side of the tool, which turns with it, says where that plane is.
    """
    start, end = window.piece_start, window.piece_end
    x, y = np.stack([start[:, 0], end[:, 0]]), np.stack([start[:, 1], end[:, 1]])
    if window.side is not None and (np.abs(y) > ON_PLANE).any():
        side = window.side[window.piece_step]
        outwards = x * side[:, 0] + y * side[:, 1]
        x = np.where(np.abs(y) > ON_PLANE, outwards if outwards.sum() >= 0.0 else -outwards, x)
    points = np.stack([np.stack([start[:, 2], end[:, 2]]), x], axis=2)
    return points[0], points[1]


def _way_of(window: Window) -> BladeWay:
    from gcodesim.processes.turning_kernels import BladeWay

    cap = np.abs(window.signals[SPINDLE.name]) / (2.0 * pi)
    surface = window.signals[SURFACE_SPEED.name]
    (start, end), step = _half_plane(window), window.piece_step
    count = np.bincount(step, minlength=window.steps)
    middle = np.bincount(step, 0.5 * np.abs(start[:, 1] + end[:, 1]), window.steps)
    radius: Array = middle / np.maximum(count, 1)
    with np.errstate(divide="ignore", over="ignore"):
        by_surface = surface / (2.0 * pi * np.maximum(radius, 1e-12))
    share = window.piece_share
    return BladeWay(
        start=start,
        end=end,
        step=np.ascontiguousarray(step, dtype=np.int64),
        share=np.ones(len(step)) if share is None else np.ascontiguousarray(share[:, 1] - share[:, 0]),
        speed=_speeds(window),
        spindle=np.where(surface > 0.0, np.minimum(cap, by_surface), cap),
        pitch=np.ascontiguousarray(window.signals[PITCH.name], dtype=float),
        rapid=np.ascontiguousarray(window.rapid),
    )


def _speeds(window: Window) -> Array:
    """Speed (c,) [m/s] of each piece."""
    way = window.piece_end - window.piece_start
    share = window.piece_share
    parts = np.ones(len(way)) if share is None else share[:, 1] - share[:, 0]
    speed: Array = np.sqrt((way * way).sum(axis=1)) / (window.dt * np.maximum(parts, 1e-9))
    return speed


__all__: Sequence[str] = ("Turning", "drilling_of", "edge_elements")
