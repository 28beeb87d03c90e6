"""When each program line ran, and what happened at which moment."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gcodesim.frozen import frozen

Ints = NDArray[np.int64]


@frozen
class BlockState:
    """What many blocks have in common; feed [m/s], spindle [rad/s, + = M3]."""

    file: str
    motion: str
    tool: int
    tool_name: str
    wcs: str
    feed: float
    spindle: float
    state: str


@frozen(eq=False)
class Timeline:
    """m blocks in the order in which they ran: begin `t_ns` (m,), `line` (m,), `text` (m), `modal` (m,) of `modals`.

    A block whose state changes while it runs (a tool change, the end) is listed
    once for each state, with the same number in `block` (m,).
    """

    t_ns: Ints
    line: Ints
    block: Ints
    text: tuple[str, ...]
    modal: Ints
    modals: tuple[BlockState, ...]

    @staticmethod
    def of(messages: Iterable[tuple[int, Any]]) -> Timeline:
        """From time [ns] and message of `/program`, in order."""
        known: dict[BlockState, int] = {}
        t_ns, line, block, text, modal = [], [], [], [], []
        for time, m in messages:
            state = BlockState(
                file=m.file,
                motion=m.motion,
                tool=m.tool,
                tool_name=m.tool_name,
                wcs=m.wcs,
                feed=m.feed_m_s,
                spindle=m.spindle_rad_s,
                state=m.state,
            )
            t_ns.append(time)
            line.append(m.line)
            block.append(m.block)
            text.append(m.text)
            modal.append(known.setdefault(state, len(known)))
        return Timeline(
            t_ns=np.array(t_ns, dtype=np.int64),
            line=np.array(line, dtype=np.int64),
            block=np.array(block, dtype=np.int64),
            text=tuple(text),
            modal=np.array(modal, dtype=np.int64),
            modals=tuple(known),
        )

    def __len__(self) -> int:
        return len(self.t_ns)

    def at(self, t_ns: Ints) -> Ints:
        """The block (n,) that runs at each time; −1 before the first."""
        index: Ints = np.searchsorted(self.t_ns, t_ns, side="right") - 1
        return index

    def files(self) -> tuple[str, ...]:
        """Names of the program files that ran, in the order in which they first did."""
        return tuple(dict.fromkeys(self.modals[i].file for i in self.modal if self.modals[i].file))

    def span_of_lines(self, first: int, last: int, end_ns: int, file: str | None = None) -> tuple[int, int] | None:
        """Start of the first and end of the last block [ns] of the lines first ≤ line ≤ last; None when none ran."""
        files = np.array([modal.file for modal in self.modals])
        inside = (self.line >= first) & (self.line <= last)
        if len(files):
            inside &= files[self.modal] == (file or next(iter(self.files()), ""))
        chosen = np.flatnonzero(inside)
        if not len(chosen):
            return None
        after = int(chosen[-1]) + 1
        return int(self.t_ns[chosen[0]]), int(self.t_ns[after]) if after < len(self) else end_ns
