"""All rules together, as called by the executor."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

from gcodesim import canon
from gcodesim.diagnostics import Diagnostic
from gcodesim.rs274.watch.compensation import CompensationLeftOn, RapidInCompensation
from gcodesim.rs274.watch.doubt import Doubt
from gcodesim.rs274.watch.offsets import OffsetsLeftOn
from gcodesim.rs274.watch.speed import SpindleWithoutSpeed
from gcodesim.rs274.watch.spindle import FeedWithoutSpindle, SpindleLeftOn
from gcodesim.rs274.watch.tool_length import LengthOfAnotherTool, MoveWithoutLength
from gcodesim.rs274.watch.units import UnitChange
from gcodesim.rs274.watch.watch import Watch
from gcodesim.rs274.words import Words

if TYPE_CHECKING:
    from gcodesim.canon.batch import MoveBatch
    from gcodesim.rs274.control import Control

RULES: tuple[type[Watch], ...] = (
    FeedWithoutSpindle,
    SpindleLeftOn,
    SpindleWithoutSpeed,
    LengthOfAnotherTool,
    MoveWithoutLength,
    RapidInCompensation,
    CompensationLeftOn,
    OffsetsLeftOn,
    UnitChange,
)


_SPINDLE = Doubt(spindle=True, any_code=False, letters=frozenset(), codes=frozenset(), unit=0.0)


class Watches:
    """The rules of one run."""

    def __init__(self, rules: tuple[type[Watch], ...] = RULES) -> None:
        self._rules = [rule() for rule in rules]
        self._seeing = [rule for rule in self._rules if type(rule).event is not Watch.event]

    def block(self, words: Words, control: Control) -> None:
        """A block that is no plain move was executed; its events are in `control.out`."""
        for rule in self._rules:
            rule.block(words, control)
        self.events(control.out)
        for rule in self._rules:
            rule.settled(words, control)

    def events(self, events: Iterable[canon.Event]) -> None:
        """Events of a plain move, or of no block at all."""
        for event in events:
            for rule in self._seeing:
                rule.event(event)

    def block_in_doubt(self, words: Words, control: Control, *, place: bool, spindle: bool) -> None:
        """`block` after a fault, where the place of the tool or the spindle may be unknown."""
        for rule in self._rules:
            rule.block(words, control)
        self.events_in_doubt(control.out, place=place, spindle=spindle)
        for rule in self._rules:
            rule.settled(words, control)

    def events_in_doubt(self, events: Iterable[canon.Event], *, place: bool, spindle: bool) -> None:
        """`events` after a fault, where the place of the tool or the spindle may be unknown."""
        for event in events:
            if spindle and isinstance(event, canon.Spindle):
                self.doubt(_SPINDLE)
                continue
            for rule in self._seeing:
                if place and isinstance(event, canon.Move):
                    rule.somewhere(event)
                else:
                    rule.event(event)

    def doubt(self, doubt: Doubt) -> None:
        """A line could not be executed."""
        for rule in self._rules:
            rule.doubt(doubt)

    def moves(self, batch: MoveBatch) -> None:
        """A run of plain moves."""
        if batch.speed is not None:  # rules about the spindle need to know which moves an S stands between
            self.events(batch.events())
            return
        for rule in self._seeing:
            rule.moves(batch)

    def findings(self, *, finished: bool) -> Iterator[Diagnostic]:
        for rule in self._rules:
            yield from rule.findings(finished=finished)
