"""`gcodesim run --gui`: the run in pybullet's window, and a line for each body that is clicked at."""

from __future__ import annotations

import ctypes
import os
import sys
import time
from typing import TYPE_CHECKING, Final

from gcodesim.cli.output import note
from gcodesim.diagnostics.plain import PlainStream
from gcodesim.observation.spectator import Spectator
from gcodesim.world.window import BodyWindow

if TYPE_CHECKING:
    from gcodesim.executor.watcher import Watcher
    from gcodesim.jobs.job import Job

_PAUSE: Final = 0.03  # [s] between two looks at the mouse


class ShownRun:
    """A window and the run that it shows."""

    def __init__(self) -> None:
        """Open the window. `WorldUnavailable` where there is no screen, or no pybullet."""
        self._aside = _Aside()
        try:
            self._window = BodyWindow()
        except BaseException:
            self._aside.end()
            raise
        self._spectator: Spectator | None = None

    def __call__(self, job: Job, inner: Watcher | None) -> Watcher:
        """The watcher that shows the first channel of a job."""
        assert job.shop is not None and job.cell is not None and job.plan is not None
        self._spectator = Spectator(job.shop, job.cell.simulation.step_ns, self._window, inner, note)
        self._spectator.draw_path(job.plan)
        return self._spectator

    def stay(self) -> None:
        """Answer clicks until somebody closes the window."""
        while self._window.is_open and self._spectator is not None:
            self._spectator.answer()
            time.sleep(_PAUSE)

    def close(self) -> None:
        self._window.close()
        self._aside.end()


class _Aside:
    """What pybullet prints about its threads and the graphics card goes to stderr, since stdout is for data."""

    def __init__(self) -> None:
        sys.stdout.flush()
        self._before, self._kept = sys.stdout, os.dup(1)
        os.dup2(2, 1)
        own = open(os.dup(self._kept), "w", encoding="utf-8", errors="replace")  # noqa: SIM115  (closed by `end`)
        sys.stdout = PlainStream(own)

    def end(self) -> None:
        """Back to before."""
        sys.stdout.flush()
        sys.stdout = self._before
        ctypes.CDLL(None).fflush(None)  # what C has not written yet
        os.dup2(self._kept, 1)
        os.close(self._kept)
