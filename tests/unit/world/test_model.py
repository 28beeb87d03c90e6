"""The merged model: masses add up, text says what the chain says."""

from __future__ import annotations

from dataclasses import replace
from xml.etree import ElementTree as ET

import numpy as np
import pytest

from gcodesim.frames import Pose, rotation_from_rpy
from gcodesim.world.body import Box, ToolBody
from gcodesim.world.model import LEAST_MASS, MassSum, carried_masses, merged_model, tool_mass
from tests.unit.world import machines


def rod(a: np.ndarray, b: np.ndarray, mass: float, points: int = 4000) -> MassSum:
    """A thin rod as many points of mass, to compare sums with."""
    s = (np.arange(points) + 0.5) / points
    at = a + s[:, None] * (b - a)
    return MassSum.of([MassSum(mass=mass / points, com=p, inertia=np.zeros((3, 3))) for p in at])


def test_points_on_a_rod_have_the_inertia_of_a_rod() -> None:
    """m L²/12 about the middle, nothing about the rod itself."""
    body = rod(np.array([0.0, 0.0, 0.0]), np.array([0.6, 0.0, 0.0]), 2.0)

    assert body.com == pytest.approx([0.3, 0.0, 0.0])
    assert np.diag(body.inertia) == pytest.approx([0.0, 2.0 * 0.6**2 / 12.0, 2.0 * 0.6**2 / 12.0], abs=1e-7)


def test_a_sum_does_not_depend_on_where_it_is_taken() -> None:
    """Turning and moving all parts is turning and moving their sum."""
    parts = [tool_mass(machines.SPINDLE), rod(np.zeros(3), np.array([0.1, 0.2, 0.3]), 1.5, 50)]
    X = Pose(np.array([0.3, -0.2, 0.5]), rotation_from_rpy(0.4, -0.3, 1.1)).matrix

    moved = MassSum.of([part.seen_from(X) for part in parts])
    expected = MassSum.of(parts).seen_from(X)

    assert moved.mass == pytest.approx(expected.mass)
    assert moved.com == pytest.approx(expected.com)
    assert moved.inertia == pytest.approx(expected.inertia, abs=1e-12)


def test_principal_axes_give_the_inertia_back() -> None:
    body = tool_mass(machines.SPINDLE)
    moments, axes = body.principal()

    assert np.linalg.det(axes) == pytest.approx(1.0)
    assert axes @ np.diag(moments) @ axes.T == pytest.approx(body.inertia, abs=1e-15)


def test_the_model_has_one_link_a_driven_joint_and_the_mass_of_everything() -> None:
    chain = machines.machine("kr10")
    root = ET.fromstring(merged_model(chain, machines.SPINDLE, solids=False).text)

    assert [joint.get("name") for joint in root.iter("joint")] == [f"joint{i}" for i in range(6)]
    total = sum(float(mass.get("value", "")) for mass in root.iter("mass"))
    moving = sum(link.inertial.mass for link in chain.links[1:] if link.inertial)
    assert total == pytest.approx(moving + 3.0 + LEAST_MASS)
    assert root.find(".//collision") is None


def test_a_link_without_mass_gets_the_least_that_can_move() -> None:
    """Without it Bullet would make it 1 kg."""
    chain = machines.machine("router")
    bare = replace(chain, links=tuple(replace(link, inertial=None) for link in chain.links))
    assert all(mass.mass == 0.0 for mass in carried_masses(bare))

    root = ET.fromstring(merged_model(bare, None, solids=False).text)
    assert [float(mass.get("value", "")) for mass in root.iter("mass")] == [LEAST_MASS] * 4


def test_solids_of_the_tool_ride_on_the_flange() -> None:
    chain = machines.machine("kr10")
    tool = ToolBody(
        name="block", length=0.1, mass=1.0, shapes=(Box(size=(0.1, 0.2, 0.3), X=Pose.from_xyz_rpy((0.0, 0.0, 0.05))),)
    )
    model = merged_model(chain, tool, solids=True)
    origin = ET.fromstring(model.text).find("link[@name='link5']/collision/origin")

    assert origin is not None
    # the flange of this arm is 90 mm out along X of joint 6, and Z of F points along it
    assert [float(v) for v in origin.get("xyz", "").split()] == pytest.approx([0.09 + 0.05, 0.0, 0.0], abs=1e-12)
    assert model.p_LT == pytest.approx([0.09 + 0.1, 0.0, 0.0], abs=1e-12)
