"""Signals that end a command, and their exit statuses: 128 plus the number, as in shells."""

from __future__ import annotations

import _thread
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Final

SIGNALS: Final = tuple(getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name))
"""Ctrl-C; the signal with which CI systems cancel; a terminal that is closed."""

_AGAIN_S: Final = 0.02  # after which a signal that was passed over comes again


class Interrupted(KeyboardInterrupt):
    """One of the signals has arrived; open files are closed while this is raised."""

    def __init__(self, number: int) -> None:
        super().__init__()
        self.number = number


class LastSignal:
    """The last signal that was handled inside a context; 0 before one arrives."""

    number = 0


def interrupted_by(number: int) -> int:
    """The exit status: 130 for SIGINT, 143 for SIGTERM, 129 for SIGHUP."""
    return 128 + int(number)


@contextmanager
def left_at_once(first: Callable[[], object] = lambda: None) -> Iterator[None]:
    """Inside this context, that of a server, a signal ends the process after `first`, whatever its threads do.

    One of them reads, and an orderly end would wait for the client's next word. Python calls handlers between two steps
    of the main thread: a signal that comes just before that one begins to wait would not be heard before that word
    either. So a thread of its own waits for signals, too.
    """
    leaving = threading.Lock()

    def leave(number: int, _frame: FrameType | None = None) -> None:
        if leaving.acquire(blocking=False):
            first()
            os.write(2, b"gcodesim: interrupted\n")  # not print: a signal may come while a stream is in use
            os._exit(interrupted_by(number))

    def wait() -> None:
        for number in os.read(read_end, 1):
            leave(number)

    if threading.current_thread() is not threading.main_thread():
        yield
        return
    read_end, write_end = os.pipe()
    os.set_blocking(write_end, False)
    waiting = threading.Thread(target=wait, daemon=True)
    waiting.start()
    with handled(leave):
        before = signal.set_wakeup_fd(write_end, warn_on_full_buffer=False)
        try:
            yield
        finally:
            signal.set_wakeup_fd(before)
            os.close(write_end)
            waiting.join()
            os.close(read_end)


@contextmanager
def handled(handler: Callable[[int, FrameType | None], None] | None = None) -> Iterator[LastSignal]:
    """Call `handler` for the signals inside this context (default: raise `Interrupted`, and keep which one it was).

    What an exception becomes on its way out is up to those whom it passes: a run that ends in order tells of that.
    Python passes over one that is raised in a destructor or in a callback of a weak reference, as there are many while
    modules are loaded; that one is raised again a moment later.

    A signal that is ignored stays so, as under `nohup`. Only the main thread may handle signals; in another one
    nothing changes.
    """
    heard = LastSignal()

    def end(number: int, _frame: FrameType | None) -> None:
        heard.number = number
        raise Interrupted(number)

    if threading.current_thread() is not threading.main_thread():
        yield heard
        return
    before = {}
    passed_over = sys.unraisablehook

    def again(what: sys.UnraisableHookArgs) -> None:
        if not isinstance(what.exc_value, Interrupted):
            passed_over(what)
            return
        timer = threading.Timer(_AGAIN_S, _signal_to_main_thread, [what.exc_value.number])
        timer.daemon = True
        timer.start()

    try:
        sys.unraisablehook = again
        for number in SIGNALS:
            known = signal.getsignal(number)
            if known is not None and known != signal.SIG_IGN:  # None: a handler that was not installed from Python
                before[number] = signal.signal(number, handler or end)
        yield heard
    finally:
        sys.unraisablehook = passed_over
        for number, known in before.items():
            signal.signal(number, known)


def _signal_to_main_thread(number: int) -> None:
    """As from outside, so that it also ends what the main thread waits for."""
    main = threading.main_thread().ident
    if hasattr(signal, "pthread_kill") and main is not None:
        signal.pthread_kill(main, number)
    else:  # Windows
        _thread.interrupt_main(signal.Signals(number))
