"""Work that is done behind the loop: piece by piece in a second thread, at most one at a time."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from concurrent.futures import Future


class Behind:
    """A thread that writes things down while the next window is computed; kernels release the interpreter.

    Order is kept, so results do not depend on which thread is faster. An exception there
    is raised at the next call here.
    """

    def __init__(self) -> None:
        from concurrent.futures import ThreadPoolExecutor  # brings logging

        self._thread = ThreadPoolExecutor(1)
        self._at_work: Future[None] | None = None

    def do(self, work: Callable[[], None]) -> None:
        """Begin `work` as soon as the work given before is done."""
        self._wait()
        self._at_work = self._thread.submit(work)

    def _wait(self) -> None:
        before, self._at_work = self._at_work, None
        if before is not None:
            before.result()

    def close(self) -> None:
        """Wait until everything is done."""
        try:
            self._wait()
        finally:
            self._thread.shutdown()
