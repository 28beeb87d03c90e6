"""A watcher that shows the run in a window, and says what is clicked at."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Final, Protocol

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import applied, inverse_pose, multiplied
from gcodesim.diagnostics import Diagnostic, Span
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.observation.stage import Hand, Stage, stock_skin, surface_of

if TYPE_CHECKING:
    from gcodesim.executor.record import StepRecord
    from gcodesim.executor.watcher import Watcher
    from gcodesim.executor.window import StepWindow
    from gcodesim.material.surface import Surface
    from gcodesim.planning import Plan
    from gcodesim.shop import Shop
    from gcodesim.world import WorldSteps

FRAME_NS: Final = 40_000_000
"""Simulated time between two pictures."""

LOOK_NS: Final = 500_000_000
"""Simulated time between two looks at the stocks."""

PATH: Final = (0.10, 0.55, 0.85)
_POINTS: Final = 2000  # of the path that is drawn


@frozen(eq=False)
class _Look:
    """What was seen at the end of a window: by the inner watcher, and the stocks whenever it is time."""

    inner: Any
    surfaces: Mapping[str, Surface]


class Screen(Protocol):
    """What a spectator draws into; see `world.window.BodyWindow`."""

    @property
    def is_open(self) -> bool: ...

    def shape(self, name: str, triangles: Array, colors: NDArray[np.uint8]) -> None: ...

    def forget(self, name: str) -> None: ...

    def place(self, name: str, X: Array) -> None: ...

    def line(self, points: Array, color: tuple[float, float, float], width: float = 2.0) -> None: ...

    def look_at(self, target: Array, distance: float) -> None: ...

    def clicks(self) -> Iterator[tuple[Array, Array]]: ...


@frozen(eq=False)
class Picked:
    """A body that somebody pointed at: its name, X_W (4, 4) of its frame, the point (3,), its line in the cell."""

    name: str
    X: Array
    point: Array
    span: Span

    @property
    def text(self) -> str:
        """`fixture/vise: frame at X600 Y0 Z300 mm, point at … mm, cell.yaml:7`."""
        frame, point = (
            " ".join(f"{letter}{1000.0 * value:.1f}" for letter, value in zip("XYZ", at, strict=True))
            for at in (self.X[:3, 3], self.point)
        )
        return f"{self.name}: frame at {frame} mm, point at {point} mm, {self.span.file}:{self.span.line}"


class Spectator:
    """Shows `shop` on a screen while it runs, and lets `inner`, another watcher, watch as well.

    The run is the same as without it. `tell` gets a text about each body that is clicked at.
    """

    def __init__(
        self, shop: Shop, step_ns: int, screen: Screen, inner: Watcher | None, tell: Callable[[str], None]
    ) -> None:
        self._shop, self._screen, self._inner, self._tell = shop, screen, inner, tell
        self._every = max(FRAME_NS // step_ns, 1)
        self._between_looks, self._next_look = max(LOOK_NS // step_ns, 1), 0
        self._stage = Stage.of(shop)
        self._shapes: dict[str, Array] = {}
        self._at: dict[str, Array] = {}
        self._hands: dict[str, Hand] = {}
        self._show_all()

    # ---- as a watcher

    @property
    def interval_steps(self) -> int:
        return 5 * self._every if self._inner is None else self._inner.interval_steps

    def stops(self, plans: Sequence[Plan], first: int, last: int) -> Sequence[int]:
        return () if self._inner is None else self._inner.stops(plans, first, last)

    def start(self, world_steps: WorldSteps, window: StepWindow) -> None:
        if self._inner is not None:
            self._inner.start(world_steps, window)
        self._surfaces({name: surface_of(stock) for name, stock in self._shop.stocks.items()})
        own = {self._shop.name: world_steps.q[-1][None]}
        self._picture(own, self._stage.hands_at_start() | {self._shop.name: Hand(tool=int(window.tool[-1]))}, {})
        low, high = self._room()
        # pybullet's window is 90 degrees high, so that a ball around everything fills it from this distance
        self._screen.look_at(0.5 * (low + high), math.sqrt(0.5) * float(np.linalg.norm(high - low)))

    def look(self, window: StepWindow) -> _Look:
        inner = None if self._inner is None else self._inner.look(window)
        step = window.first + len(window)
        if step < self._next_look:
            return _Look(inner=inner, surfaces={})
        self._next_look = step + self._between_looks
        return _Look(inner=inner, surfaces={n: surface_of(stock) for n, stock in self._shop.stocks.items()})

    def take(self, record: StepRecord, found: Sequence[Diagnostic], seen: _Look) -> Callable[[], None]:
        if self._screen.is_open:
            for k in (*range(self._every - 1, len(record) - 1, self._every), len(record) - 1):
                records = {self._shop.name: record, **record.beside}
                joints = {name: its.world.q[k][None] for name, its in records.items()}
                hands = {name: Hand.in_step(its, k, self._shop) for name, its in records.items()}
                self._picture(joints, hands, record.places(k))
            self._surfaces(seen.surfaces)
            self.answer()
        return _nothing if self._inner is None else self._inner.take(record, found, seen.inner)

    def follow(self, plan: Plan) -> None:
        self.draw_path(plan)
        if self._inner is not None:
            self._inner.follow(plan)

    # ---- besides

    def draw_path(self, plan: Plan) -> None:
        """Draw the programmed points of a plan as a line."""
        if not len(plan.path) or not self._screen.is_open:
            return
        points = plan.path.positions
        points = points[:: -(-len(points) // _POINTS)]
        self._screen.line(self._shop.X_WB.apply(points), PATH)

    def answer(self) -> None:
        """Say what was clicked at since the last time."""
        for eye, direction in self._screen.clicks():
            picked = self.picked(eye, direction)
            if picked is not None:
                self._tell(picked.text)

    def picked(self, eye: Array, direction: Array) -> Picked | None:
        """The first body that a ray from `eye` (3,) in a `direction` (3,) meets; None: it meets none."""
        nearest: tuple[float, str] | None = None
        for name, triangles in self._shapes.items():
            if name not in self._at:
                continue
            X = inverse_pose(self._at[name][None])[0]
            far = _met(triangles, applied(X[:3, :3], eye) + X[:3, 3], applied(X[:3, :3], direction))
            if far is not None and (nearest is None or far < nearest[0]):
                nearest = (far, name)
        if nearest is None:
            return None
        far, name = nearest
        return Picked(name=_label(name), X=self._at[name], point=eye + far * direction, span=self._span(name))

    # ---- inside

    def _show_all(self) -> None:
        for name, skins in _links_of(self._stage).items():
            self._shape(name, *skins)
        for number, (frame, skin) in enumerate(self._stage.bodies):
            self._shape(f"{frame}#{number}", skin.triangles, skin.color)

    def _shape(self, name: str, triangles: Array, colors: NDArray[np.uint8]) -> None:
        self._shapes[name] = triangles
        self._screen.shape(name, triangles, colors)

    def _place(self, name: str, X: Array) -> None:
        self._at[name] = X
        self._screen.place(name, X)

    def _picture(self, joints: Mapping[str, Array], hands: Mapping[str, Hand], places: Mapping[str, Array]) -> None:
        """Show movers at `joints[mover]` (1, j), what they hold, and at their `places` what else has moved."""
        shop = self._shop
        for name, mover in shop.scene.movers.items():
            at = mover.kinematics.links(joints.get(name, mover.home[None]))[0]
            for index, link in enumerate(mover.kinematics.link_names):
                if f"{name}/{link}" in self._shapes:
                    self._place(f"{name}/{link}", multiplied(mover.X_WB.matrix, at[index]))
        for number, (frame, _) in enumerate(self._stage.bodies):
            X = places[frame] if frame in places else shop.scene.track(frame, joints)[0]
            self._place(f"{frame}#{number}", X)
        for holder, hand in hands.items():
            if hand != self._hands.get(holder):
                self._change(holder, hand)
            X_WT = self._stage.tip(joints, hand.tool, holder)
            for name in self._shapes:
                if name.startswith(f"tool#{holder}#"):
                    self._place(name, X_WT)
        for name, placed in shop.stocks.items():
            self._place(f"stock/{name}", shop.scene.track(placed.frame, joints)[0])

    def _change(self, mover: str, hand: Hand) -> None:
        for name in [name for name in self._shapes if name.startswith(f"tool#{mover}#")]:
            self._screen.forget(name)
            del self._shapes[name], self._at[name]
        for number, skin in enumerate(self._stage.held(hand)):
            self._shape(f"tool#{mover}#{hand.tool}#{number}", skin.triangles, skin.color)
        self._hands[mover] = hand

    def _surfaces(self, surfaces: Mapping[str, Surface]) -> None:
        for name, surface in surfaces.items():
            skin = stock_skin(surface)
            self._shape(f"stock/{name}", skin.triangles, skin.color)
            if f"stock/{name}" in self._at:
                self._screen.place(f"stock/{name}", self._at[f"stock/{name}"])

    def _room(self) -> tuple[Array, Array]:
        """A box around everything."""
        corners = [
            applied(X[:3, :3], self._shapes[name].reshape(-1, 3)) + X[:3, 3]
            for name, X in self._at.items()
            if len(self._shapes[name])
        ]
        return np.min([c.min(axis=0) for c in corners], axis=0), np.max([c.max(axis=0) for c in corners], axis=0)

    def _span(self, name: str) -> Span:
        """Where the cell says something of a body."""
        cell, (kind, _, rest) = self._shop.cell, name.partition("#")[0].partition("/")
        if name.startswith("tool#"):
            return cell.span("tools", int(name.split("#")[2]))
        places: Mapping[str, tuple[str, ...]] = {
            "fixture": ("fixtures", rest),
            "part": ("parts", rest),
            "stock": ("stock", rest),
            "device": ("devices", rest),
            "machine": ("machine",),
        }
        return cell.span(*places.get(kind, ("robots", kind)))


def _links_of(stage: Stage) -> dict[str, tuple[Array, NDArray[np.uint8]]]:
    """Triangles and a colour for each of all links, by `mover/link`."""
    found: dict[str, list[tuple[Array, NDArray[np.uint8]]]] = {}
    for name, skins in stage.links.items():
        names = stage.shop.scene.movers[name].kinematics.link_names
        for index, skin in skins:
            colors = np.broadcast_to(skin.color, (len(skin.triangles), 3))
            found.setdefault(f"{name}/{names[index]}", []).append((skin.triangles, colors))
    return {
        name: (np.concatenate([each[0] for each in all_of]), np.concatenate([each[1] for each in all_of]))
        for name, all_of in found.items()
    }


def _label(name: str) -> str:
    """`fixture/vise` of a solid `fixture/vise#0`, `T1` of a part of the tool."""
    body, *rest = name.split("#")
    return f"T{rest[1]}" if body == "tool" else body


def _met(triangles: Array, eye: Array, direction: Array) -> float | None:
    """How far [m] along a ray the first of triangles (t, 3, 3) is; None: it meets none (Möller, Trumbore 1997)."""
    a = triangles[:, 0]
    e1, e2 = triangles[:, 1] - a, triangles[:, 2] - a
    h = np.cross(direction, e2)
    det = (e1 * h).sum(axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        s = eye - a
        u = (s * h).sum(axis=1) / det
        n = np.cross(s, e1)
        v = (n @ direction) / det
        far = (e2 * n).sum(axis=1) / det
        hit = (np.abs(det) > 1e-15) & (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0) & (far > 0.0)
    return float(far[hit].min()) if hit.any() else None


def _nothing() -> None:
    """There is nothing to write."""
