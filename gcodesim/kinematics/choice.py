"""Which family a chain belongs to."""

from __future__ import annotations

from gcodesim.kinematics import KINEMATICS
from gcodesim.kinematics.chain import Chain
from gcodesim.kinematics.protocol import Kinematics


def kinematics_of(chain: Chain) -> Kinematics:
    """The closed form that recognises `chain`, else the numeric one, which takes any.

    Every family has a static method `of(chain)` that answers None for a chain
    that is not its own; families are asked by name, `serial` last.
    """
    for name in sorted(KINEMATICS, key=lambda n: (n == "serial", n)):
        found: Kinematics | None = KINEMATICS[name].of(chain)
        if found is not None:
            return found
    raise AssertionError("the serial family takes every chain")
