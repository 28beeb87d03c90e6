"""One program of a job while it runs: what it brings to the executor, and what is found about it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from gcodesim.checks.coarse import coarse_findings
from gcodesim.checks.missing_length import cutting_without_length
from gcodesim.checks.saturation import EFFORT
from gcodesim.diagnostics import Diagnostic
from gcodesim.executor import TrackPlan
from gcodesim.jobs.beam_beyond import beyond_findings
from gcodesim.jobs.inspection import Inspector
from gcodesim.jobs.job import KINEMATIC, Job
from gcodesim.jobs.loose_pieces import fallen_pieces
from gcodesim.observation.schedule import stations_of

if TYPE_CHECKING:
    from gcodesim.executor import Execution
    from gcodesim.executor.loose_bodies import LooseBody
    from gcodesim.executor.record import StepRecord
    from gcodesim.executor.totals import JointTotals, RowTotals
    from gcodesim.executor.watcher import Watcher
    from gcodesim.planning import Plan


class ChannelRun:
    """The job of one channel, planned and with stock; grids too coarse for a tool are told at once."""

    def __init__(self, job: Job) -> None:
        assert job.plan is not None and job.shop is not None and job.cell is not None and job.legs is not None
        self.job, self.shop = job, job.shop
        coarse = list(coarse_findings(job.shop, job.plan))
        self.told_coarse = bool(coarse)
        job.findings.extend(coarse)
        self.bodies = job.legs.watch_stocks()
        self.inspector = Inspector(
            job.plan, job.shop, job.cell.simulation.step_ns, freely=job.world != KINEMATIC, bodies=self.bodies
        )

    def track_plan(self, watcher: Watcher | None) -> TrackPlan:
        """What the executor needs of this channel."""
        assert self.job.plan is not None
        self.inspector.watched = watcher is not None
        return TrackPlan(
            plan=self.job.plan,
            shop=self.shop,
            inspect=self._inspect,
            watcher=watcher,
            only=self.job.options.only,
            bodies=self.bodies,
            efforts=self._asks_for_efforts(),
            led=self.job.led,
        )

    def _asks_for_efforts(self) -> bool:
        """Whether anybody wants to know speeds and efforts: not for the shape alone, but for sensors and callers."""
        assert self.job.cell is not None
        return self.job.options.only != "shape" or self.job.seen is not None or bool(stations_of(self.job.cell))

    def _inspect(self, record: StepRecord, rows: RowTotals, joints: JointTotals) -> list[Diagnostic]:
        if self.job.seen is not None:
            self.job.seen(record)
        return self.job.shown(self.inspector.fresh(record, rows, joints))

    def follow(self, plan: Plan) -> None:
        """The run goes on with a leg; `plan` is that of all legs so far."""
        self.inspector.follow(plan)

    def tell_of_whole(self, execution: Execution) -> None:
        """Findings that need the whole run."""
        job, plan = self.job, self.job.plan
        assert plan is not None
        found = self.inspector.final(execution)
        if any(finding.code == EFFORT for finding in found):  # the run says of each joint for how long, too
            job.findings.withdraw([finding for finding in job.findings if finding.code == EFFORT])
        job.findings.extend(found)
        job.findings.change(cutting_without_length(job.findings, plan, self.shop, execution.rows["removed"]))
        if not self.told_coarse:
            job.findings.extend(coarse_findings(self.shop, plan))

    def tell_of_beams(self, execution: Execution) -> None:
        """Findings about beams that go on behind their stock."""
        self.job.findings.extend(beyond_findings(self.job, execution))

    def keep_fallen(self, execution: Execution, loose: Sequence[LooseBody]) -> None:
        """Hand the pieces that came loose to the job; `loose` are those of all channels as bodies."""
        for name, piece in fallen_pieces(self.job, execution, loose):
            self.job.fallen.setdefault(name, []).append(piece)
