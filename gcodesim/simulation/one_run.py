"""A planned job while it runs with its stock: who watches, what follows, and what is concluded at its end."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING

from gcodesim.diagnostics import Diagnostic
from gcodesim.executor import execute_together
from gcodesim.jobs.coating import film_findings
from gcodesim.jobs.collisions import collisions
from gcodesim.jobs.job import Job
from gcodesim.jobs.outcome import results_of
from gcodesim.jobs.pace import pacing_of
from gcodesim.simulation.channel_run import ChannelRun

if TYPE_CHECKING:
    from gcodesim.executor import Execution, Progress
    from gcodesim.executor.halt import RunHalt
    from gcodesim.executor.watcher import Watcher
    from gcodesim.jobs.results import Results
    from gcodesim.log.live import LiveView
    from gcodesim.observation.eyes import Eyes
    from gcodesim.planning import Plan
    from gcodesim.recorder import Recorder
    from gcodesim.simulation.run_folder import RunFolder

    Show = Callable[[Job, Watcher | None], Watcher]
    """Puts a watcher that shows the run before the one that there is."""


class OneRun:
    """One run of a job whose programs are planned and whose stocks stand; used once, as a context manager.

    What an earlier run left in `folder` is deleted. A log that was begun is closed on the way out, whatever happens.
    """

    def __init__(self, job: Job, folder: RunFolder | None, live: LiveView | None) -> None:
        self.job, self.folder, self.only = job, folder, job.options.only
        self.channels = [ChannelRun(each) for each in job.all]
        self.recorder: Recorder | None = None
        self.eyes: Eyes | None = None
        if folder is not None:
            folder.forget()
        if folder is not None and self.only in (None, "motion"):
            from gcodesim.recorder import Recorder

            self.recorder = Recorder(job, folder.path, live)

    def __enter__(self) -> OneRun:
        return self

    def __exit__(self, *raised: object) -> None:
        if self.recorder is not None:
            self.recorder.abandon()

    def execute(self, progress: Callable[[Progress], None] | None, show: Show | None) -> Execution:
        """All steps, until the programs end, fail or are interrupted."""
        tracks = [one.track_plan(each) for one, each in zip(self.channels, self._watchers(show), strict=True)]
        pacing = pacing_of(self.job)
        execution = execute_together(
            tracks, world_name=self.job.world, pacing=pacing, progress=progress, onward=self._onward
        )
        if execution.interrupted:
            assert self.job.legs is not None
            self.job.legs.stop()
        return execution

    def _watchers(self, show: Show | None) -> list[Watcher | None]:
        """Who watches each channel."""
        watchers: list[Watcher | None] = [None for _ in self.channels]
        if self.recorder is not None:
            watchers = [self.recorder, *self.recorder.others]
        self.eyes = self._eyes()
        if self.eyes is not None:
            watchers[0] = self.eyes
        if show is not None:
            watchers[0] = show(self.job, watchers[0])
        return watchers

    def _eyes(self) -> Eyes | None:
        """What reads the sensors of the cell, and lets the log watch as well; None without sensors."""
        from gcodesim.observation.schedule import stations_of

        cell = self.job.cell
        assert self.job.shop is not None and cell is not None
        if not stations_of(cell):
            return None
        from gcodesim.observation.eyes import Eyes
        from gcodesim.observation.files import SensorFiles

        return Eyes(
            self.job.shop,
            cell.simulation.step_ns,
            cell.simulation.seed,
            inner=self.recorder,
            outlet=None if self.recorder is None else self.recorder.sensed,
            files=None if self.folder is None else SensorFiles(self.folder.path),
        )

    def _onward(self, halt: RunHalt) -> Sequence[Plan] | None:
        """The next legs, if there are any; whoever watches the run gets to know it."""
        job = self.job
        assert job.legs is not None
        known = set(job.findings)
        plan = job.legs.onward(halt)
        if self.recorder is not None:
            self.recorder.expect(job.shown(finding for finding in job.findings if finding not in known))
        if plan is None:
            return None
        plans = [plan]
        for other in job.others:
            assert other.legs is not None
            its = other.legs.onward()
            assert its is not None
            plans.append(its)
        for channel, each in zip(self.channels, plans, strict=True):
            channel.follow(each)
        return plans

    def conclude(self, execution: Execution) -> Results:
        """What only the whole run shows, as findings and results; its files are written."""
        job = self.job
        assert job.legs is not None and job.shop is not None
        for one, own in self._by_channel(execution):
            one.tell_of_whole(own)
        job.findings.extend(film_findings(job.shop))
        job.findings.extend(self._collisions(execution))
        if self.eyes is not None:
            self.eyes.close()
            job.findings.extend(self.eyes.findings())
            job.sensed = self.eyes.results
        for one, own in self._by_channel(execution):
            one.tell_of_beams(own)
        if self.only == "motion":
            job.legs.tell_of_untouched_stock()
        for one, own in self._by_channel(execution):
            one.keep_fallen(own, execution.loose)
        self._compare(execution)
        results = results_of(job, execution)
        self._write(results, execution)
        return results

    def _by_channel(self, execution: Execution) -> Iterator[tuple[ChannelRun, Execution]]:
        return zip(self.channels, (execution, *execution.others), strict=True)

    def _collisions(self, execution: Execution) -> list[Diagnostic]:
        """What has hit what, as far as the run went."""
        job = self.job
        assert job.cell is not None and job.shop is not None
        end = execution.steps * job.cell.simulation.step_ns * 1e-9 if execution.interrupted else None
        stays = execution.stays if job.shop.moves_parts else None
        return list(collisions(job, stays, end, execution.loose))

    def _compare(self, execution: Execution) -> None:
        """Compare the finished part with its target, if the cell has one."""
        assert self.job.cell is not None
        if self.job.cell.target is not None and self.only in (None, "shape"):
            from gcodesim.jobs.verification import verify

            self.job.target, found = verify(self.job, execution)
            self.job.findings.extend(found)

    def _write(self, results: Results, execution: Execution) -> None:
        assert self.job.shop is not None
        if self.recorder is not None:
            self.recorder.finish(results, execution)
        elif self.folder is not None:
            from gcodesim.recorder.result_files import write_files

            write_files(self.folder.path, self.job.shop, results, self.job.skins, shapes=self.only != "force")
