"""Rows of long tables a few at a time."""

from __future__ import annotations

import pytest

from gcodesim.arithmetic.batches import AT_ONCE, batches


@pytest.mark.parametrize("count", [0, 1, AT_ONCE, AT_ONCE + 1, 3 * AT_ONCE - 1])
def test_every_row_is_in_one_batch(count: int) -> None:
    rows = [row for some in batches(count) for row in range(some.start, some.stop)]
    assert rows == list(range(count))
