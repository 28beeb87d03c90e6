"""A run that waits between its legs: `simulation.run` in a thread, which goes on when the session has further ones."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from queue import SimpleQueue
from threading import Thread
from typing import TYPE_CHECKING

from gcodesim import simulation
from gcodesim.diagnostics import Severity
from gcodesim.jobs.leg_checks import LegChecks
from gcodesim.jobs.meetings import together
from gcodesim.planning.legs import followed_by
from gcodesim.shop import with_stock

if TYPE_CHECKING:
    from gcodesim.checks.stock_watch import StockWatch
    from gcodesim.executor import Progress
    from gcodesim.executor.halt import RunHalt
    from gcodesim.jobs.job import Job
    from gcodesim.jobs.results import Results
    from gcodesim.planning import Plan


class SessionLegs:
    """What the `legs` of a job of a session have to be; those of the first job say whether there are further ones."""

    ended = False

    def __init__(self, job: Job) -> None:
        assert job.shop is not None
        self._job = job
        self.checks = LegChecks(job.shop)

    def onward(self, halt: RunHalt | None = None) -> Plan | None:
        """The plan of all legs, the latest included, which the session has put into the job."""
        del halt
        return self._job.plan

    def stock_up(self) -> bool:
        """Load the stocks; False if a fault in one of them, which is reported, keeps the job from running."""
        assert self._job.shop is not None
        self._job.shop, problems = with_stock(self._job.shop)
        self._job.findings.extend(problems)
        return not any(problem.level >= Severity.ERROR for problem in problems)

    def stop(self) -> None:
        """Nothing is left to report."""

    def watch_stocks(self) -> StockWatch | None:
        """Who looks at what the machine does to stocks as they then are."""
        assert self._job.shop is not None
        return self.checks.watch(self._job, self._job.shop)

    def tell_of_untouched_stock(self) -> None:
        """A session does not probe."""


class RunThread(SessionLegs):
    """The run of `job` and those beside it. Only one of the two threads works at any time."""

    def __init__(self, job: Job, out: Path | None) -> None:
        super().__init__(job)
        for other in job.others:
            other.legs = SessionLegs(other)
        job.legs = self
        self._out = out
        self._further: SimpleQueue[bool] = SimpleQueue()
        self._reached: SimpleQueue[bool] = SimpleQueue()
        self._thread: Thread | None = None
        self._fault: BaseException | None = None
        self._working = self._interrupted = False
        self.results: Results | None = None

    # ---- for the session

    @property
    def has_failed(self) -> bool:
        """Whether the run ended by a fault, which was raised: it goes no further."""
        return self._fault is not None

    def advance(self, legs: Sequence[Plan]) -> None:
        """Run a leg of each machine, all equally long; returns when they are done. Raises what the run raises."""
        for job, leg in zip(self._job.all, legs, strict=True):
            job.plan = leg if job.plan is None else followed_by(job.plan, leg)
        if self._job.others:
            self._job.meetings = together(self._job.all)
        self._working = True
        if self._thread is None:
            self._thread = Thread(target=self._run, name="gcodesim session", daemon=True)
            self._thread.start()
        else:
            self._further.put(True)
        self._wait()

    def end(self, *, interrupted: bool = False) -> None:
        """There is no further leg: close log and results. An `interrupted` run stops at once, and they say so."""
        if self._thread is None or not self._thread.is_alive():
            return
        self._interrupted = interrupted
        if self._working:  # somebody interrupted `advance`
            self._wait()
        if self.results is None and self._thread.is_alive():
            self._further.put(False)
            self._wait()
        self._thread.join()

    def _wait(self) -> None:
        self._reached.get()
        self._working = False
        if self._fault is not None:
            raise self._fault

    def _run(self) -> None:
        try:
            self.results, _ = simulation.run(self._job, self._out, progress=self._go_on)
        except simulation.RunInterrupted as stopped:
            self.results = stopped.results
        except BaseException as fault:
            self._fault = None if self._interrupted else fault  # nothing had run yet that could be told
        self._reached.put(False)

    # ---- for the run

    def onward(self, halt: RunHalt | None = None) -> Plan | None:
        """Wait for a further leg; None: there is none."""
        self._reached.put(True)
        further = self._further.get()
        self._go_on()
        return self._job.plan if further else None

    def _go_on(self, _: Progress | None = None) -> None:
        """Between two windows: KeyboardInterrupt, as in a run of the command line, if the session was interrupted."""
        if self._interrupted:
            raise KeyboardInterrupt
