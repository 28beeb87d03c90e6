"""Bodies: tools of the cell as rigid bodies, robots with their limits."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gcodesim.solids import Cylinder
from gcodesim.tools.flat_end_mill import FlatEndMill
from gcodesim.tools.sections import Holder
from gcodesim.tools.tcp import Tcp
from gcodesim.world import RobotBody, tool_body
from tests.unit.world import machines


def test_a_cutter_becomes_solids_that_reach_from_flange_to_tip() -> None:
    tool = FlatEndMill(
        number=1, diameter=0.01, length=0.06, flute_length=0.03, holder=Holder(diameter=0.04, length=0.05)
    )
    body = tool_body(tool)

    assert body.name == "T1"
    assert body.length == pytest.approx(0.11)
    ends = sorted(
        (round(float(s.X.p[2]) + s.solid.bottom, 9), round(float(s.X.p[2]) + s.solid.top, 9))
        for s in body.solids
        if isinstance(s.solid, Cylinder)
    )
    assert ends == [(0.0, 0.05), (0.05, 0.08), (0.08, 0.11)]


def test_its_mass_is_that_of_steel_at_the_right_end() -> None:
    """One cylinder: its mass in the middle, moments of a solid cylinder."""
    body = tool_body(FlatEndMill(number=2, diameter=0.02, length=0.1))
    mass = 7850.0 * math.pi * 0.01**2 * 0.1

    assert body.mass == pytest.approx(mass)
    assert body.com == pytest.approx((0.0, 0.0, 0.05))
    assert body.inertia[2] == pytest.approx(mass * 0.01**2 / 2.0)
    assert body.inertia[0] == pytest.approx(mass * (0.01**2 / 4.0 + 0.1**2 / 12.0))


def test_limits_are_those_of_the_chain_unless_named() -> None:
    chain = machines.machine("router")

    assert RobotBody(chain=chain).effort_limit.tolist() == [5000.0] * 3
    assert RobotBody(chain=chain, effort=(1.0, np.inf, 3.0)).effort_limit.tolist() == [1.0, np.inf, 3.0]


@pytest.mark.parametrize("effort", [(1.0, 2.0), (1.0, -2.0, 3.0), (1.0, float("nan"), 3.0)])
def test_limits_that_cannot_be_are_refused(effort: tuple[float, ...]) -> None:
    with pytest.raises(ValueError, match="effort"):
        RobotBody(chain=machines.machine("router"), effort=effort)


def test_a_bent_tool_weighs_where_it_is() -> None:
    """A bar that points along X of the flange from 50 mm beside it: its middle lies 50 mm before its tip."""
    tcp = Tcp(xyz=(0.15, 0.0, 0.2), rpy=(0.0, 0.5 * np.pi, 0.0))
    straight = tool_body(FlatEndMill(number=2, diameter=0.02, length=0.1))
    body = tool_body(FlatEndMill(number=2, diameter=0.02, length=0.1, tcp=tcp))
    assert body.com == pytest.approx((0.1, 0.0, 0.2), abs=1e-12)
    xx, _, zz, *_ = straight.inertia
    assert body.mass == straight.mass
    assert body.inertia == pytest.approx((zz, xx, xx, 0.0, 0.0, 0.0), abs=1e-15)
    np.testing.assert_allclose(body.X_FT.p, [0.15, 0.0, 0.2])
