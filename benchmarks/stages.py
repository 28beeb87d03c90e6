"""Runs `gcodesim` with a stopwatch on its stages; CPU time of each, without what it calls in other stages.

    python -m benchmarks.stages OUT.json run PROGRAM --cell CELL ...

The stopwatch stands on whole windows and on what is done once, so it costs next to nothing.
"""

from __future__ import annotations

import functools
import importlib
import json
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

STAGES = {
    "read": ("gcodesim.rs274.run:Run.stream",),
    "plan": ("gcodesim.jobs.legs:plan_path",),
    "cell": (
        "gcodesim.cli.simulate:load_cell",
        "gcodesim.simulation.preparing:open_shop",
        "gcodesim.jobs.legs:with_stock",
    ),
    "sample + joints": ("gcodesim.executor.track:window_of",),
    "material + process": (
        "gcodesim.executor.coupling:Coupling.stretch",
        "gcodesim.executor.coupling:Stretch.__call__",
        "gcodesim.executor.coupling:Stretch.finish",
    ),
    "collision checks": (
        "gcodesim.checks.clearance:clearance_findings",
        "gcodesim.checks.machine_collisions:MachineChecks.findings",
        "gcodesim.checks.machine_collisions:MachineChecks.fixtures_beside",
        "gcodesim.checks.stock_watch:StockWatch.look",
        "gcodesim.checks.stock_watch:StockWatch.take",
    ),
    "world": ("gcodesim.world.kinematic:KinematicWorld.run", "gcodesim.world.bullet:BulletWorld.run"),
    "sums + findings": (
        "gcodesim.executor.track:record_of",
        "gcodesim.executor.totals:RowTotals.add",
        "gcodesim.jobs.inspection:Inspector.fresh",
        "gcodesim.jobs.inspection:Inspector.final",
    ),
    "log: columns": (
        "gcodesim.recorder.recorder:Recorder.__init__",
        "gcodesim.recorder.recorder:Recorder.start",
        "gcodesim.recorder.recorder:Recorder._write_down",
        "gcodesim.recorder.recorder:Recorder._write_instants",
    ),
    "log: stock": (
        "gcodesim.material.surface:Tiles.changed",
        "gcodesim.material.surface:Glimpse.draw",
        "gcodesim.recorder.recorder:Recorder._draw",
    ),
    "log: packing": ("gcodesim.log.container:pack",),
    "results + STL": (
        "gcodesim.simulation.one_run:results_of",
        "gcodesim.recorder.recorder:Recorder.finish",
    ),
}

LOG = tuple(stage for stage in STAGES if stage.startswith("log"))
"""What writing the log takes, drawing the stock included."""


class Stopwatch:
    """CPU time of every stage; a stage inside another one stops the outer one."""

    def __init__(self) -> None:
        self.spent: dict[str, float] = dict.fromkeys(STAGES, 0.0)
        self._local = threading.local()

    def _stack(self) -> list[Any]:
        if not hasattr(self._local, "stack"):
            self._local.stack = []
        stack: list[Any] = self._local.stack
        return stack

    def enter(self, stage: str) -> None:
        now, stack = time.thread_time(), self._stack()
        if stack:
            self.spent[stack[-1][0]] += now - stack[-1][1]
        stack.append([stage, now])

    def leave(self) -> None:
        now, stack = time.thread_time(), self._stack()
        stage, begin = stack.pop()
        self.spent[stage] += now - begin
        if stack:
            stack[-1][1] = now

    def around(self, stage: str, function: Callable[..., Any]) -> Callable[..., Any]:
        """`function` with its time booked to `stage`; a generator's too."""

        @functools.wraps(function)
        def timed(*given: Any, **named: Any) -> Any:
            self.enter(stage)
            try:
                answer = function(*given, **named)
            finally:
                self.leave()
            return self._each(stage, answer) if hasattr(answer, "send") else answer

        return timed

    def _each(self, stage: str, source: Any) -> Any:
        while True:
            self.enter(stage)
            try:
                value = next(source)
            except StopIteration:
                return
            finally:
                self.leave()
            yield value

    def watch(self, place: str, stage: str) -> None:
        """Put the watch on `module:name` or `module:Class.name`; what is not there raises."""
        module, _, name = place.partition(":")
        holder: Any = importlib.import_module(module)
        *classes, last = name.split(".")
        for part in classes:
            holder = getattr(holder, part)
        setattr(holder, last, self.around(stage, getattr(holder, last)))


def main() -> int:
    target = Path(sys.argv[1])
    watch = Stopwatch()
    from gcodesim.cli.main import main as command

    for stage, places in STAGES.items():
        for place in places:
            watch.watch(place, stage)
    start = time.process_time()
    code = command(sys.argv[2:])
    whole = time.process_time()
    stages = {"start + imports": start, **watch.spent}
    stages["rest"] = whole - sum(stages.values())
    target.write_text(json.dumps(stages))
    return int(code or 0)


if __name__ == "__main__":
    sys.exit(main())
