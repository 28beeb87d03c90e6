"""The frames of a log: which there are, which move, and where they are at every step."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gcodesim.frames import Array, Pose
from gcodesim.log import StaticFrame
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


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Frames:
    """Frames of one shop. `links` are the links that move or carry the flange, all but the root."""

    shop: Shop
    links: tuple[int, ...]
    flange: str
    moving_stock: bool
    moving_path: bool

    @staticmethod
    def of(shop: Shop) -> Frames:
        names = shop.kinematics.link_names
        chain = shop.kinematics.chain
        children = {joint.child for joint in chain.joints}
        links = tuple(i for i, name in enumerate(names) if name in children)
        return Frames(
            shop=shop,
            links=links,
            flange=f"{shop.name}/{chain.flange}",
            moving_stock=shop.scene.moves(f"{shop.name}/{WORK}"),
            moving_path=shop.mover.shifts_work,
        )

    @property
    def static(self) -> tuple[StaticFrame, ...]:
        """Frames that never move, seen from the world."""
        shop = self.shop
        frames = [_static(self.base, shop.X_WB)]
        if not self.moving_stock:
            frames += [_static(stock_frame(i, p.name), p.X_WS) for i, p in enumerate(shop.stocks.values())]
            if not shop.stocks:
                frames.append(_static("stock", shop.placement.X_W("G54")))
        return tuple(frames)

    @property
    def base(self) -> str:
        return f"{self.shop.name}/base"

    def link_frame(self, index: int) -> str:
        """Name of the frame of a link; the root is the base."""
        return self.base if index not in self.links else f"{self.shop.name}/{self.shop.kinematics.link_names[index]}"

    @property
    def path_frame(self) -> str:
        """The frame in which the planned path rests: it goes along with the table's linear axes, as work does."""
        return "path" if self.moving_path else "world"

    @property
    def moving(self) -> tuple[tuple[str, str], ...]:
        """(parent, child) of all frames that move, in the order of `at`."""
        frames = [(self.base, self.link_frame(i)) for i in self.links]
        if self.flange_is_extra:
            frames.append((self.base, self.flange_name))
        frames += [(self.flange_name, "tool"), ("world", "tcp"), ("world", "part")]
        if self.moving_stock:
            frames += [("world", stock_frame(i, p.name)) for i, p in enumerate(self.shop.stocks.values())]
            if not self.shop.stocks:
                frames.append(("world", "stock"))
        if self.moving_path:
            frames.append(("world", self.path_frame))
        return tuple(frames)

    @property
    def flange_name(self) -> str:
        return f"{self.shop.name}/flange"

    @property
    def flange_is_extra(self) -> bool:
        """Whether no link is called `flange`, so that the frame has to be added."""
        return self.flange_name not in {self.link_frame(i) for i in self.links}

    def at(self, q: Array, tcp: Array, tools: Array, part: Array) -> Array:
        """Poses (n, F, 7) of the moving frames in their parents.

        `q` (n, j), `tcp` (n, 4, 4) actual tip in W, `tools` (n, 4, 4) X_FT,
        `part` (n, 4, 4) active work system in W where it is now (`carried`).
        """
        shop = self.shop
        columns = [shop.kinematics.forward(q)] if self.flange_is_extra else []
        columns += [tools, tcp, part]
        if self.moving_stock:
            now = {shop.name: q}
            columns += [shop.scene.track(stock.frame, now) for stock in shop.stocks.values()]
            if not shop.stocks:
                columns.append(shop.scene.track(WORK_FRAME, now))
        if self.moving_path:
            columns.append(self.carried(q, np.tile(np.eye(4), (len(q), 1, 1))))
        rows = np.empty((len(q), len(self.links) + len(columns), 7))
        write_poses(shop.kinematics.links(q), np.array(self.links, dtype=np.int64), 0, rows)
        for column, X in enumerate(columns, start=len(self.links)):
            _write(X, rows, column)
        return rows

    def carried(self, q: Array, X_WP: Array) -> Array:
        """Work systems (n, 4, 4) in W, given for a table at zero, where the table's linear axes at `q` bring them."""
        if not self.moving_stock:
            return X_WP
        X = X_WP.copy()
        X[:, :3, 3] += self.shop.kinematics.table_travel(q) @ self.shop.X_WB.R.T
        return X

    def seen_from_table(self, q: Array, X_W: Array) -> Array:
        """Poses (n, 4, 4) in W as the table sees them, which is the same where no axis moves a table."""
        if not self.moving_stock:
            return X_W
        shop = self.shop
        X: Array = np.linalg.inv(shop.scene.track(f"{shop.name}/{WORK}", {shop.name: q})) @ X_W
        return X


def _static(name: str, X: Pose) -> StaticFrame:
    return StaticFrame(parent="world", child=name, p=X.p, q=X.q)


def work_systems(shop: Shop, path: ToolPath) -> Array:
    """X_WP (s, 4, 4) of the work system of each tool state of the path."""
    poses = []
    for state in path.states:
        x, y, z = state.system_offset[:3]
        turn = Pose.from_xyz_rpy((x, y, z), (0.0, 0.0, state.rotation))
        X_WP = shop.placement.X_WM @ turn @ Pose.from_xyz_rpy((state.g92[0], state.g92[1], state.g92[2]))
        poses.append(X_WP.matrix)
    return np.array(poses)
