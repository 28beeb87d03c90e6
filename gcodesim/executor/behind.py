"""Work that runs behind the loop: one piece after the other in a second thread, at most one at a time."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from concurrent.futures import Future


class Behind:
    """A thread for what is written down while the next window is computed; kernels leave the interpreter to it.

    Order is kept, so results do not depend on who is faster. What fails there
    is raised at the next call here.
    """

    def __init__(self) -> None:
        from concurrent.futures import ThreadPoolExecutor  # brings logging

        self._thread = ThreadPoolExecutor(1)
        self._at_work: Future[None] | None = None

    def do(self, work: Callable[[], None]) -> None:
        """Begin with `work` as soon as what was given before is done."""
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
