"""One rule that watches while a program runs."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

from gcodesim import canon
from gcodesim.diagnostics import Diagnostic, Span
from gcodesim.rs274.words import Words, place_of

if TYPE_CHECKING:
    from gcodesim.canon.batch import MoveBatch
    from gcodesim.rs274.control import Control
    from gcodesim.rs274.watch.doubt import Doubt

FEEDS = (canon.LinearFeed, canon.ArcFeed, canon.SplineFeed)
TINY = 1e-6  # [m], below what any machinist would call a move


class Watch:
    """A rule. It sees each block that is more than a plain move, each event, and at the end says what it found.

    After a line with an error it sees what is certain of the others, so that nothing is told that is only a
    consequence: `doubt` says what may not be as it seems, and a rule forgets what it knew of that.
    """

    def block(self, words: Words, control: Control) -> None:
        """A block was executed that is no plain move; its events come next."""

    def event(self, event: canon.Event) -> None:
        """An event of any block."""

    def settled(self, words: Words, control: Control) -> None:
        """The events of that block have been seen."""

    def doubt(self, doubt: Doubt) -> None:
        """A line could not be executed; what it would have done is carried over as far as it can be read."""

    def somewhere(self, event: canon.Move) -> None:
        """A move of which only is certain that it is made, not from where to where."""

    def moves(self, batch: MoveBatch) -> None:
        """A run of plain moves at once, in place of their events; a rule that looks at moves looks at them here too."""

    def singly_until(self, batch: MoveBatch, ready: Callable[[], bool]) -> MoveBatch:
        """The first moves as events, until the rule can take the others as columns; returns those."""
        done = 0
        events = batch.events()
        while done < len(batch) and not ready():
            event = next(events)
            self.event(event)
            done += isinstance(event, canon.Move)
        return batch.after(done)

    def findings(self, *, finished: bool) -> Iterable[Diagnostic]:
        """What was found; `finished` when the program came to its end, and nobody doubts what it did on the way."""
        return ()


def word_span(words: Words, at: str, control: Control) -> Span:
    """The place of a word (`h`) or code (`g43`) of the block at hand; the block when it is not written as such."""
    place = place_of(words.block, at)
    if place is None:
        return control.span
    span = control.span
    return Span(span.file, span.line, place[0] + 1, span.line, place[1] + 1, span.callers)
