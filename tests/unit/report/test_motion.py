"""The moments that a replay keeps."""

import numpy as np

from gcodesim.report.motion import key_moments

NONE = np.zeros(0, dtype=np.int64)


def gap(signals, kept):
    rows = np.arange(len(signals))
    lines = np.stack([np.interp(rows, kept, signals[kept, k]) for k in range(signals.shape[1])], axis=1)
    return np.abs(lines - signals).max(axis=0)


def test_straight_stretches_need_their_ends_only():
    corner = np.concatenate([np.linspace(0, 1, 501), np.linspace(1, 0, 501)[1:]])
    signals = np.stack([corner, np.zeros(1001)], axis=1)

    assert key_moments(signals, np.array([1e-6, 1e-6]), NONE).tolist() == [0, 500, 1000]


def test_nothing_is_further_off_than_allowed():
    rng = np.random.default_rng(11)
    signals = np.cumsum(rng.normal(size=(3000, 4)), axis=0) * [1.0, 1.0, 10.0, 0.1]
    tolerance = np.array([2.0, 3.0, 20.0, 0.5])

    kept = key_moments(signals, tolerance, NONE)

    assert (gap(signals, kept) <= tolerance).all()
    assert 10 < len(kept) < 2000


def test_forced_moments_stay():
    kept = key_moments(np.zeros((100, 1)), np.ones(1), np.array([17, 40]))

    assert kept.tolist() == [0, 17, 40, 99]


def test_a_limit_is_kept_by_being_coarser():
    t = np.linspace(0, 60, 20_000)
    signals = np.stack([np.sin(7 * t), np.cos(9 * t)], axis=1)

    kept = key_moments(signals, np.full(2, 1e-6), NONE, most=500)

    assert 50 < len(kept) <= 500


def test_very_short_signals():
    assert key_moments(np.zeros((1, 2)), np.ones(2), NONE).tolist() == [0]
    assert key_moments(np.zeros((2, 2)), np.ones(2), NONE).tolist() == [0, 1]
