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
    with _workers(min(len(ahead), _room()), [level, objects, *sys.path]) as workers:
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
    assert worker.stdin is not None and worker.stdout is not None
    with suppress(OSError, ValueError, IndexError):  # it has ended, or there is nothing left
        while True:
            signature = ahead.pop()
            worker.stdin.write(f"{signature}\n")
            worker.stdin.flush()
            answer = worker.stdout.readline()
            answers.put((signature, answer.strip() if answer else "the compiler ended"))
            if not answer:
                return


@contextmanager
def _workers(count: int, arguments: list[str]) -> Iterator[list[subprocess.Popen[str]]]:
    workers: list[subprocess.Popen[str]] = []
    command = [sys.executable, "-P", "-c", _PROGRAM, *arguments]
    try:
        for _ in range(count):
            workers.append(
                subprocess.Popen(
                    command,
                    stdin=subprocess.PIPE,
                    stdout=subprocess.PIPE,
                    stderr=subprocess.DEVNULL,
                    text=True,
                    encoding="utf-8",
                )
            )
        yield workers
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
