"""What a program acts on: kinematics, tools, processes and stock of a cell, each in its place."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field, replace
from math import isnan
from typing import TYPE_CHECKING, Final

import numpy as np

from gcodesim.arithmetic.matrices import applied
from gcodesim.cell import Cell, Placement
from gcodesim.cell.signals import SignalSource
from gcodesim.cell.stock import StockSpec
from gcodesim.frames import WORLD, Array, Pose
from gcodesim.frozen import frozen
from gcodesim.kinematics import Kinematics
from gcodesim.motion.look_ahead import LookAhead
from gcodesim.processes.sheet import Sheet
from gcodesim.processes.signal import Signal, signals_read_by
from gcodesim.rs274.dialects import DIALECTS
from gcodesim.scene import Mover, Scene
from gcodesim.scene.coated import Coated
from gcodesim.units import RPM

if TYPE_CHECKING:
    from gcodesim.material.stock import Stock
    from gcodesim.processes.materials import Material
    from gcodesim.tools.tool import Tool

USUAL_LATHE: Final = 4000.0 * RPM
"""Greatest speed [rad/s] of a lathe's spindle where the cell gives no `limits: {spindle_speed: …}`."""

SAME_AXES: Final = 1e-9
"""How far axes of a part may lean [-] and still be those of the stock that it stands in."""


@frozen(eq=False)
class PlacedStock:
    """A workpiece and its place: `X_WS` is the frame of its columns in the world at the start (table axes at zero).

    That is its own frame S, unless it lies on another side (`stock.turn`). `frame` is its name in the scene.
    """

    name: str
    frame: str
    spec: StockSpec
    stock: Stock
    X_WS: Pose
    material: Material | None
    initial: float

    @property
    def revolved(self) -> bool:
        """Whether it turns in a lathe; then `stock` is a `material.Revolved`."""
        return hasattr(self.stock, "profile")

    def seen_from(self, whole: PlacedStock) -> Pose:
        """Its frame in that of the stock that it is a part of; axes that are the same but for rounding are the same."""
        X: Pose = whole.X_WS.inverse() @ self.X_WS
        return Pose(X.p, np.eye(3)) if float(np.abs(X.R - np.eye(3)).max()) < SAME_AXES else X


@frozen(eq=False)
class Shop:
    """Everything that a channel's program acts on.

    `mover` is what the program moves, one of the scene's. `X_BM` is machine zero seen from its base B. On a machine
    tool they are the same, on a lathe B is the nose of the spindle; on an arm M is B, turned when its work systems are
    tilted. `beside` are the movers of other programs that run at the same time. `coated` are the bodies that spray may
    coat, by the names of their frames.
    """

    cell: Cell
    channel: str
    mover: Mover
    placement: Placement
    X_BM: Pose
    scene: Scene
    stocks: Mapping[str, PlacedStock] = field(default_factory=dict)
    coated: Mapping[str, Coated] = field(default_factory=dict)
    beside: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        """The mover's name, as in the log."""
        return self.mover.name

    @property
    def kinematics(self) -> Kinematics:
        return self.mover.kinematics

    @property
    def X_WB(self) -> Pose:
        return self.mover.X_WB

    @property
    def home(self) -> Array:
        return self.mover.home

    @property
    def stiffness(self) -> Array | None:
        return self.mover.stiffness

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Names as in the log: `arm/joint_1`, `machine/X`."""
        return self.mover.joint_names

    @property
    def look_ahead(self) -> LookAhead | None:
        """What the control knows of the way ahead; None: all. An arm has a control of its own, which is not known."""
        own = self.cell.channels[self.channel]
        dialect = DIALECTS[own.dialect]
        blocks = own.look_ahead
        if blocks is None:
            blocks = dialect.look_ahead if self.mover.joints_are_axes else None
        return LookAhead(blocks=blocks, corners_count=dialect.corners_count) if blocks else None

    @property
    def magazine_pose(self) -> Pose:
        """Where the first pocket is: X_W of the flange side of the tool in it."""
        placed = self.cell.magazine.place
        return self.cell.frames[placed.frame or "world"] @ placed.X

    def stand(self, number: int) -> Pose:
        """X_WF of the flange while this tool is coupled in its stand."""
        place = self.cell.magazine.stands[number].place
        return self._frame_of_stand(number) @ place.X

    def stand_axes(self, number: int, vector: Array) -> Array:
        """A vector (3,) in axes of what the stand of a tool stands in, in those of the world."""
        turned: Array = applied(self._frame_of_stand(number).R, vector)
        return turned

    def _frame_of_stand(self, number: int) -> Pose:
        return self.cell.frames[self.cell.magazine.stands[number].place.frame or WORLD]

    @property
    def sheet(self) -> Sheet:
        """The columns that a run in this cell has."""
        return Sheet.of(self.cell.tools.values(), ("turning",) if self.mover.lathe else ())

    @property
    def moves_parts(self) -> bool:
        """Whether anything in the cell may move its parts: a gripper, or a device."""
        return bool(self.cell.devices) or any("gripping" in tool.processes for tool in self.cell.tools.values())

    @property
    def signals(self) -> dict[str, Signal]:
        """What the processes of its tools read. A switch without a position of its own is off where codes switch it."""
        codes = {(code.target, code.verb) for code in self.cell.channels[self.channel].m_codes.values()}
        found = {
            name: replace(signal, default=0.0) if isnan(signal.default) and signal.is_set_by(codes) else signal
            for name, signal in signals_read_by(self.cell.tools.values()).items()
        }
        if self.mover.lathe:
            from gcodesim.processes import PROCESSES

            found |= {signal.name: signal for signal in PROCESSES["turning"].reads}
        return found

    @property
    def signal_sources(self) -> Mapping[str, SignalSource]:
        """Which words of the program give signals."""
        return self.cell.channels[self.channel].signals

    @property
    def fastest(self) -> float | None:
        """The greatest speed [rad/s] of the spindle of a lathe; None on every other machine."""
        if not self.mover.lathe:
            return None
        return self.cell.limits.spindle_speed or USUAL_LATHE

    def tool(self, number: int) -> Tool | None:
        """The tool with this number; None for the empty spindle and for numbers that the cell does not have."""
        return self.cell.tools.get(number)
