"""Charts of a run, and thinning that keeps the peaks."""

import numpy as np
import pytest

from gcodesim.playback.quantities import QUANTITIES, charts_of, thinned
from tests.log_columns import read_columns


def test_every_quantity_of_a_milling_run_can_be_drawn(slot):
    for name in QUANTITIES:
        charts = charts_of(slot, [name])
        assert charts and all(len(curve.t_ns) == len(curve.values) > 100 for c in charts for curve in c.curves), name


def test_units_are_those_of_the_shop_floor(slot):
    (feed,) = charts_of(slot, ["feed"])
    logged = read_columns(slot.log.path, "/motion", ["feed_m_s"])["feed_m_s"]

    assert feed.unit == "mm/min"
    assert np.allclose(feed.curves[-1].values, logged * 60_000.0)


def test_a_single_peak_survives_thinning():
    rng = np.random.default_rng(5)
    t_ns = np.arange(50_000, dtype=np.int64) * 1_000_000
    values = rng.normal(size=50_000)
    values[31_234], values[12_001] = 90.0, -70.0

    few_t, few = thinned(t_ns, values, 200)

    assert len(few) <= 402 and few.max() == 90.0 and few.min() == -70.0
    assert few_t[0] == t_ns[0] and few_t[-1] == t_ns[-1] and (np.diff(few_t) > 0).all()
    assert few_t[few.argmax()] == t_ns[31_234]


def test_few_samples_stay_all(slot):
    (force,) = charts_of(slot, ["force"])
    curve = force.curves[0]

    assert np.array_equal(thinned(curve.t_ns, curve.values, len(curve.values))[1], curve.values)


def test_an_unknown_quantity_is_a_key_error(slot):
    with pytest.raises(KeyError):
        charts_of(slot, ["heat"])
