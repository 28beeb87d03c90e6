"""Records and totals: what several processes say of the same steps, and what many steps come to."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from gcodesim.executor.record import StepRecord, record_of
from gcodesim.executor.stint import Stint
from gcodesim.executor.totals import RowTotals
from gcodesim.frames import Pose, rotation_about
from gcodesim.processes.column import HOUSE, Column
from gcodesim.processes.sheet import Sheet
from gcodesim.processes.window import ProcessState, ProcessStep

SUM, TOP = Column("dust", "m^3"), Column("depth", "m", of="greatest")
FLAG, LAST = Column("hot", of="any"), Column("film", "m", of="last")
TWICE = Column("torque_like", "N·m", of="greatest", together="sum")
PEAK = Column("peak_force", "N", of="greatest", together="sum", steady="force")
PEAK_TORQUE = Column("peak_torque", "N·m", of="greatest", together="sum", steady="torque")
SHEET = Sheet(kinds=("", "one", "two"), columns=(*HOUSE, SUM, TOP, FLAG, LAST, TWICE, PEAK, PEAK_TORQUE))


def window(rows: list[int]) -> Any:
    class Steps(SimpleNamespace):
        def __len__(self) -> int:
            return len(rows)

    return Steps(row=np.array(rows), dt=0.5)


def stint(begin: int, kind: str = "one", wrench: Any = None, R: Any = None, **columns: Any) -> Stint:
    """An answer to the steps from `begin` on, as long as its columns."""
    n = len(next(iter(columns.values())))
    X = np.tile(np.eye(4), (n, 1, 1))
    if R is not None:
        X[:, :3, :3] = R
    answer = ProcessStep(
        wrench=np.zeros((n, 6)) if wrench is None else np.tile(wrench, (n, 1)),
        deflection=np.zeros((n, 3)),
        columns={name: np.array(values) for name, values in columns.items()},
    )
    made = Stint(
        task=SimpleNamespace(process=SimpleNamespace(kind=kind)),  # type: ignore[arg-type]
        begin=begin,
        end=begin + n,
        window=SimpleNamespace(compliance=None),  # type: ignore[arg-type]
        X_BS=X,
        share=np.zeros((0, 2)),
        row=np.zeros(0, dtype=np.int64),
    )
    made._keep(answer)
    return made


def record(rows: list[int], *stints: Stint, standing: dict[str, float] | None = None) -> StepRecord:
    return record_of(window(rows), SimpleNamespace(), list(stints), SHEET, standing)  # type: ignore[arg-type]


def test_nobody_near_is_nothing_everywhere() -> None:
    empty = record([0, 0, 1])

    assert all(len(column) == 3 and not column.any() for column in empty.columns.values())
    assert not empty.wrench.any() and not empty.kind.any()


def test_columns_of_one_step_become_one_as_they_declare() -> None:
    one = stint(1, dust=[1.0, 2.0], depth=[3.0, 1.0], hot=[True, False], torque_like=[1.0, 1.0])
    two = stint(2, "two", dust=[5.0, 6.0], depth=[2.0, 2.0], hot=[False, True], torque_like=[1.0, 4.0])
    both = record([0, 0, 0, 0], one, two)

    assert both["dust"].tolist() == [0.0, 1.0, 7.0, 6.0]
    assert both["depth"].tolist() == [0.0, 3.0, 2.0, 2.0]
    assert both["hot"].tolist() == [False, True, False, True]
    assert both["torque_like"].tolist() == [0.0, 1.0, 2.0, 4.0]


def test_what_pushes_without_a_word_of_peaks_pushes_steadily() -> None:
    push = np.array([3.0, 0.0, 4.0, 0.0, 0.0, 0.0])
    mill = stint(0, wrench=push, torque=[1.0, 1.0], peak_force=[7.0, 8.0], peak_torque=[2.0, 2.0])
    turned = stint(1, "two", wrench=push, torque=[0.5, 0.5])
    both = record([0, 0, 0], mill, turned)

    assert both["force"].tolist() == [5.0, 10.0, 5.0]
    assert both["peak_force"].tolist() == [7.0, 13.0, 5.0]
    assert both["peak_torque"].tolist() == [2.0, 2.5, 0.5]


def test_the_last_value_stands_until_another_one_is_said() -> None:
    first = record([0, 0, 0, 0, 0], stint(1, film=[2.0, 3.0]), stint(4, film=[7.0]))

    assert first["film"].tolist() == [0.0, 2.0, 3.0, 3.0, 7.0]
    assert first.standing == {"film": 7.0}
    assert record([0, 0], standing=first.standing)["film"].tolist() == [7.0, 7.0]


def test_the_kind_is_that_of_the_process_at_work() -> None:
    told = record([0] * 4, stint(0, engaged=[True, True, False]), stint(1, "two", engaged=[False, True, True]))

    assert told.kind.tolist() == [1, 1, 2, 2]
    assert told["engaged"].all()


def test_wrenches_are_added_in_base_axes_and_give_the_force() -> None:
    R = rotation_about(np.array([0.0, 0.0, 1.0]), np.pi / 2)
    pushed = record([0, 0], stint(0, dust=[0.0, 0.0], wrench=[3.0, 0, 0, 0, 0, 0]),
                    stint(0, dust=[0.0, 0.0], wrench=[4.0, 0, 0, 1.0, 0, 0], R=R))  # fmt: skip

    assert pushed.wrench[0] == pytest.approx([3.0, 4.0, 0.0, 0.0, 1.0, 0.0])
    assert pushed["force"] == pytest.approx([5.0, 5.0])
    assert Pose.identity().p.tolist() == [0.0, 0.0, 0.0]


def test_rows_sum_up_as_columns_declare() -> None:
    totals = RowTotals.zeros(3, SHEET)
    told = stint(0, dust=[1.0, 2.0, 4.0], depth=[-3.0, 1.0, 1.0], hot=[True, True, True], film=[1, 2, 3])
    first = record([0, 0, 1], told)
    totals.add(first)
    totals.add(record([1, 2], stint(0, dust=[8.0], depth=[2.0], hot=[False], film=[4.0]), standing=first.standing))

    assert totals["dust"].tolist() == [3.0, 12.0, 0.0]
    assert totals["depth"].tolist() == [3.0, 2.0, 0.0]  # in size
    assert totals["hot"].tolist() == [1.0, 0.5, 0.0]  # seconds
    assert totals["film"].tolist() == [2.0, 4.0, 4.0]


def test_where_windows_begin_does_not_show() -> None:
    rng = np.random.default_rng(3)
    dust, film = rng.uniform(size=(2, 40)).tolist()
    rows = np.sort(rng.integers(0, 7, 40)).tolist()
    whole, cut = RowTotals.zeros(7, SHEET), RowTotals.zeros(7, SHEET)
    whole.add(record(rows, stint(0, dust=dust, film=film)))
    standing: dict[str, float] = {}
    for at in range(0, 40, 7):
        here = slice(at, at + 7)
        piece = record(rows[here], stint(0, dust=dust[here], film=film[here]), standing=standing)
        standing = piece.standing
        cut.add(piece)

    for name in ("dust", "film"):
        assert np.array_equal(whole[name], cut[name])


def test_what_a_stock_lost_and_gained_is_one_net_volume() -> None:
    both = record([0, 0], stint(0, removed=[3.0, 0.0]), stint(0, added=[1.0, 2.0]))

    assert both.net_removed.tolist() == [2.0, -2.0]


def test_a_state_is_fresh_for_every_tool() -> None:
    assert ProcessState().values is not ProcessState().values
