"""Stocks that stand in each other, such as the layers of a plate or a screw in it, for what acts on all of them."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from gcodesim.frames import Pose
from gcodesim.frozen import frozen

if TYPE_CHECKING:
    from gcodesim.material.stock import Stock

Array = NDArray[np.float64]
T = TypeVar("T")


@frozen(eq=False)
class StockAssembly:
    """m `stocks` by their `names`, the whole first and then its parts, and the material of each, if it is known.

    `X` are their m frames in that of the first.
    """

    names: tuple[str, ...]
    stocks: tuple[Stock, ...]
    materials: tuple[Any, ...]
    X: tuple[Pose, ...]

    def memento(self) -> Callable[[], None]:
        """Remember the state of all; calling the result restores it."""
        kept = [stock.memento() for stock in self.stocks]

        def restore() -> None:
            for back in kept:
                back()

        return restore

    def laid(self, lay: Callable[[Stock], T]) -> T:
        """What `lay` does to the whole while its parts fill their room in it; what it lays stays with the whole."""
        from gcodesim.material.assembly_kernels import keep_laid, put_in
        from gcodesim.material.field_kernels import Columns
        from gcodesim.material.kernels import patch_tops

        whole = self.stocks[0]
        most = sum(int(stock.field.columns.number.max(initial=0)) for stock in self.stocks)
        while whole.field.columns.lo.shape[2] < most:
            whole.grow()
        before = _copied(whole.field.columns)
        for part, X in zip(self.stocks[1:], self.X[1:], strict=True):
            own = part.field
            while not put_in(whole.field.columns, whole.field.grid, own.columns, own.grid, X.inverse().matrix):
                whole.grow()  # a part that leans has more above a place than any column of it
        patch_tops(whole.field.columns, whole.field.tops)
        joined = _copied(whole.field.columns)
        done = lay(whole)
        while True:
            now = whole.field.columns
            kept, room = _copied(now), 2 * now.lo.shape[2] + joined.lo.shape[2]
            laid = Columns(np.zeros((1, 1, room)), np.zeros((1, 1, room)), np.zeros((1, 1), dtype=np.int32))
            if keep_laid(before, joined, now, laid):
                break
            whole.field = whole.field._replace(columns=kept)
            whole.grow()
        patch_tops(whole.field.columns, whole.field.tops)
        return done


def _copied(columns: Any) -> Any:
    return type(columns)(*(part.copy() for part in columns))
