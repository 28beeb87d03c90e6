"""How tip and axes of a cell's machine belong together, for the program reader."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from gcodesim import canon
from gcodesim.arithmetic.matrices import applied
from gcodesim.cell.machine import MachineTool
from gcodesim.cell.robot import Robot
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.kinematics.tool_point import ToolPoint


@frozen(slots=False, kw_only=False, eq=False)
class MachinePoint:
    """`rs274.tool_point.ToolPointLaw` of a machine tool."""

    tool: ToolPoint

    @staticmethod
    def of(machine: MachineTool | Robot) -> MachinePoint | None:
        """None where no rotary axis has a place, or X, Y, Z are not all there."""
        axes = getattr(machine, "axes", ())  # an arm has joints instead
        if not any(axis.rotary and axis.at is not None for axis in axes):
            return None
        from gcodesim.kinematics import kinematics_of

        tool = ToolPoint.of(kinematics_of(machine.chain))
        return None if tool is None else MachinePoint(tool)

    @property
    def letters(self) -> tuple[str, ...]:
        return self.tool.letters

    @property
    def in_system(self) -> bool:
        return False

    def axes(self, tip: canon.Axes, offset: canon.Axes) -> canon.Axes:
        return self._axes(self.tool.joints(np.array([tip]) + _turns(offset), np.array([offset[:3]]))[0], tip)

    def tip(self, axes: canon.Axes, offset: canon.Axes) -> canon.Axes:
        q = np.array([axes])[:, self.tool.columns]
        x, y, z = self.tool.tips(q, np.array([offset[:3]]))[0].tolist()
        a, b, c = (np.array(axes[3:]) - np.array(offset[3:])).tolist()
        return (x, y, z, a, b, c)

    def attitudes(self, direction: canon.Point, axes: canon.Axes) -> list[canon.Axes]:
        near = np.array(axes)[self.tool.columns]
        ways = self.tool.attitudes(np.array(direction), near)
        within = [self.tool.within_travel(way, near) for way in ways]
        return [self._axes(way, axes) for way in within if way is not None]

    def words_of(self, directions: Array) -> Array | None:
        return None  # the nearer of two ways

    def carried(self, vector: canon.Point, before: canon.Axes, now: canon.Axes) -> canon.Point | None:
        path = self.tool.kinematics.chain.tree.path
        if path[self.tool.rotary].all():  # all of them turn the tool
            return None
        q = np.array([before, now])[:, self.tool.columns]
        R = self.tool.kinematics.table(q)[:, :3, :3]
        x, y, z = applied(R[1], applied(R[0].T, np.array(vector))).tolist()
        return (x, y, z)

    def _axes(self, q: Array, rest: canon.Axes) -> canon.Axes:
        """Axes x to c with joints at `q` (j,); those that the machine does not have as in `rest`."""
        out = list(rest)
        for column, value in zip(self._columns, q.tolist(), strict=True):
            out[column] = value
        x, y, z, a, b, c = out
        return (x, y, z, a, b, c)

    @cached_property
    def _columns(self) -> list[int]:
        return [int(column) for column in self.tool.columns]


def _turns(offset: canon.Axes) -> Array:
    """Only A, B and C of a length offset."""
    return np.array([0.0, 0.0, 0.0, *offset[3:]])
