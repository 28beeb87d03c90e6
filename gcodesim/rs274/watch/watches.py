"""All rules together, as called by the executor."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

from gcodesim import canon
from gcodesim.diagnostics import Diagnostic
from gcodesim.rs274.watch.compensation import CompensationLeftOn, RapidInCompensation
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

    def moves(self, batch: MoveBatch) -> None:
        """A run of plain moves."""
        for rule in self._seeing:
            rule.moves(batch)

    def findings(self, *, finished: bool) -> Iterator[Diagnostic]:
        for rule in self._rules:
            yield from rule.findings(finished=finished)
