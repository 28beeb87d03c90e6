"""What nobody knows any more after a line that could not be executed."""

from __future__ import annotations

import re

from gcodesim.frozen import frozen

_CODE = re.compile(r"([gm])0*([0-9]+(?:\.[0-9])?)")


@frozen
class Doubt:
    """After a fault: whether the spindle is in doubt, and whether the line may have said any G code.

    `letters` are those of the faulty line, `codes` its G and M codes as far as they can be read (`g43`); `unit` [m] is
    in force behind it.
    """

    spindle: bool
    any_code: bool
    letters: frozenset[str]
    codes: frozenset[str]
    unit: float

    def may_say(self, *codes: str) -> bool:
        """Whether the line may have said one of these codes."""
        return self.any_code or not self.codes.isdisjoint(codes)


def codes_in(text: str) -> frozenset[str]:
    """`g1`, `m6` of a line in small letters without comments and blanks."""
    return frozenset(f"{letter}{number}" for letter, number in _CODE.findall(text))


__all__ = ["Doubt", "codes_in"]
