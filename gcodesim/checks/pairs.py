"""Which bodies are checked against which, by their roles."""

from __future__ import annotations

from collections.abc import Mapping
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


def keep_apart(one: Role, other: Role) -> bool:
    """Whether bodies of these roles that move against each other with a machine may not meet."""
    return frozenset((one, other)) in _APART


def may_not_meet(moving: Role, standing: Role) -> bool:
    """Whether it is a collision when a body of the one role enters one of the other."""
    return standing in AGAINST.get(moving, ())


def role_of_part(part: str) -> Role:
    """The role of a part of a tool."""
    return "holder" if part == "holder" else "tool"
