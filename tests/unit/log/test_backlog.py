"""Messages come out in the order of time, table and arrival, whenever they went in."""

import numpy as np

from gcodesim.log.backlog import Backlog


def test_random_arrivals_come_out_in_order():
    rng = np.random.default_rng(8)
    backlog, expected, found = Backlog(), [], []
    horizon = 0
    for step in range(200):
        for _ in range(int(rng.integers(0, 5))):
            t_ns, channel = horizon + int(rng.integers(0, 300)), int(rng.integers(1, 4))
            backlog.add(channel, (t_ns,), (b"%d" % len(expected),))
            expected.append((t_ns, channel, len(expected)))
        horizon = 10 * step
        due = backlog.due(horizon)
        assert all(message.t_ns < horizon for message in due)
        found += due
    assert bool(backlog)
    found += backlog.due(10**6)

    assert [(m.t_ns, m.channel, m.arrival) for m in found] == sorted(expected)
    assert [int(m.data) for m in found] == [m.arrival for m in found]
    assert not backlog
