"""What a signal is set to by an event of the program."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from gcodesim.canon import Action, Event, Output, Spindle
from gcodesim.cell.signals import SignalSource
from gcodesim.processes.signal import Signal
from gcodesim.units import RPM


def value_after(event: Event, signal: Signal, sources: Mapping[str, SignalSource]) -> float | None:
    """What an event sets a signal to, with the words of the cell as `sources`; None if it leaves it alone."""
    if not isinstance(event, (Action, Output, Spindle)):
        return None
    source = sources.get(signal.name)
    return value_of_action(event, signal) if source is None else number_after(event, source)


SIGNAL: Final = "signal"
"""Target of the action by which a script sets a signal, which is its verb, to its Q; without Q to the default."""


def value_of_action(event: Event, signal: Signal) -> float | None:
    """What an event of a mapped M-code, or of a script, sets a signal to that no word gives; None: nothing."""
    if not isinstance(event, Action):
        return None
    if (event.target, event.verb) == (SIGNAL, signal.name):
        return signal.default if event.q is None else event.q
    return next((a.value for a in signal.set_by if (a.target, a.verb) == (event.target, event.verb)), None)


def number_after(event: Event, source: SignalSource) -> float | None:
    """What an event sets a signal to that a word of the cell gives; None: nothing."""
    if source.word.type in ("speed", "turning"):
        if not isinstance(event, Spindle):
            return None
        turns = event.direction != "off" and event.speed != 0.0
        number: float | None = (event.speed / RPM if source.word.type == "speed" else 1.0) if turns else 0.0
    else:
        number = source.word.number_of(event)
    return None if number is None else source.factor * number + source.zero
