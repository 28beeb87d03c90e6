"""The way to a place in the middle of a program: clear of the part, across, and near by rapids; the rest at a feed.

Mills come from above. On a lathe the tool comes the way by which it has left the part before: from outside, from in
front of a face, or, in a bore, along the axis and then outward. What lies on that way has been cut by then.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim import canon
from gcodesim.canon import AXIS_LETTERS, Event
from gcodesim.frames import Array
from gcodesim.motion.tool_path import RAPID, ToolPath
from gcodesim.rs274.entry.preamble import Approach, RapidEnd
from gcodesim.rs274.marlin.preamble import PrintApproach
from gcodesim.tools.lathe_tool import NOSE_CENTRES

if TYPE_CHECKING:
    from gcodesim.rs274.control import Control

_X, _Z = 0, 2
_XZ: Final = 180
_LIFT: Final = 2e-3
"""[m] Over all places where the head has been: what sticks out of a layer stays clear of the nozzle."""
_SLOW: Final = 0.02  # [m/s]
_SAME: Final = 1e-7
"""[m] What moves less does not move."""


def approach_of(control: Control, path: ToolPath, events: Sequence[Event]) -> Approach:
    """How to come to where `control` is, after the moves of `path` and the other `events` of the lines before."""
    fed = path.feed[(path.kind != RAPID) & np.isfinite(path.feed) & ~path.rotary_feed]
    outputs = {
        f"{'P' if event.type == 'digital' else 'E'}{event.index}": event.value
        for event in events
        if isinstance(event, canon.Output)
    }
    turns = _turns(control, path)
    stops, last = _way(control, path, turns) if len(path) else ([], "z")
    return Approach(
        turns=turns,
        stops=stops,
        last=last,
        feed=float(fed[-1]) if len(fed) else 0.0,
        changed=any(isinstance(event, canon.ToolChange) for event in events),
        outputs=outputs,
    )


def print_approach(path: ToolPath) -> PrintApproach:
    """How the head comes to the end of the moves of `path`: above all that was laid, with the filament drawn back."""
    if not len(path):
        return PrintApproach(moves=False)
    empty = (path.extrude == 0.0) & np.isfinite(path.feed)
    alone = [(event.row, _drawn(event.event)) for event in path.events]
    deltas = np.insert(path.extrude, [row for row, _ in alone], [length for _, length in alone])
    pushed = np.cumsum(deltas)
    return PrintApproach(
        moves=True,
        high=float(path.end[:, _Z].max()) + _LIFT,
        travel=float(path.feed[empty if empty.any() else np.isfinite(path.feed)].max(initial=_SLOW)),
        drawn=float(max(pushed.max(initial=0.0) - pushed[-1], 0.0)),
    )


def _drawn(event: Event) -> float:
    """Filament [m] that an E word moves alone."""
    return event.length if isinstance(event, canon.Extrude) and not event.by_firmware else 0.0


def _turns(control: Control, path: ToolPath) -> bool:
    """Whether the machine is a lathe; where nobody says, one that keeps to the plane of X and Z."""
    known = control.settings.turns or control.dialect.turret or control.state.diameter
    return known or (not control.settings.has_cell and control.state.plane == _XZ and not _moves(path)[1])


def _way(control: Control, path: ToolPath, turns: bool) -> tuple[list[RapidEnd], str]:
    """The rapids, and the axis on which the place is reached."""
    tools = np.array([state.tool for state in path.states])[path.state]
    own = tools == control.state.tool
    if not turns:
        return _from(_Z, 1.0, f"xy{_turned(control, path)}", path, own), "z"
    side = -1.0 if path.end[own, _X].max(initial=-np.inf) < 0.0 else 1.0
    others = f"{'y' if _moves(path)[1] else ''}{_turned(control, path)}"
    match _side(control, path, own, side):
        case "bore":
            return _into_bore(path, own, side, others), "x"
        case "face":
            return _from(_Z, 1.0, f"x{others}", path, own), "z"
        case _:
            return _from(_X, side, f"{others}z", path, own), "x"


def _from(axis: int, side: float, across: str, path: ToolPath, own: NDArray[np.bool_]) -> list[RapidEnd]:
    """Out along `axis` as far as the farthest rapid, across, and in to the nearest end of a rapid beyond the place."""
    rapid, letter = path.kind == RAPID, "xyz"[axis]
    here = side * float(path.end[-1, axis])
    far = max([here, *(side * path.start[rapid, axis]), *(side * path.end[rapid, axis])])
    ends = side * path.end[rapid & own, axis]
    least = here if rapid[-1] else here + _SAME  # a rapid beside the part is none in the cut
    near = float(ends[ends >= least].min(initial=far))
    stops = [RapidEnd(axes=letter, at=side * far), RapidEnd(axes=across)]
    return [*stops, RapidEnd(axes=letter, at=side * near)] if near < far else stops


def _into_bore(path: ToolPath, own: NDArray[np.bool_], side: float, others: str) -> list[RapidEnd]:
    """In front of the part, to the X nearest to the wall at which the tool has gone by rapids, in, then outward."""
    rapid = path.kind == RAPID
    front = max(float(path.end[-1, _Z]), *path.start[rapid, _Z], *path.end[rapid, _Z])
    here = side * float(path.end[-1, _X])
    ends = side * path.end[rapid & own, _X]
    inside = float(ends[ends <= here + _SAME].max(initial=min(0.0, here)))
    across = [RapidEnd(axes=others)] if others else []
    return [RapidEnd(axes="z", at=front), *across, RapidEnd(axes="x", at=side * inside), RapidEnd(axes="z")]


def _side(control: Control, path: ToolPath, own: NDArray[np.bool_], side: float) -> str:
    """From where the tool cuts: "outside", "face" or "bore"; by its nose, else as it last left or came to the part."""
    feeds = own & (path.kind != RAPID)
    if feeds.any() and np.abs(path.end[feeds, _X]).max() < _SAME and np.abs(path.start[feeds, _X]).max() < _SAME:
        return "face"  # a drill
    centre = NOSE_CENTRES.get(control.spindle_tool.orientation, (0, 0))
    if any(centre):
        return "outside" if side * centre[1] > 0 else "bore" if side * centre[1] < 0 else "face"
    leaving = np.flatnonzero(own[1:] & own[:-1] & (path.kind[1:] == RAPID) & (path.kind[:-1] != RAPID)) + 1
    if not len(leaving):
        return "outside"
    way = path.end[leaving[-1]] - path.start[leaving[-1]]
    if abs(way[_X]) < _SAME:
        return "face"
    return "outside" if side * way[_X] > 0.0 else "bore"


def _moves(path: ToolPath) -> Array:
    """Which of the six axes the path moves (6,)."""
    moved: Array = (path.start != path.end).any(axis=0)
    return moved


def _turned(control: Control, path: ToolPath) -> str:
    """The letters of the rotary and further axes that it moves."""
    columns = {column: letter for letter, column in control.settings.columns.items()}
    moved = _moves(path)[3:]
    return "".join(columns.get(i, AXIS_LETTERS[3 + i].lower()) for i in range(3) if moved[i])
