"""Byte strings in two arrays do what a list of bytes objects does."""

import numpy as np
import pytest

from gcodesim.log.byte_strings import ByteStrings
from gcodesim.log.wire import chunk


@pytest.fixture
def strings() -> list[bytes]:
    rng = np.random.default_rng(4)
    return [rng.integers(0, 256, n, dtype=np.uint8).tobytes() for n in (3, 0, 127, 128, 1, 20_000, 0)]


def test_they_read_like_a_list(strings):
    made = ByteStrings.of(strings)
    assert list(made) == strings and len(made) == len(strings)
    assert made[-2] == strings[-2]
    assert made.sizes.tolist() == list(map(len, strings))
    assert list(made[2:5]) == strings[2:5]
    assert list(made[2:5][1:]) == strings[3:5]
    assert list(made[5:2]) == [] and list(ByteStrings.of([])) == []
    with pytest.raises(IndexError):
        made[len(strings)]


def test_rows_share_the_memory_of_their_matrix():
    matrix = np.arange(12, dtype=np.uint8).reshape(3, 4)
    rows = ByteStrings.rows(matrix)
    matrix[1, 0] = 99
    assert list(rows) == [bytes(row) for row in matrix]


def test_parts_are_joined_one_by_one(strings):
    made = ByteStrings.of(strings)
    places = np.array([0, 5, 1, 1, 3, 6, 2])
    joined = ByteStrings.joined([made, made.chosen(places), made[::]])
    assert list(joined) == [a + strings[i] + a for a, i in zip(strings, places, strict=True)]
    assert list(ByteStrings.joined([made[1:4], made[4:]])) == [strings[i] + strings[i + 3] for i in (1, 2, 3)]


def test_groups_are_mixed_into_one_order(strings):
    made = ByteStrings.of(strings)
    first, second = np.array([6, 0, 2]), np.array([1, 3, 4, 5])
    mixed = ByteStrings.mixed([(first, made.chosen(first)), (second, made[3:])])
    expected = {int(i): strings[i] for i in first} | dict(zip(second.tolist(), strings[3:], strict=True))
    assert list(mixed) == [expected[i] for i in range(7)]


def test_a_field_carries_its_length(strings):
    assert list(ByteStrings.of(strings).as_field(4)) == [chunk(4, string) for string in strings]
