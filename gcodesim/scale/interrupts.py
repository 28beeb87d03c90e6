"""Processes that a Ctrl-C of the terminal does not reach: whoever started them decides."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing import resource_tracker
from threading import current_thread, main_thread
from typing import Final

_THAT_WAIT: Final = tuple(getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name))


@contextmanager
def interrupts_wait() -> Iterator[None]:
    """Processes that are started meanwhile take no interrupt from their first moment on; our signals are handled after.

    Otherwise a worker that is still importing would answer a Ctrl-C with a traceback, and so would one that is cut off
    while loading, or whoever has only begun to start it. Masks are inherited, handlers are not, and another thread of
    ours may have no mask. SIGTERM gets none, since that is how a worker is told to end.
    """
    if not hasattr(signal, "pthread_sigmask") or current_thread() is not main_thread():
        yield
        return
    resource_tracker.ensure_running()  # it lets interrupts through again when it starts
    came: list[int] = []
    before = {number: signal.getsignal(number) for number in _THAT_WAIT}
    heard = [number for number in _THAT_WAIT if before[number] != signal.SIG_IGN]  # what is ignored stays so in workers
    for number in heard:
        signal.signal(number, lambda number, _: came.append(number))
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)
        for number in heard:
            handler = before[number]
            signal.signal(number, signal.SIG_DFL if handler is None else handler)
        if came:
            signal.raise_signal(came[0])
