"""Rows that belong to one event."""

from __future__ import annotations

import numpy as np

from gcodesim.diagnostics.events import runs


def test_runs_bridge_gaps_that_do_not_end_them() -> None:
    fault = np.array([0, 1, 0, 1, 0, 0, 1, 1], dtype=bool)
    ends = np.array([0, 0, 0, 0, 1, 0, 0, 0], dtype=bool)

    assert [r.tolist() for r in runs(fault)] == [[1], [3], [6, 7]]
    assert [r.tolist() for r in runs(fault, ends)] == [[1, 3], [6, 7]]
    assert [r.tolist() for r in runs(fault, ends, np.array([0, 0, 1, 1, 1, 1, 1, 2]))] == [[1], [3], [6], [7]]
    assert list(runs(np.zeros(3, dtype=bool))) == []
