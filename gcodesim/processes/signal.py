"""Signals: what the program tells a process while the tool moves, with one value for each step."""

from __future__ import annotations

from collections.abc import Container, Iterable
from dataclasses import replace
from math import inf, nan
from typing import TYPE_CHECKING, Final

from gcodesim.frozen import frozen
from gcodesim.processes import PROCESSES

if TYPE_CHECKING:
    from gcodesim.tools.tool import Tool


@frozen(kw_only=False)
class SetBy:
    """An action of a mapped M-code, such as `gripper: close`, and the value [SI] that it gives a signal."""

    target: str
    verb: str
    value: float


@frozen(kw_only=False)
class Signal:
    """A value that a word of the program sets and that holds until another word sets it; `unit` is SI.

    `default` holds where nothing in the program or in the cell gives the signal. `set_by` are the actions of M-codes
    that a process receives because it reads this signal; until the first of them comes, `default` holds. A word that
    sets it below `least` or above `most` is told. `with_moves`: a path brings it along, as it does its feed, so that a
    script need not set it.
    """

    name: str
    unit: str = ""
    default: float = 0.0
    set_by: tuple[SetBy, ...] = ()
    least: float = -inf
    most: float = inf
    with_moves: bool = False

    def is_set_by(self, actions: Container[tuple[str, str]]) -> bool:
        """Whether one of these actions, by target and verb, sets it."""
        return any((action.target, action.verb) in actions for action in self.set_by)


SPINDLE: Final = Signal("spindle", "rad/s", with_moves=True)
"""Speed of the spindle: S with M3 (positive) or M4 (negative), 0 while it stands."""

SURFACE_SPEED: Final = Signal("surface_speed", "m/s", with_moves=True)
"""Cutting speed under G96, 0 under G97; then `SPINDLE` is the greatest speed."""

PITCH: Final = Signal("pitch", "m", with_moves=True)
"""Travel in a turn of the spindle in moves that keep step with it, as in a thread; 0 in all others."""

ACTIVE: Final = Signal("active", set_by=(SetBy("tool", "activate", 1.0), SetBy("tool", "deactivate", 0.0)))
"""1 while the process of the tool is switched on, otherwise 0."""

SPRAY: Final = Signal("spray", default=nan, set_by=(SetBy("tool", "activate", 1.0), SetBy("tool", "deactivate", 0.0)))
"""1 while a spray gun is on; not a number where no word says so, and its flow alone tells."""

FLOW: Final = Signal("flow", "m^3/s", nan, least=0.0)
"""What leaves a gun while it is on; not a number where no word gives it, and it is the tool's own."""

BEAD_WIDTH: Final = Signal("bead_width", "m", with_moves=True)
BEAD_HEIGHT: Final = Signal("bead_height", "m", with_moves=True)
"""Size of the bead that the slicer's comments name; 0 where they do not."""

FEED: Final = Signal("feed", "m/s", with_moves=True)
"""Speed that the program asks for; infinite in rapids."""

BEAM: Final = Signal("beam", default=nan, set_by=(SetBy("tool", "activate", 1.0), SetBy("tool", "deactivate", 0.0)))
"""1 while a laser, jet or torch is on; not a number where no word says so, and its power alone tells."""

BEAM_POWER: Final = Signal("power", "W", default=nan, least=0.0)
"""Power of a beam; not a number where no word gives it, and it is the tool's own."""

ABRASIVE: Final = Signal("abrasive", default=1.0, least=0.0, most=1.0)
"""Share of the abrasive's full flow."""

GAS: Final = Signal("gas", default=1.0)
"""1 while gas flows; so it does where no word says anything of it."""

LASER_MODE: Final = Signal("laser_mode", with_moves=True)
"""Speed of S that means full power where the control drives a laser as grbl does with `$32=1`; 0 where it does not."""


def signals_read_by(tools: Iterable[Tool]) -> dict[str, Signal]:
    """The signals that the processes of these tools read, by name, with the actions of all readers."""
    found: dict[str, Signal] = {}
    for kind in dict.fromkeys(kind for tool in tools for kind in tool.acts_by):
        for signal in PROCESSES[kind].reads:
            known = found.setdefault(signal.name, signal)
            more = tuple(action for action in signal.set_by if action not in known.set_by)
            found[signal.name] = replace(known, set_by=known.set_by + more) if more else known
    return found


def actions_of_all() -> dict[str, tuple[str, ...]]:
    """All verbs by target that any process receives, those of third parties too."""
    found: dict[str, dict[str, None]] = {}
    for kind in PROCESSES:
        for signal in PROCESSES[kind].reads:
            for action in signal.set_by:
                found.setdefault(action.target, {})[action.verb] = None
    return {target: tuple(verbs) for target, verbs in found.items()}
