"""Alignment of two sequences: what belongs together is found again after insertions."""

from __future__ import annotations

import random

import pytest

from gcodesim.regress.align import align


def aligned(old: str, new: str) -> list[tuple[str, str]]:
    pairs = align(
        old,
        new,
        same=str.__eq__,
        keys=(lambda c: c, str.lower),
        unlikeness=lambda a, b: 0.3 if a.lower() == b.lower() else 2.0,
    )
    return [("" if a is None else old[a], "" if b is None else new[b]) for a, b in pairs]


@pytest.mark.parametrize(
    ("old", "new", "pairs"),
    [
        ("", "", []),
        ("abc", "abc", [("a", "a"), ("b", "b"), ("c", "c")]),
        ("ac", "abc", [("a", "a"), ("", "b"), ("c", "c")]),
        ("abc", "ac", [("a", "a"), ("b", ""), ("c", "c")]),
        ("abc", "aBc", [("a", "a"), ("b", "B"), ("c", "c")]),
        ("xyxyxy", "xyxyxyxy", [("x", "x"), ("y", "y")] * 3 + [("", "x"), ("", "y")]),
        ("abcd", "ab12cd", [("a", "a"), ("b", "b"), ("", "1"), ("", "2"), ("c", "c"), ("d", "d")]),
    ],
)
def test_known_pairs(old: str, new: str, pairs: list[tuple[str, str]]) -> None:
    assert aligned(old, new) == pairs


def test_every_item_stands_once_and_in_order() -> None:
    rng = random.Random(7)
    for _ in range(200):
        old = "".join(rng.choices("abcABCx", k=rng.randrange(12)))
        new = "".join(rng.choices("abcABCx", k=rng.randrange(12)))
        pairs = align(old, new, same=str.__eq__, keys=(str, str.lower), unlikeness=lambda a, b: 0.3 if a == b else 0.9)
        assert [a for a, _ in pairs if a is not None] == list(range(len(old)))
        assert [b for _, b in pairs if b is not None] == list(range(len(new)))


def test_a_long_sequence_takes_no_square_of_time() -> None:
    """Everything differs, nothing is unique: 20,000 items must not make a table of 400 million entries."""
    old, new = ["a"] * 20_000, ["b"] * 20_000
    pairs = align(old, new, same=lambda a, b: a == b, keys=(str,), unlikeness=lambda a, b: 0.5)
    assert pairs == [(i, i) for i in range(20_000)]


@pytest.mark.parametrize(("old", "new"), [(3, 40), (40, 3), (30, 30)])
def test_items_with_nothing_in_common_stay_alone(old: int, new: int) -> None:
    """Sums of the cost of a gap differ in their last bits from its multiples; the way back must not care."""
    pairs = align([0] * old, [1] * new, same=int.__eq__, keys=(str,), unlikeness=lambda a, b: 9.0)
    assert [a for a, _ in pairs if a is not None] == list(range(old))
    assert [b for _, b in pairs if b is not None] == list(range(new))
    assert not any(a is not None and b is not None for a, b in pairs)


def test_many_tables_are_bounded_together() -> None:
    """Anchors with stretches of 150 items between: likeness is asked for some of them, the others go by order."""
    asked = 0

    def unlikeness(a: str, b: str) -> float:
        nonlocal asked
        asked += 1
        return 0.5

    old = [item for i in range(100) for item in (f"anchor {i}", *["a"] * 150)]
    new = [item for i in range(100) for item in (f"anchor {i}", *["b"] * 150)]
    pairs = align(old, new, same=str.__eq__, keys=(str,), unlikeness=unlikeness)
    assert pairs == [(i, i) for i in range(len(old))] and asked < 700_000
