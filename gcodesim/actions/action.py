"""What an action is, and what it is told."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

from gcodesim.frames import Array
from gcodesim.frozen import frozen


class Wrong(str):
    """A sentence about something that is wrong; an action returns it in place of a remark."""

    __slots__ = ()


@frozen(eq=False)
class Moment:
    """The cell when the M-code comes.

    `time` [s], `line` of the program, the number `m` of the code with its words P and Q (None: not written), the number
    of the `tool`, `joints` by name [m, rad] and `X_WT` (4, 4), the tip in the world, as they really are; `values` by
    name are the columns of the processes in that step [SI].
    """

    time: float
    line: int
    m: int
    p: float | None
    q: float | None
    tool: int
    joints: Mapping[str, float]
    X_WT: Array
    values: Mapping[str, float]


class WordAction:
    """The base of all actions. There is one object a run and channel, so an action may remember what it has seen.

    `act` looks at the cell and changes nothing in it, so the motion is that of a run without it.
    """

    kind: ClassVar[str] = ""

    def act(self, moment: Moment) -> str | None:
        """What is to be told at the line of the M-code: a remark (GS580), something `Wrong` (GS581), or nothing."""
        raise NotImplementedError
