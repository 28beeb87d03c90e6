"""Loading: a force and a torque at the tip that the cell, the program or a script sets, and that nothing answers.

Constant as `load:` of the tool says, times the signal `load`, and what the signals `load_fx` to `load_mz` say besides.
The machine yields to it as to the force of any process: the other processes of the tool act where it puts the tip.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import nan
from typing import TYPE_CHECKING, Any, ClassVar, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import applied
from gcodesim.frozen import frozen
from gcodesim.processes.protocol import ActsOn, Process
from gcodesim.processes.signal import SetBy, Signal
from gcodesim.processes.window import ProcessState, ProcessStep, Window

if TYPE_CHECKING:
    from gcodesim.processes.materials import Material
    from gcodesim.tools.tcp_load import TcpLoad
    from gcodesim.tools.tool import Tool

Array = NDArray[np.float64]

LOAD: Final = Signal("load", default=1.0, set_by=(SetBy("load", "on", 1.0), SetBy("load", "off", 0.0)))
"""Share of the tool's constant load that acts."""

PUSHES: Final = (
    *(Signal(f"load_f{axis}", "N", with_moves=True) for axis in "xyz"),
    *(Signal(f"load_m{axis}", "N·m", with_moves=True) for axis in "xyz"),
)
"""Force and torque besides the constant load."""

LOAD_IN_TOOL: Final = Signal("load_in_tool", default=nan, with_moves=True)
"""1: `PUSHES` are in axes of the tool; 0: of the world; not a number: as the tool's `load` says."""


@frozen(slots=False, eq=False)
class Loading(Process):
    """The load of a tool."""

    kind: ClassVar[str] = "loading"
    acts_on: ClassVar[ActsOn] = "nothing"
    pushes: ClassVar[bool] = True
    leads: ClassVar[bool] = True
    reads: ClassVar[tuple[Signal, ...]] = (LOAD, *PUSHES, LOAD_IN_TOOL)

    load: TcpLoad

    @classmethod
    def of(cls, tool: Tool, material: Material | None) -> Loading:
        assert tool.load is not None
        return cls(load=tool.load)

    def rests(self, window: Window) -> bool:
        return bool(self.idles(window.signals, window.steps).all())

    def idles(self, signals: Mapping[str, NDArray[Any]], steps: int) -> NDArray[np.bool_]:
        """In which steps (n,) nothing pulls at the tip."""
        pulls = np.concatenate([self._constant(signals), self._besides(signals)], axis=1)
        idle: NDArray[np.bool_] = ~np.any(pulls, axis=1)
        return idle

    def run(self, target: None, window: Window, state: ProcessState) -> ProcessStep:
        """The load in axes of S; the tip yields to it by the compliance."""
        wrench = self._wrench(window)
        deflection = np.zeros((window.steps, 3))
        if window.compliance is not None:
            deflection = applied(window.compliance[:, :3], wrench)
        return ProcessStep(wrench=wrench, deflection=deflection)

    def loop(self, target: None, window: Window, state: ProcessState) -> GivenLoad:
        return GivenLoad(step_of=self.run(target, window, state))

    def _constant(self, signals: Mapping[str, NDArray[Any]]) -> Array:
        """(n, 6) in axes of the load's frame."""
        wrench: Array = np.asarray(signals[LOAD.name], dtype=float)[:, None] * np.array(
            [*self.load.force, *self.load.torque]
        )
        return wrench

    def _besides(self, signals: Mapping[str, NDArray[Any]]) -> Array:
        return np.stack([np.asarray(signals[signal.name], dtype=float) for signal in PUSHES], axis=1)

    def _wrench(self, window: Window) -> Array:
        """(n, 6) in S."""
        usual = 1.0 if self.load.frame == "tool" else 0.0
        told = np.asarray(window.signals[LOAD_IN_TOOL.name], dtype=float)
        own = np.full(window.steps, usual)
        return _turned(self._constant(window.signals), own, window) + _turned(
            self._besides(window.signals), np.where(np.isnan(told), usual, told), window
        )


@frozen(eq=False)
class GivenLoad:
    """A window step by step: the load is known beforehand, whatever the machine does."""

    step_of: ProcessStep

    def step(self, k: int, moved_before: Array, moved: Array, share: Array) -> Array:
        row: Array = self.step_of.wrench[k]
        return row

    def finish(self) -> ProcessStep:
        return self.step_of


def _turned(wrench: Array, in_tool: Array, window: Window) -> Array:
    """Wrenches (n, 6) in axes of the tool where `in_tool` (n,), elsewhere of the world, into S."""
    turned = np.zeros_like(wrench)
    tool = in_tool > 0.5
    for rows, R in ((tool, _tool_axes), (~tool, _world_axes)):
        if wrench[rows].any():
            axes = R(window)[rows]
            turned[rows, :3], turned[rows, 3:] = applied(axes, wrench[rows, :3]), applied(axes, wrench[rows, 3:])
    return turned


def _tool_axes(window: Window) -> Array:
    """R_ST (n, 3, 3) at the ends of the steps."""
    assert window.side is not None
    z = -window.axis
    return np.stack([window.side, np.cross(z, window.side), z], axis=-1)


def _world_axes(window: Window) -> Array:
    """R_SW (n, 3, 3); S is the world where nobody says otherwise."""
    if window.where is None:
        return np.tile(np.eye(3), (window.steps, 1, 1))
    axes: Array = window.where("world")[:, :3, :3]
    return axes
