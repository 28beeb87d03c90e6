"""The results of several programs that ran at once, as one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from gcodesim.diagnostics import Diagnostic
from gcodesim.frozen import frozen
from gcodesim.jobs.block_times import block_times
from gcodesim.jobs.results import LineRows, Results, StockResult
from gcodesim.numbers import rounded
from gcodesim.planning.marks import is_wait
from gcodesim.units import MM

if TYPE_CHECKING:
    from gcodesim.jobs.job import Job
    from gcodesim.jobs.meetings import Appointments

_ORDER: Final = ("failed", "findings", "ok")


@frozen(eq=False)
class ChannelResult:
    """One of the programs that ran at once."""

    job: Job
    results: Results
    end: float | None
    meetings: Appointments
    blocks: Sequence[Mapping[str, Any]] | None = None

    def as_json(self) -> dict[str, Any]:
        job = self.job
        assert job.plan is not None
        waited = sum(event.duration for event in job.plan.trajectory.events if is_wait(event.event))
        value: dict[str, Any] = {
            "program": {"name": job.program.name, "sha256": job.program.sha256},
            "mover": job.shop.name if job.shop is not None else "",
            "status": self.results.status,
            "end_s": None if self.end is None else rounded(self.end),
            "time": self.results.times.as_json() | {"wait_s": rounded(waited)},
            "distance": {
                "feed_mm": rounded(self.results.feed_distance / MM),
                "rapid_mm": rounded(self.results.rapid_distance / MM),
            },
            "waits": self.meetings.waits(job.channel),
        }
        if self.blocks is not None:
            value["blocks"] = list(self.blocks)
        return value


def joint_results(jobs: Sequence[Job], each: Sequence[Results], *, ran: bool) -> Results:
    """The results of all channels, the first of `jobs` first; `ran`: as far as a run came, else as a check sees it.

    The times are those of the channel that ends last; ways add up; findings, tools, joints and lines are those of all.
    """
    meetings = jobs[0].meetings
    last = max(range(len(jobs)), key=lambda i: (each[i].times.total, -i))
    found = dict.fromkeys(finding for results in each for finding in results.findings)
    status = min((results.status for results in each), key=_ORDER.index)
    channels: dict[str, ChannelResult] = {}
    if meetings is not None:
        for job, results in sorted(zip(jobs, each, strict=True), key=lambda pair: pair[0].channel):
            end = meetings.table.ends[job.channel]
            assert job.plan is not None
            blocks = None if ran else block_times(job.plan.trajectory, unended=end is None and job.held is not None)
            channels[job.channel] = ChannelResult(job=job, results=results, end=end, meetings=meetings, blocks=blocks)
    return replace(
        each[0],
        status=status,
        stopped_at=next((results.stopped_at for results in each if results.stopped_at is not None), None),
        inputs=_inputs(jobs, each),
        findings=sorted(found, key=_order),
        times=each[last].times,
        feed_distance=sum(results.feed_distance for results in each),
        rapid_distance=sum(results.rapid_distance for results in each),
        stocks=_stocks([results.stocks for results in each]),
        tools=[_of(entry, job) for job, results in zip(jobs, each, strict=True) for entry in results.tools],
        joints=[entry for results in each for entry in results.joints],
        not_simulated=[
            _of(entry, job) for job, results in zip(jobs, each, strict=True) for entry in results.not_simulated
        ],
        probings=[probing for results in each for probing in results.probings],
        lines=_lines(jobs, [results.lines for results in each]),
        channels={name: channel.as_json() for name, channel in channels.items()},
        meetings=None if meetings is None else meetings.as_json(),
    )


def _order(finding: Diagnostic) -> tuple[Any, ...]:
    return finding.order


def _stocks(parts: Sequence[Mapping[str, StockResult]]) -> dict[str, StockResult]:
    """The stocks, with what all programs have removed and added."""
    found = dict(parts[0])
    for part in parts[1:]:
        for name, stock in part.items():
            known = found[name]
            removed, deposited = known.removed + stock.removed, known.deposited + stock.deposited
            force = None if known.force is None or stock.force is None else max(known.force, stock.force)
            found[name] = replace(known, removed=removed, deposited=deposited, force=force)
    return found


def _of(entry: Mapping[str, Any], job: Job) -> dict[str, Any]:
    return {**entry, "channel": job.channel}


def _inputs(jobs: Sequence[Job], each: Sequence[Results]) -> dict[str, Any]:
    """The inputs of the first program; the others are among its `files`."""
    inputs = dict(each[0].inputs)
    own = inputs["program"]["name"]
    files = {file["name"]: file for results in each for file in results.inputs["files"]}
    files |= {job.program.name: {"name": job.program.name, "sha256": job.program.sha256} for job in jobs}
    inputs["files"] = [file for name, file in sorted(files.items()) if name != own]
    return inputs


def _lines(jobs: Sequence[Job], parts: Sequence[LineRows]) -> LineRows:
    """The lines of all channels, one channel after the other."""
    files = list(dict.fromkeys(file for part in parts for file in part.files))
    widest = max(parts, key=lambda part: len(part.more))
    full = [part for part in parts if len(part.file)]
    named = [np.array([files.index(file) for file in part.files], dtype=np.int64)[part.file] for part in full]
    return LineRows(
        files=files,
        file=np.concatenate([np.zeros(0, dtype=np.int64), *named]),
        line=np.concatenate([np.zeros(0, dtype=np.int64), *(part.line for part in full)]),
        numbers=np.concatenate([np.zeros((0, 5 + len(widest.more))), *(part.numbers for part in full)]),
        more=widest.more,
        channels=[job.channel for job, part in zip(jobs, parts, strict=True) for _ in range(len(part.file))],
    )
