"""Who looks at every window of a run: the log, and whoever reads sensors or draws."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from gcodesim.diagnostics import Diagnostic
    from gcodesim.executor.record import StepRecord
    from gcodesim.executor.window import StepWindow
    from gcodesim.planning import Plan
    from gcodesim.world import WorldSteps


class Watcher(Protocol):
    """Who wants to see every window: the log."""

    def start(self, world_steps: WorldSteps, window: StepWindow) -> None:
        """The state before the first step, as a window of one step that does not move."""

    def look(self, window: StepWindow) -> Any:
        """Look at the stocks as `window` leaves them; in the thread that cuts, before the next window is cut.

        The result is handed to `take`, unless the cut is undone; then `look` is called again.
        """

    def take(self, record: StepRecord, found: Sequence[Diagnostic], seen: Any) -> Callable[[], None]:
        """The next window, the findings that came up in it, and what `look` saw at its end.

        Returns work that needs nothing else; it is done in order, in another thread, while the next window runs.
        """

    def follow(self, plan: Plan) -> None:
        """The run goes on with a leg; `plan` is that of all legs so far. Done in order with the work from `take`."""

    @property
    def interval_steps(self) -> int:
        """The number of steps after which the watcher wants to look at the stock."""

    def stops(self, plans: Sequence[Plan], first: int, last: int) -> Sequence[int]:
        """Steps, first < step < last, with which a window has to end, because something is to be seen there.

        `plans` are those of all channels; the steps from `first` to `last` are about to be run.
        """
