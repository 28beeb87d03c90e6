"""Messages come out in the order of time, table and arrival, whenever they went in."""

import numpy as np
import pytest

from gcodesim.log.backlog import Backlog


def test_random_arrivals_come_out_in_order():
    rng = np.random.default_rng(8)
    backlog, expected, found = Backlog(), [], []
    horizon = 0
    for step in range(200):
        for _ in range(int(rng.integers(0, 5))):
            channel, count = int(rng.integers(1, 4)), int(rng.integers(1, 6))
            times = np.sort(horizon + rng.integers(0, 300, count))
            numbers = range(len(expected), len(expected) + count)
            if count == 1:
                backlog.add(channel, int(times[0]), b"%d" % numbers[0])
            else:
                backlog.add_many(channel, times, [b"%d" % number for number in numbers])
            expected += [(t_ns, channel, number) for t_ns, number in zip(times.tolist(), numbers, strict=True)]
        horizon = 10 * step
        due = list(backlog.due(horizon))
        assert all(message.t_ns < horizon for message in due)
        found += due
    assert bool(backlog)
    found += backlog.due(10**6)

    assert len(found) == len(expected) > 1000
    assert [(m.t_ns, m.channel, int(m.data)) for m in found] == sorted(expected)
    assert not backlog


def test_as_many_times_as_messages():
    with pytest.raises(ValueError, match="2 messages at 1 times"):
        Backlog().add_many(1, np.zeros(1, dtype=np.int64), [b"", b""])
