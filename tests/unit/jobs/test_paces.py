"""Least speed and time at the programmed feed, beside a fine sampling of the same time law."""

from __future__ import annotations

import numpy as np
import pytest

from gcodesim.jobs.paces import REACHED, row_paces
from gcodesim.jobs.results import PACES, line_rows
from tests.unit.planning.test_axis_posing import line, planned


def test_they_are_those_of_the_samples() -> None:
    corners = [(0.02, 0.0), (0.02, 0.015), (0.3, 0.015), (0.3, 0.016), (0.5, 0.1)]
    plan = planned(*(line(k, x, y, 0.0, feed=0.1 if k != 2 else 0.4) for k, (x, y) in enumerate(corners)))
    trajectory = plan.trajectory
    t = np.linspace(0.0, trajectory.duration, 400_001)
    samples = trajectory.sample(t)
    dt = t[1] - t[0]

    paces = row_paces(trajectory)

    for row in range(len(plan.path)):
        speed = samples.speed[samples.row == row]
        assert paces.least[row] == pytest.approx(speed.min(), abs=1e-3)
        reached = float((speed >= REACHED * plan.path.feed[row]).sum()) * dt
        assert paces.at_feed[row] == pytest.approx(reached, abs=3.0 * dt + 1e-6)
    assert paces.at_feed.max() > 0.5


def test_a_line_has_the_least_of_its_passes_and_their_share() -> None:
    plan = planned(line(1, 0.2, 0.0, 0.0), line(2, 0.4, 0.0, 0.0))
    trajectory = plan.trajectory
    paces = row_paces(trajectory)
    rows = line_rows(plan.path, trajectory.row_time, plan.path.length, None, paces=paces)

    assert list(rows.more) == list(PACES)
    assert rows.numbers[:, 5] == pytest.approx(paces.least * 60e3)
    assert rows.numbers[:, 6] == pytest.approx(paces.at_feed / trajectory.row_time)
    assert 0.9 < rows.numbers[1, 6] < 1.0
