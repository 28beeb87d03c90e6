"""A tool of an open cell: coupled, switched on, closed, pulled at."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import ArrayLike

from gcodesim.given import number, numbers
from gcodesim.motion.tool_path import ToolPath
from gcodesim.session.misuse import MisuseError, as_misuse
from gcodesim.session.switches import CLOSE, ON, OPEN, hears, settings_of, turns
from gcodesim.tools.tcp_load import LOAD_FRAMES

if TYPE_CHECKING:
    from gcodesim.session.arm import Arm
    from gcodesim.session.cell_in_hand import OpenCell
    from gcodesim.session.machine import MovedMachine
    from gcodesim.tools.tool import Tool


class HandTool:
    """A tool of an open cell."""

    def __init__(self, cell: OpenCell, number: int) -> None:
        self._cell, self.number = cell, number

    @property
    def spec(self) -> Tool:
        """What the cell says of it."""
        return self._cell._shop.cell.tools[self.number]

    @property
    def is_coupled(self) -> bool:
        return self._holder is not None

    @property
    def _holder(self) -> MovedMachine | None:
        return self._cell._holder(self.number)

    def couple(self, arm: Arm) -> None:
        """Let `arm` hold the tool; like M6, it takes the time that the cell says, with the next steps.

        MisuseError when the arm holds a tool already, is of another cell, or is none, and when another arm holds this
        tool.
        """
        from gcodesim.session.arm import Arm

        if not isinstance(arm, Arm):
            raise MisuseError(f"tool {self.number} is coupled to an arm of the cell, as `cell.robot(…)` gives it")
        if arm._cell is not self._cell:
            raise MisuseError(f"tool {self.number} and `{arm.name}` are in two different cells")
        held, holder = arm._machine.state.tool, self._holder
        if held == self.number:
            raise MisuseError(f"`{arm.name}` holds tool {held} already")
        if held:
            raise MisuseError(f"`{arm.name}` holds tool {held}; decouple that first")
        if holder is not None:
            raise MisuseError(f"`{holder.shop.name}` holds tool {self.number}; decouple it there first")
        self._cell._check_open()
        arm._machine.change_tool(self.number)

    def decouple(self) -> None:
        """Put the tool back. MisuseError when no robot holds it."""
        self._held().change_tool(0)

    def activate(self) -> None:
        """Switch the process of the tool on, from the next step on.

        MisuseError when no robot holds it, or when it is a tool that is not switched, such as a mill or a gripper.
        """
        holder = self._held()
        if not hears(self.spec, ON):
            instead = "; a gripper has `close` and `open`" if hears(self.spec, CLOSE) else ""
            instead = "; a cutter takes `spin`" if hasattr(self.spec, "flutes") else instead
            raise MisuseError(f"tool {self.number} ({self.spec.kind}) has nothing that could be switched on{instead}")
        holder.active = True

    def deactivate(self) -> None:
        """Switch the process off. MisuseError when no robot holds the tool."""
        self._held().active = False

    def close(self) -> None:
        """Close the gripper, or switch its vacuum on, with the next step. MisuseError when no robot holds it, or it is
        no gripper.
        """
        self._tell(CLOSE)

    def open(self) -> None:
        """Open the gripper, or switch its vacuum off; MisuseError as of `close`."""
        self._tell(OPEN)

    def _tell(self, order: tuple[str, str]) -> None:
        holder = self._held()
        if not hears(self.spec, order):
            raise MisuseError(f"tool {self.number} ({self.spec.kind}) is no gripper")
        holder.switches.tell(order)

    @property
    def settings(self) -> dict[str, float | None]:
        """What `set` can set, by name in SI; None where the tool's own value holds, as the cell gives it."""
        holder = self._holder
        values = {} if holder is None else holder.switches.values
        return {name: values.get(name) for name in settings_of(self.spec)}

    def set(self, name: str, value: float) -> None:
        """Set what `signals` of a cell give a program's tools, in SI: `set("power", 400.0)`, from the next step on.

        It holds until another value or until the tool is put back. MisuseError when no robot holds it, when it has no
        such setting, and for a value that the setting cannot have.
        """
        holder = self._held()
        known = settings_of(self.spec)
        if name not in known:
            listed = f"it has {', '.join(known)}" if known else "it has none"
            raise MisuseError(f"tool {self.number} ({self.spec.kind}) has no setting `{name}`; {listed}")
        signal = known[name]
        with as_misuse():
            value = number(value, f"`{name}`")
        if not (signal.least <= value <= signal.most):
            unit = f" {signal.unit}" if signal.unit else ""
            reach = f"from {signal.least:g} to {signal.most:g}{unit}" if np.isfinite(signal.most) else "0 or more"
            raise MisuseError(f"`{name}` of tool {self.number} cannot be {value:g}{unit}; it can be {reach}")
        holder.switches.set(name, float(value))

    def spin(self, speed: float) -> None:
        """Turn the spindle from the next step on [rad/s]; above 0 as M3, below as M4, 0 stops it.

        MisuseError when no robot holds the tool, or when it is a tool that does not turn, such as a gripper.
        """
        holder = self._held()
        if not turns(self.spec):
            instead = "; a gripper has `close` and `open`" if hears(self.spec, CLOSE) else ""
            raise MisuseError(f"tool {self.number} ({self.spec.kind}) does not turn{instead}")
        with as_misuse():
            holder.state = replace(holder.state, spindle=number(speed, "the speed of a spindle [rad/s]"))

    def apply_tcp_force(
        self, force: ArrayLike, torque: ArrayLike = (0.0, 0.0, 0.0), frame: Literal["world", "tool"] = "world"
    ) -> None:
        """Pull at the tip with a force (3,) [N] and torque (3,) [N·m] from the next step on, until another is given.

        In axes of the world, or of the tool, with which they turn. It comes to the `load` of the tool in the cell, and
        moves the arm as a force of the process does. MisuseError when no robot holds the tool.
        """
        holder = self._held()
        with as_misuse():
            push = np.concatenate([numbers(force, (3,), "a force [N]"), numbers(torque, (3,), "a torque [N·m]")])
        if frame not in LOAD_FRAMES:
            raise MisuseError(f"a force acts in axes of the `world` or of the `tool`; there is no `{frame}`")
        pushed: tuple[float, ...] = tuple(push.tolist()) if push.any() else ()
        holder.state = replace(holder.state, push=pushed, push_in_tool=bool(pushed) and frame == "tool")

    def extrude(self, path: ToolPath, frame: str = "G54") -> None:
        """Run a path with the process on all along; see `Arm.run`. MisuseError when the tool is no extruder."""
        holder = self._held()
        if "extrusion" not in self.spec.processes:
            raise MisuseError(f"tool {self.number} ({self.spec.kind}) does not extrude")
        self._cell._run_path(holder, path, frame, True)

    def _held(self) -> MovedMachine:
        """The machine that holds it; MisuseError when none does."""
        self._cell._check_open()
        holder = self._holder
        if holder is None:
            raise MisuseError(f"no robot holds tool {self.number}; call `couple` first")
        return holder
