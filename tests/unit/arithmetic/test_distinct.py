"""Distinct values are those of numpy.unique, and cost no import of masked arrays."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest

from gcodesim.arithmetic.distinct import distinct


@pytest.mark.parametrize(
    "values",
    [
        np.array([], dtype=np.int64),
        np.array([7]),
        np.array([3, 1, 3, 2, 1]),
        np.array([[0.5, -1.0], [0.5, 0.25]]),
        np.random.default_rng(4).integers(0, 50, 1000),
        np.array([True, False, True]),
    ],
)
def test_as_numpy(values: np.ndarray) -> None:
    found = distinct(values)
    assert found.dtype == values.dtype
    np.testing.assert_array_equal(found, np.unique(values))


def test_no_masked_arrays() -> None:
    code = (
        "import sys, numpy as np; from gcodesim.arithmetic.distinct import distinct; "
        "distinct(np.array([2, 1])); print('numpy.ma' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"
