"""What leaves a nozzle: what goes forward beyond what was drawn back."""

import numpy as np
import pytest

from gcodesim.motion.filament import beyond_retraction


@pytest.mark.parametrize(
    ("steps", "issued"),
    [
        ([1.0, 2.0], [1.0, 2.0]),
        ([1.0, -2.0, 2.0, 1.0], [1.0, 0.0, 0.0, 1.0]),  # retraction at rest
        ([1.0, -0.5, -1.5, 0.5, 3.0], [1.0, 0.0, 0.0, 0.0, 1.5]),  # the rest comes forward on the way
        ([-2.0, 2.5], [0.0, 0.5]),
        ([], []),
    ],
)
def test_what_was_drawn_back_comes_forward_first(steps, issued):
    np.testing.assert_allclose(beyond_retraction(1e-3 * np.array(steps)), 1e-3 * np.array(issued), atol=1e-15)


def test_all_that_leaves_is_the_greatest_sum_of_e():
    steps = np.random.default_rng(7).normal(0.1, 1.0, 5000) * 1e-3

    issued = beyond_retraction(steps)

    assert issued.sum() == pytest.approx(max(np.cumsum(steps).max(), 0.0), rel=1e-9)
    assert (issued >= 0.0).all() and (issued <= np.maximum(steps, 0.0) + 1e-12).all()
