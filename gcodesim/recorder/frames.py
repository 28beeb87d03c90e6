"""The frames of a log: which there are, which move, and where they are at every step."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import applied, inverse_pose, multiplied
from gcodesim.frames import WORLD, Array, Pose
from gcodesim.frozen import frozen
from gcodesim.log import StaticFrame
from gcodesim.observation.schedule import stations_of
from gcodesim.recorder.pose_kernels import write_poses
from gcodesim.scene import WORK
from gcodesim.shop import WORK_FRAME, Shop

if TYPE_CHECKING:
    from gcodesim.motion.tool_path import ToolPath


def seven(X: Array) -> Array:
    """Poses (n, 4, 4) as rows x y z qx qy qz qw (n, 7)."""
    rows = np.empty((len(X), 1, 7))
    _write(X, rows, 0)
    return rows[:, 0]


def _write(X: Array, rows: Array, first: int) -> None:
    """Poses (n, 4, 4) as column `first` of `rows` (n, F, 7)."""
    write_poses(np.require(X, np.float64, ["C", "W"])[:, None], np.zeros(1, dtype=np.int64), first, rows)


def stock_frame(index: int, name: str) -> str:
    """Name of a stock's frame: the first one is `stock`."""
    return "stock" if index == 0 else f"stock/{name}"


@frozen(eq=False)
class Frames:
    """Frames of one shop. `links` are the links that move or carry the flange, all but the root; `flange` is F.

    `stocks` maps the names of stocks' frames in the log to those in the scene; a cell without stock has one, at G54.
    Where several programs run at once, further channels put their name (`prefix`) before `tool`, `tcp`, `part` and
    `path`, and have the stocks and fixtures that their own machine carries; all others are those of the first.
    `parts` are the frames of parts, which any gripper may move, and of devices; all are those of the first channel,
    unless nothing moves them but the machine that they stand on.
    `sensors` are named like `stocks`.
    """

    shop: Shop
    links: tuple[int, ...]
    flange: str
    stocks: Mapping[str, str]
    moving_stocks: tuple[str, ...]
    moving_work: bool
    moving_path: bool
    prefix: str = ""
    parts: tuple[str, ...] = ()
    sensors: Mapping[str, str] = field(default_factory=dict)
    moving_sensors: tuple[str, ...] = ()

    @staticmethod
    def of(shop: Shop, prefix: str = "") -> Frames:
        names = shop.kinematics.link_names
        chain = shop.kinematics.chain
        children = {joint.child for joint in chain.joints}
        links = tuple(i for i, name in enumerate(names) if name in children)
        stocks = {stock_frame(i, stock.name): stock.frame for i, stock in enumerate(shop.stocks.values())}
        stocks = stocks or ({} if prefix else {stock_frame(0, ""): WORK_FRAME})
        stocks = {name: frame for name, frame in stocks.items() if _is_drawn(shop, frame, prefix)}
        placed = {} if prefix else {s.log_frame: s.frame for s in stations_of(shop.cell) if s.frame}
        sensors = {name: frame for name, frame in placed.items() if _is_drawn(shop, frame, prefix)}
        return Frames(
            shop=shop,
            links=links,
            flange=f"{shop.name}/{chain.flange_name}",
            stocks=stocks,
            moving_stocks=tuple(name for name, frame in stocks.items() if shop.scene.moves(frame)),
            moving_work=shop.scene.moves(f"{shop.name}/{WORK}"),
            moving_path=shop.mover.shifts_work or bool(shop.placement.platforms),
            prefix=prefix,
            sensors=sensors,
            moving_sensors=tuple(name for name, frame in sensors.items() if shop.scene.moves(frame)),
            parts=_things_drawn(shop, prefix),
        )

    @property
    def static(self) -> tuple[StaticFrame, ...]:
        """Frames that never move, seen from the world."""
        shop = self.shop
        stands = {placed.frame: placed.X_WS for placed in shop.stocks.values()}
        resting = [
            _static(name, stands[frame] if frame in stands else shop.placement.X_W("G54"))
            for name, frame in self.stocks.items()
            if name not in self.moving_stocks
        ]
        resting += [
            _static(name, shop.scene.at_rest(frame))
            for name, frame in self.sensors.items()
            if name not in self.moving_sensors
        ]
        return (_static(self.base, shop.X_WB), *resting)

    def carrier(self, frame: str) -> tuple[str, Pose]:
        """The frame of the log that carries a frame of the scene, and where the latter stands in it."""
        shop = self.shop
        on, X = shop.scene.standing_on(frame)
        mover, _, link = on.partition("/")
        if mover != shop.name or not shop.scene.moves(on):
            return WORLD, shop.scene.at_rest(frame)
        if link == WORK:
            chain = shop.kinematics.chain
            assert chain.table is not None
            index = chain.link_names.index(chain.table)
            at_zero = shop.kinematics.link(np.zeros((1, len(shop.home))), index)[0]
            return self.link_frame(index), Pose.from_matrix(at_zero).inverse() @ X
        return on, X

    @property
    def base(self) -> str:
        return f"{self.shop.name}/{self.shop.kinematics.chain.base_name}"

    def link_frame(self, index: int) -> str:
        """Name of the frame of a link; the root is the base."""
        return self.base if index not in self.links else f"{self.shop.name}/{self.shop.kinematics.link_names[index]}"

    @property
    def path_frame(self) -> str:
        """The frame in which the planned path is at rest: it moves with the work systems, as the work does."""
        return f"{self.prefix}path" if self.moving_path else "world"

    @property
    def tool(self) -> str:
        """The frame of the tool."""
        return f"{self.prefix}tool"

    def draws(self, frame: str) -> bool:
        """Whether a body of the scene belongs to this channel."""
        return _is_drawn(self.shop, frame, self.prefix)

    @property
    def moving(self) -> tuple[tuple[str, str], ...]:
        """(parent, child) of all frames that move, in the order of `at`."""
        frames = [(self.base, self.link_frame(i)) for i in self.links]
        if self.flange_is_extra:
            frames.append((self.base, self.flange))
        frames += [(self.flange, self.tool), ("world", f"{self.prefix}tcp"), ("world", f"{self.prefix}part")]
        frames += [("world", name) for name in self.moving_stocks]
        if self.moving_path:
            frames.append(("world", self.path_frame))
        frames += [("world", name) for name in self.parts]
        frames += [("world", name) for name in self.moving_sensors]
        return tuple(frames)

    @property
    def flange_is_extra(self) -> bool:
        """Whether no link has the name of F, so that the frame has to be added."""
        return self.flange not in {self.link_frame(i) for i in self.links}

    def at(self, q: Array, tcp: Array, tools: Array, part: Array, parts: Array | None = None) -> Array:
        """Poses (n, F, 7) of the moving frames in their parents.

        `q` (n, j), `tcp` (n, 4, 4) actual tip in W, `tools` (n, 4, 4) X_FT,
        `part` (n, 4, 4) active work system in W where it is now (`carried`);
        `parts` (n, parts, 4, 4) X_WP of what is carried, None while all of it lies where it did at the start.
        """
        shop = self.shop
        columns = [shop.kinematics.forward(q)] if self.flange_is_extra else []
        columns += [tools, tcp, part]
        columns += [shop.scene.track(self.stocks[name], {shop.name: q}) for name in self.moving_stocks]
        if self.moving_path:
            system = min(shop.placement.platforms, default=1)
            systems = np.full(len(q), system, dtype=np.int64)
            columns.append(self.carried(q, np.tile(np.eye(4), (len(q), 1, 1)), systems))
        for index, name in enumerate(self.parts):
            columns.append(shop.scene.track(name, {shop.name: q}) if parts is None else parts[:, index])
        columns += [shop.scene.track(self.sensors[name], {shop.name: q}) for name in self.moving_sensors]
        rows = np.empty((len(q), len(self.links) + len(columns), 7))
        write_poses(shop.kinematics.links(q), np.array(self.links, dtype=np.int64), 0, rows)
        for column, X in enumerate(columns, start=len(self.links)):
            _write(X, rows, column)
        return rows

    def carried(self, q: Array, X_WP: Array, systems: NDArray[np.int64]) -> Array:
        """Poses (n, 4, 4) in W, given for a table at zero, moved as the work systems with these numbers (n,) at `q`.

        Linear axes of a table shift them; what external axes carry turns too.
        """
        platforms = self.shop.placement.platforms
        if platforms:
            return self._on_platforms(q, X_WP, systems)
        if not self.moving_work:
            return X_WP
        X = X_WP.copy()
        X[:, :3, 3] += applied(self.shop.X_WB.R, self.shop.kinematics.table_travel(q))
        return X

    def _on_platforms(self, q: Array, X_WP: Array, systems: NDArray[np.int64]) -> Array:
        shop, X = self.shop, X_WP.copy()
        still = shop.cell.platforms
        for system, link in shop.placement.platforms.items():
            here = systems == system
            if here.any():
                moved = shop.scene.track(link, {shop.name: q[here]})
                X[here] = multiplied(moved, still[link].inverse().matrix, X_WP[here])
        return X

    def seen_from_table(self, q: Array, X_W: Array) -> Array:
        """Poses (n, 4, 4) in W as seen from the table; unchanged where no axis moves a table."""
        if not self.moving_work:
            return X_W
        shop = self.shop
        X: Array = multiplied(inverse_pose(shop.scene.track(f"{shop.name}/{WORK}", {shop.name: q})), X_W)
        return X


def _is_drawn(shop: Shop, frame: str, prefix: str) -> bool:
    """Whether something in the scene is drawn with this channel: what its machine carries, with the first all at rest.

    What a machine carries that no program moves is at rest.
    """
    carrier = shop.scene.standing_on(frame)[0].partition("/")[0]
    if carrier == shop.name and shop.scene.moves(frame):
        return True
    return not prefix and not (carrier in shop.beside and shop.scene.moves(frame))


def things_of(shop: Shop) -> tuple[str, ...]:
    """The frames of parts, then those of devices."""
    return tuple(body.name for role in ("part", "obstacle") for body in shop.scene.bodies if body.role == role)


def _things_drawn(shop: Shop, prefix: str) -> tuple[str, ...]:
    """The parts and devices that are drawn with a channel."""
    if shop.moves_parts:
        return () if prefix else things_of(shop)
    return tuple(name for name in things_of(shop) if _is_drawn(shop, name, prefix))


def _static(name: str, X: Pose) -> StaticFrame:
    return StaticFrame(parent="world", child=name, p=X.p, q=X.q)


def work_systems(shop: Shop, path: ToolPath) -> Array:
    """X_WP (s, 4, 4) of the work system of each tool state of the path."""
    poses = []
    for state in path.states:
        X_WP = shop.placement.X_WM @ state.X_MP @ Pose.from_xyz_rpy((state.g92[0], state.g92[1], state.g92[2]))
        poses.append(X_WP.matrix)
    return np.array(poses)
