"""What a cluster bears: stand-in tasks of 10 ms, and a sweep of small runs, each against its own time in one run.

`python -m benchmarks.scale [RUNS [TASKS]]`: overhead is what wall time times workers exceeds the tasks' own time by.
"""

from __future__ import annotations

import resource
import sys
import tempfile
import time
from pathlib import Path

from gcodesim.diagnostics import SourceText
from gcodesim.scale.crew import local_crew
from gcodesim.scale.hands import Alone, WorkerTask
from gcodesim.scale.worker import stand_in
from gcodesim.sweep.design import points
from gcodesim.sweep.journal import Journal
from gcodesim.sweep.prepared import Allowed, prepared
from gcodesim.sweep.running import Tally, do_runs
from gcodesim.sweep.study_file import read_study

WORKERS = 2
TAKES_S = 0.01
PROGRAMS = Path(__file__).parents[1] / "programs"
STUDY = """program: {program}
cell: {cell}
vary:
  feed: {{parameter: feed, from: 200, to: 800, steps: {steps}}}
  depth: {{parameter: depth, from: 1, to: 3, steps: 4}}
"""


def main(runs: int = 200, tasks: int = 10_000) -> None:
    stand_ins(tasks)
    sweep(runs)


def stand_ins(tasks: int) -> None:
    """Tasks that only wait: what scheduler and client add to each, and whether that grows with their number."""
    with local_crew(WORKERS) as crew:
        list(crew.do(stand_in, _tasks(100, "first")))
        for count in (tasks // 10, tasks):
            begin, own = time.perf_counter(), time.process_time()
            memory = _memory_mb()
            assert sum(1 for _ in crew.do(stand_in, _tasks(count, str(count)))) == count
            wall, cpu = time.perf_counter() - begin, time.process_time() - own
            over = wall * WORKERS / count - TAKES_S
            print(
                f"{count:6d} tasks of {TAKES_S * 1e3:.0f} ms: {wall:.1f} s, {over * 1e3:.1f} ms of a worker more each; "
                f"{cpu / count * 1e3:.2f} ms of processor a task here, {_memory_mb() - memory:.1f} MB more memory"
            )


def _tasks(count: int, name: str):  # type: ignore[no-untyped-def]
    return (WorkerTask(key=f"{name}-{n}", said={"number": n, "takes_s": TAKES_S}) for n in range(count))


def sweep(runs: int) -> None:
    """Small runs on local workers, beside the same runs alone."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "study.yaml"
        cell = PROGRAMS.parent / "cells" / "feed_depth.yaml"
        path.write_text(STUDY.format(program=PROGRAMS / "feed_depth.nc", cell=cell, steps=max(runs // 4, 2)))
        file = read_study(SourceText.read(path), path, [PROGRAMS.parent])
        assert file.study is not None, list(file.findings)
        ready, found = prepared(file, file.study, Allowed())
        assert ready is not None, found
        for name, hands in (("alone", Alone()), (f"{WORKERS} workers", None)):
            out = Path(folder) / name
            out.mkdir()
            journal, tally = Journal(out), Tally(total=runs)
            begin = time.perf_counter()
            if hands is not None:
                do_runs(ready, list(points(ready.study))[: max(runs // 10, 4)], journal, hands, tally, out=out)
                started = begin
            else:
                with local_crew(WORKERS) as crew:
                    started = time.perf_counter()
                    do_runs(ready, points(ready.study), journal, crew, tally, out=out)
            wall = time.perf_counter() - started
            count = 1 if hands is not None else WORKERS
            size = (out / "runs.jsonl").stat().st_size / max(tally.done, 1)
            print(
                f"{name}: {tally.done} runs, {wall:.1f} s, own time {tally.took_s:.1f} s, overhead "
                f"{(wall * count / tally.took_s - 1.0) * 100:.1f} %; start {started - begin:.1f} s; "
                f"{3600 * tally.done / tally.took_s:.0f} runs an hour a core; {size:.0f} bytes a run kept, "
                f"{len(ready.parcel.data)} bytes of inputs once a worker"
            )
            journal.close()


def _memory_mb() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0


if __name__ == "__main__":
    main(*(int(word) for word in sys.argv[1:]))
