"""Which bodies are checked against which, by their roles."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping, Sequence
from typing import Final

from gcodesim.scene import Role

AGAINST: Final[Mapping[Role, frozenset[Role]]] = {
    "tool": frozenset(("fixture",)),
    "holder": frozenset(("fixture",)),
}

_APART: Final[frozenset[frozenset[Role]]] = frozenset(
    frozenset(pair)
    for pair in (
        ("link", "link"),
        ("link", "fixture"),
        ("link", "stock"),
        ("link", "tool"),
        ("link", "holder"),
        ("fixture", "fixture"),
        ("fixture", "stock"),
    )
)


def pairs_by_kind(kinds: Sequence[Hashable], meets: Callable[[int, int], bool]) -> list[tuple[int, int]]:
    """All (i, j), i < j, for which `meets` holds, in the order of j and then of i.

    It is asked once for each two kinds, so that thousands of fixtures, which all are of one kind, cost nothing among
    each other.
    """
    members: dict[Hashable, list[int]] = {}
    partners: dict[tuple[Hashable, Hashable], bool] = {}
    pairs: list[tuple[int, int]] = []
    for j, kind in enumerate(kinds):
        before: list[int] = []
        for other, those in members.items():
            if (other, kind) not in partners:
                partners[other, kind] = meets(those[0], j)
            if partners[other, kind]:
                before += those
        pairs += [(i, j) for i in sorted(before)]
        members.setdefault(kind, []).append(j)
    return pairs


def keep_apart(one: Role, other: Role) -> bool:
    """Whether bodies of these roles that move against each other with a machine may not meet."""
    return frozenset((one, other)) in _APART


def may_not_meet(moving: Role, standing: Role) -> bool:
    """Whether it is a collision when a body of the one role enters one of the other."""
    return standing in AGAINST.get(moving, ())


def role_of_part(part: str) -> Role:
    """The role of a part of a tool."""
    return "holder" if part == "holder" else "tool"
