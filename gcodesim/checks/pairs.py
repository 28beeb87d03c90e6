"""Which bodies are checked against which, by their roles."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from gcodesim.scene import Role

AGAINST: Final[Mapping[Role, frozenset[Role]]] = {
    "tool": frozenset(("fixture",)),
    "holder": frozenset(("fixture",)),
}


def may_not_meet(moving: Role, standing: Role) -> bool:
    """Whether it is a collision when a body of the one role enters one of the other."""
    return standing in AGAINST.get(moving, ())


def role_of_part(part: str) -> Role:
    """The role of a part of a tool."""
    return "holder" if part == "holder" else "tool"
