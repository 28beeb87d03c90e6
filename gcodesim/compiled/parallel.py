"""Compiles many kernels at once, in a process for each core."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from queue import Empty, SimpleQueue
from threading import Thread
from typing import Final

EVERY: Final = 2.0
"""Seconds between two words about how far it is."""
_MEMORY: Final = 500e6
"""Bytes that a process needs to compile the longest kernel."""
# the folders of this process and no others: not the one in which somebody happens to work
_PROGRAM: Final = """
import sys
sys.path[:] = sys.argv[3:]
from gcodesim.compiled.worker import work
work(*sys.argv[1:3])
"""


def compile_all(
    signatures: Sequence[str], say: Callable[[int], None], *, level: str = "", objects: str = ""
) -> dict[str, str]:
    """Compile in the given order; returns the reasons of those that failed.

    `say` gets the number of those that are done, every two seconds. `level`, `objects`: see `worker`.
    """
    ahead = list(reversed(signatures))
    answers: SimpleQueue[tuple[str, str]] = SimpleQueue()
    done: dict[str, str] = {}
    with _workers([level, objects, *sys.path]) as start:
        workers = [start()]
        count = min(len(ahead), _room())
        if count > 1:  # one compiles the last, a short one, alone, and the others find the byte code of numba made
            _hand_over(workers[0], ahead.pop(0), answers)
            workers += [start() for _ in range(1, count)]
        threads = [Thread(target=_hand_out, args=(worker, ahead, answers), daemon=True) for worker in workers]
        for thread in threads:
            thread.start()
        next_word = time.monotonic() + EVERY
        while len(done) < len(signatures) and (ahead or not answers.empty() or any(t.is_alive() for t in threads)):
            with suppress(Empty):
                signature, answer = answers.get(timeout=max(next_word - time.monotonic(), 0.01))
                done[signature] = answer
            if time.monotonic() >= next_word:
                say(len(done))
                next_word += EVERY
    return {signature: done.get(signature, "not compiled") for signature in signatures if done.get(signature, "-")}


def _hand_out(worker: subprocess.Popen[str], ahead: list[str], answers: SimpleQueue[tuple[str, str]]) -> None:
    """Give one process one kernel after another, until none is left."""
    with suppress(IndexError):  # there is nothing left
        while _hand_over(worker, ahead.pop(), answers):
            pass


def _hand_over(worker: subprocess.Popen[str], signature: str, answers: SimpleQueue[tuple[str, str]]) -> bool:
    """Have a process compile one kernel; returns whether it can compile more."""
    assert worker.stdin is not None and worker.stdout is not None
    answer = ""
    with suppress(OSError, ValueError):  # it has ended
        worker.stdin.write(f"{signature}\n")
        worker.stdin.flush()
        answer = worker.stdout.readline()
    answers.put((signature, answer.strip() if answer else "the compiler ended"))
    return bool(answer)


@contextmanager
def _workers(arguments: list[str]) -> Iterator[Callable[[], subprocess.Popen[str]]]:
    """A function that starts a process; all of them end with the block."""
    workers: list[subprocess.Popen[str]] = []
    command = [sys.executable, "-P", "-c", _PROGRAM, *arguments]

    def start() -> subprocess.Popen[str]:
        pipe = subprocess.PIPE
        worker = subprocess.Popen(
            command, stdin=pipe, stdout=pipe, stderr=subprocess.DEVNULL, text=True, encoding="utf-8"
        )
        workers.append(worker)
        return worker

    try:
        yield start
    finally:
        for worker in workers:
            worker.kill()
        for worker in workers:
            worker.wait()
            for pipe in (worker.stdin, worker.stdout):
                with suppress(OSError):  # what was not sent is not needed
                    pipe.close()  # type: ignore[union-attr]


def _room() -> int:
    """How many processes fit: one for each core, while there is memory."""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    try:
        memory = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    except (ValueError, OSError, AttributeError):
        return cores
    return max(1, min(cores, int(memory / _MEMORY)))
