"""The merged model: masses add up, text says what the chain says."""

from __future__ import annotations

from dataclasses import replace
from xml.etree import ElementTree as ET

import numpy as np
import pytest

from gcodesim.world.body import ToolBody
from gcodesim.world.model import LEAST_MASS, merged_model, principal
from gcodesim.world.payload import payload_of
from tests.unit.world import machines


def test_principal_axes_give_the_inertia_back() -> None:
    body = payload_of(machines.SPINDLE)
    assert body is not None
    moments, axes = principal(body.inertia)

    assert np.linalg.det(axes) == pytest.approx(1.0)
    assert axes @ np.diag(moments) @ axes.T == pytest.approx(body.inertia, abs=1e-15)


def test_the_model_has_one_link_a_driven_joint_and_the_mass_of_everything() -> None:
    chain = machines.machine("kr10")
    root = ET.fromstring(merged_model(chain, machines.SPINDLE).text)

    assert [joint.get("name") for joint in root.iter("joint")] == [f"joint{i}" for i in range(6)]
    total = sum(float(mass.get("value", "")) for mass in root.iter("mass"))
    moving = sum(link.inertial.mass for link in chain.links[1:] if link.inertial)
    assert total == pytest.approx(moving + 3.0 + LEAST_MASS)
    assert root.find(".//collision") is None


def test_a_link_without_mass_gets_the_least_that_can_move() -> None:
    """Without it Bullet would make it 1 kg."""
    chain = machines.machine("router")
    bare = replace(chain, links=tuple(replace(link, inertial=None) for link in chain.links))

    root = ET.fromstring(merged_model(bare, None).text)
    assert [float(mass.get("value", "")) for mass in root.iter("mass")] == [LEAST_MASS] * 4


def test_the_tip_rides_on_the_flange() -> None:
    chain = machines.machine("kr10")
    model = merged_model(chain, ToolBody(name="block", length=0.1, mass=1.0))

    # the flange of this arm is 90 mm out along X of joint 6, and Z of F points along it
    assert model.carrier == 5
    assert model.p_LT == pytest.approx([0.09 + 0.1, 0.0, 0.0], abs=1e-12)
