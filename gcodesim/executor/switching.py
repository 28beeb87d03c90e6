"""Signals by the time at which the program sets them, for processes that act while the machine stands."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gcodesim.arithmetic.matrices import multiplied
from gcodesim.cell.signal_values import value_after
from gcodesim.frames import Array
from gcodesim.processes.signal import Signal
from gcodesim.shop import Shop

if TYPE_CHECKING:
    from gcodesim.planning import Plan


class Switching:
    """What a plan sets, and when. A row of a path begins after all that stands before it; here that has an order."""

    def __init__(self, plan: Plan, shop: Shop) -> None:
        self._plan, self._shop = plan, shop
        self._changes: dict[str, tuple[Array, Array]] = {}

    def changes(self, signal: Signal) -> tuple[Array, Array]:
        """Times (c,) [s] at which a signal is set, and its values (c + 1,), the first from the start on."""
        if signal.name not in self._changes:
            source = self._shop.signal_sources.get(signal.name)
            value = signal.default if source is None else source.zero
            times, values = [], [value]
            for timed in self._plan.trajectory.events:
                new = value_after(timed.event, signal, self._shop.signal_sources)
                if new is not None:
                    times.append(timed.time)
                    values.append(new)
            self._changes[signal.name] = np.array(times), np.array(values)
        return self._changes[signal.name]

    def is_set(self, signal: Signal) -> bool:
        """Whether the program sets a signal anywhere."""
        return len(self.changes(signal)[0]) > 0

    def at(self, signal: Signal, time: Array) -> Array:
        """The values (n,) of a signal at times (n,) [s]."""
        times, values = self.changes(signal)
        found: Array = values[np.searchsorted(times, time, side="right")]
        return found

    def tip_at_change(self, signal: Signal, time: float) -> Array:
        """X_WT (4, 4) of the commanded tip when a signal was set last before `time` [s], or at the start."""
        times, _ = self.changes(signal)
        last = int(np.searchsorted(times, time, side="right")) - 1
        plan = self._plan
        samples = plan.trajectory.sample(np.array([times[last] if last >= 0 else 0.0]))
        row = np.clip(samples.row, 0, max(len(plan.path) - 1, 0))
        X: Array = multiplied(self._shop.X_WB.matrix, plan.tip(plan.joints(samples), row)[0])
        return X
