"""One machine or robot of a scene: its kinematics, where it stands, and what the rest of a run asks about it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Final, Literal

import numpy as np

from gcodesim.controllers.controller import Controller
from gcodesim.frames import Array, Pose
from gcodesim.frozen import frozen
from gcodesim.kinematics.chain import BASE, FLANGE

if TYPE_CHECKING:
    from gcodesim.kinematics.protocol import Kinematics

WORK: Final = "work side"
"""The frame C of what carries the work. It lies on the base while the joints that carry it stand at zero."""


@frozen(eq=False)
class Mover:
    """Something that a program moves. Its frames are called `<name>/<link>`, as in the log.

    `X_WB` is its base B in the world (of a machine tool: M), `home` (j,) where its joints start, `stiffness` (j,)
    [N·m/rad] or [N/m] or None for a rigid one. `joints_are_axes` says that the joints are what the letters X to C of
    a program name; `rapids` is how G0 moves these.

    `retreat` (3,) is the direction, in the path's X, Y, Z, in which a tool leaves the work along its own axis; None
    where it depends on the pose. `timed_only` are joints whose place is unknown, so that they only take time.
    `seen_whole`: a viewer should see all of it beside the part; `lathe`: the work
    turns, about Z at X0 of its base. `description` is the file that describes it; `externals` are joints outside
    of that, which have names of their own; `controller` is how its motors follow the command, None: as usual in the
    world in which it moves;
    `may_meet` are pairs of links that the cell lets touch each other. `own_table` is the link on which a machine tool
    holds what names no link, where its work side is another one.
    """

    name: str
    kinematics: Kinematics
    X_WB: Pose
    home: Array
    stiffness: Array | None = None
    joints_are_axes: bool = False
    rapids: Literal["linear", "independent"] = "linear"
    retreat: Array | None = None
    timed_only: tuple[str, ...] = ()
    seen_whole: bool = True
    lathe: bool = False
    description: Path | None = None
    controller: Controller | None = None
    externals: tuple[str, ...] = ()
    may_meet: tuple[tuple[str, str], ...] = ()
    own_table: str | None = None

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Names as in the log: `arm/joint_1`, `machine/X`, `rail/U`."""
        names = self.kinematics.joints.names
        return tuple(joint if joint in self.externals else f"{self.name}/{joint}" for joint in names)

    def seen_from_base(self, link: str, q: Array) -> Array:
        """X_BL (n, 4, 4) of a link, the flange or the work side with the joints at `q` (n, j); KeyError: no such."""
        kinematics = self.kinematics
        if link == WORK:
            return kinematics.table(q)
        if link in kinematics.link_names:
            return kinematics.link(q, kinematics.link_names.index(link))
        if link == FLANGE:
            return kinematics.forward(q)
        if link == BASE:
            return np.tile(np.eye(4), (len(q), 1, 1))
        raise KeyError(link)

    def moves(self, link: str) -> bool:
        """Whether a joint of this mover carries the link, the flange or the work side."""
        chain = self.kinematics.chain
        if link == WORK:
            if chain.table is None:
                return False
            link = chain.table
        if link in chain.link_names:
            return bool(chain.tree.carrier[chain.link_names.index(link)] >= 0)
        return link == FLANGE and chain.tree.flange_carrier >= 0

    @property
    def shifts_work(self) -> bool:
        """Whether a linear joint carries the work, and work systems with it."""
        return bool(self.kinematics.table_travel(np.full((1, len(self.kinematics.joints)), 0.1)).any())
