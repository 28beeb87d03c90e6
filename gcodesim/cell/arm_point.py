"""How the words of a program lean the tool of an arm, and how tip and words belong together, for the program reader."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from gcodesim import canon
from gcodesim.canon.systems import name_of_system
from gcodesim.cell.externals import columns_of
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.kinematics.attitude import AttitudeLaw, Direction, WordTurns

if TYPE_CHECKING:
    from gcodesim.cell.cell import Cell
    from gcodesim.cell.placement import Placement

_UPRIGHT: Final = 1e-9


def attitude_of(cell: Cell, channel: str, placement: Placement) -> AttitudeLaw | None:
    """What words a, b, c of an arm's program mean to its tool; None where they mean nothing.

    Without `words` the tool may be commanded by its direction, if it stands upright on the work systems else.
    """
    own = cell.channels[channel].orientation
    if own is not None and own.words is not None:
        return WordTurns(turns=own.words)
    if columns_of(cell.robots[str(cell.channels[channel].robot)].externals):
        return None  # its words belong to external axes
    if own is not None and own.tool_axis.surface is not None and not placement.leaning:
        return Direction()
    down = -placement.X_WM.R[:, 2]
    for system in placement.given or (1,):
        if np.abs(placement.tool_axis(own, system) - down).max() > _UPRIGHT:
            return None
    return Direction()


@frozen(eq=False)
class ArmPoint:
    """`rs274.tool_point.ToolPointLaw` of an arm: its tip is where the program says, whatever the tool's attitude.

    So to the control the axes stand above the tip by the length offset. `letters` turn the tool; `upright` says whether
    it stands along Z of the work system while they are zero.
    """

    law: AttitudeLaw | None
    letters: tuple[str, ...]
    upright: bool = True

    @staticmethod
    def of(cell: Cell, channel: str, placement: Placement) -> ArmPoint | None:
        """None where neither words nor a vector lean the tool."""
        law = attitude_of(cell, channel, placement)
        words = ["ABC"[turn.word] for turn in law.turns] if isinstance(law, WordTurns) else []
        words += columns_of(cell.robots[str(cell.channels[channel].robot)].externals)
        if law is None and not words:
            return None
        return ArmPoint(law=law, letters=tuple(sorted(words)), upright=_stands_upright(cell, channel, placement))

    @property
    def in_system(self) -> bool:
        """Words turn the tool about axes of the work system, wherever that leans."""
        return isinstance(self.law, WordTurns)

    def axes(self, tip: canon.Axes, offset: canon.Axes) -> canon.Axes:
        x, y, z, a, b, c = (t + o for t, o in zip(tip, offset, strict=True))
        return (x, y, z, a, b, c)

    def tip(self, axes: canon.Axes, offset: canon.Axes) -> canon.Axes:
        x, y, z, a, b, c = (t - o for t, o in zip(axes, offset, strict=True))
        return (x, y, z, a, b, c)

    def carried(self, vector: canon.Point, before: canon.Axes, now: canon.Axes) -> canon.Point | None:
        return None  # what a positioner carries goes along with it anyway

    def words_of(self, directions: Array) -> Array | None:
        return Direction.values(directions) if isinstance(self.law, Direction) else None

    def attitudes(self, direction: canon.Point, axes: canon.Axes) -> list[canon.Axes]:
        if isinstance(self.law, Direction):
            ways = [Direction.values(np.array(direction))]
        elif isinstance(self.law, WordTurns) and self.upright:
            ways = self.law.towards(np.array(direction), np.array(axes[3:]))
        else:
            ways = []
        return [(*axes[:3], *map(float, way)) for way in ways]  # type: ignore[misc]


def _stands_upright(cell: Cell, channel: str, placement: Placement) -> bool:
    """Whether the tool points along -Z of every work system while no word leans it."""
    own = cell.channels[channel].orientation
    return all(
        np.abs(placement.tool_axis(own, system) + placement.X_W(name_of_system(system)).R[:, 2]).max() <= _UPRIGHT
        for system in placement.given or (1,)
    )
