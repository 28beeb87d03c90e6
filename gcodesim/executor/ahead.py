"""Cutting ahead: a second thread computes what the tools do in a window if the machine follows its command.

Where motors keep up, the cut depends on the command alone, so the stock may be a window ahead of the world. When a
motor turns out to be too weak, what was cut ahead is undone and the cut goes on with the motion, step by step.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final

from gcodesim.executor.coupling import Stretch
from gcodesim.executor.stint import Stint
from gcodesim.executor.window import StepWindow
from gcodesim.frames import Array

if TYPE_CHECKING:
    from concurrent.futures import Future

    from gcodesim.executor.weave import Weave

IN_CONTACT: Final = 8
"""Steps that are cut at once while a body of the machine is in a stock: which material it meets first is known."""

Look = Callable[[StepWindow], Any]
"""Looks at the stocks as a window leaves them; called before the next one changes them."""


@dataclass(slots=True, kw_only=True, eq=False)
class WindowCut:
    """One window with its stretches, each of one tool. `wrenches`: what the tools feel; `seen`: what `Look` saw.

    `looks`: whether this is the moment to look, which it is once all channels have cut the window. `weave`: it is cut
    together with the windows of other channels.
    """

    window: StepWindow
    stretches: list[Stretch]
    wrenches: list[Array] = field(default_factory=list)
    seen: Any = None
    looks: bool = True
    undo: list[Callable[[], None]] = field(default_factory=list)
    work: Future[None] | None = None
    weave: Weave | None = None

    def ready(self, index: int) -> Stretch:
        """The stretch at `index`, which is next. Where a body of the machine meets a stock as it stands by now, the

        stretch is divided, so that the rest is looked at once more when it has been cut up to there.
        """
        while True:
            stretch = self.stretches[index]
            seen = stretch.look()
            if seen is None or not seen.meets:
                return stretch
            at_once = IN_CONTACT if seen.goes_on else 1
            parts = stretch.divided(seen.free if seen.free else at_once)
            if not parts or (not seen.free and len(stretch) <= at_once):
                return stretch
            self.stretches[index : index + 1] = parts

    @property
    def stints(self) -> list[Stint]:
        """Everything that the tools did, in order."""
        return [stint for stretch in self.stretches for stint in stretch.stints]


class CutThread:
    """A thread that cuts window after window, in order; kernels release the interpreter.

    `undoable` keeps each stock as it was, so that `take_back` works. An exception in the thread is raised by `wait`.
    """

    def __init__(self, look: Look | None, *, undoable: bool) -> None:
        from concurrent.futures import ThreadPoolExecutor  # brings logging

        self._thread: Final = ThreadPoolExecutor(1)
        self._look, self._undoable = look, undoable

    def begin(self, cut: WindowCut) -> None:
        """Cut this window as soon as the one before it is done; a second call for the same window does nothing."""
        if cut.work is not None:
            return
        if cut.weave is None:
            cut.work = self._thread.submit(self.cut, cut)
            return
        work = self._thread.submit(self._cut_together, cut.weave)
        for each in cut.weave.cuts:
            each.work = work

    def _cut_together(self, weave: Weave) -> None:
        weave.cut(undoable=self._undoable)
        for cut in weave.cuts:
            self.see(cut)

    def cut(self, cut: WindowCut) -> None:
        """Cut the rest of a window in the calling thread, and look at the stocks."""
        while len(cut.wrenches) < len(cut.stretches):
            stretch = cut.ready(len(cut.wrenches))
            if self._undoable:
                cut.undo.append(stretch.save())
            cut.wrenches.append(stretch.whole())
            stretch.settle()
        self.see(cut)

    def see(self, cut: WindowCut) -> None:
        """Look at the stocks as this window leaves them."""
        cut.seen = None if self._look is None or not cut.looks else self._look(cut.window)

    @staticmethod
    def wait(cut: WindowCut) -> None:
        """Wait until the window is cut."""
        if cut.work is not None:
            cut.work.result()

    def take_back(self, cut: WindowCut, first: int = 0) -> None:
        """Undo the stretches from `first` on; of windows that are cut together all."""
        self.wait(cut)
        if cut.weave is not None:
            cut.weave.take_back()
            return
        while len(cut.wrenches) > first:
            cut.wrenches.pop()
            cut.undo.pop()()
            watch = cut.stretches[len(cut.wrenches)].watch
            if watch is not None:
                watch.forget()
        if first == 0:
            cut.work = None

    def close(self) -> None:
        """Wait until all work that was begun is done."""
        self._thread.shutdown()
