"""Processes that share the cases of a suite and never outlive it."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable, Generator, Sequence
from multiprocessing import get_context
from multiprocessing.connection import Connection
from threading import Thread
from typing import TYPE_CHECKING, TypeVar

from gcodesim.regress.case import Case
from gcodesim.scale.interrupts import interrupts_wait

if TYPE_CHECKING:
    from gcodesim.regress.outcome import Judging

T = TypeVar("T")


class WorkerLostError(Exception):
    """A worker was killed from outside, as happens when a system runs out of memory."""


def in_parallel(
    work: Callable[[Case, Judging], T], cases: Sequence[Case], how: Judging, jobs: int
) -> Generator[T, None, None]:
    """`work` on all cases, in their order, by `jobs` processes; closing it gives up unfinished cases.

    WorkerLostError if one of them is killed.
    """
    if jobs < 2 or len(cases) < 2:
        yield from (work(case, how) for case in cases)
        return
    from concurrent.futures import ProcessPoolExecutor
    from concurrent.futures.process import BrokenProcessPool

    # a fresh interpreter each: it inherits nothing that this process has loaded or locked
    context = get_context("spawn")
    watched, held = context.Pipe(duplex=False)
    pool = ProcessPoolExecutor(min(jobs, len(cases)), mp_context=context, initializer=_tie, initargs=(watched,))
    try:
        with interrupts_wait():
            futures = [pool.submit(work, case, how) for case in cases]
        for future in futures:
            yield future.result()
    except BrokenProcessPool:
        raise WorkerLostError(f"one of {jobs} workers was killed") from None
    except BaseException:  # also when nobody wants the rest: nothing of an unfinished case is kept
        held.close()
        raise
    finally:
        pool.shutdown(wait=True, cancel_futures=True)
        held.close()
        watched.close()


def _tie(watched: Connection) -> None:
    """End this process when the other end of `watched` is closed or its owner dies, however it dies."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # a terminal interrupts all processes; the owner decides
    Thread(target=_end_with, args=(watched,), daemon=True).start()


def _end_with(watched: Connection) -> None:
    watched.poll(None)
    os._exit(1)
