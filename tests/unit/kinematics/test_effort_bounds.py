"""Bounds on efforts: no motion needs more, and they are not so wide that they say nothing."""

import numpy as np
import pytest
from arms import chain, machine, random_joints

from gcodesim.kinematics import Inertial, inverse_dynamics
from gcodesim.kinematics.dynamics import GRAVITY
from gcodesim.kinematics.effort_bounds import ROUNDING, effort_bounds

TOOL = Inertial(mass=4.0, com=np.array([0.1, -0.05, 0.3]), inertia=np.diag([0.02, 0.03, 0.01]))


def greatest(bounds, qd, qdd):
    """What motions with the sizes of qd and qdd (n, j) need at most, in both directions (n, j) [N·m]."""
    turning = np.abs(qdd) @ bounds.inertia.T
    swinging = np.square(np.abs(qd).sum(axis=1))[:, None] * bounds.swing
    return ROUNDING * (np.linalg.norm(GRAVITY) * bounds.weight + turning + swinging)


@pytest.mark.parametrize("payload", [None, TOOL])
@pytest.mark.parametrize("name", ["kuka_kr10_r1100_2", "kuka_kr210_r2700_2", "ur10e"])
def test_no_motion_needs_more(name, payload):
    bounds, random = effort_bounds(chain(name), payload), np.random.default_rng(11)
    assert bounds is not None
    q = random_joints(machine(name).joints, 400, seed=8)
    for speed, change in ((0.0, 0.0), (3.0, 0.0), (0.0, 5.0), (2.0, 8.0)):
        qd, qdd = speed * random.normal(size=q.shape), change * random.normal(size=q.shape)
        needed = np.abs(inverse_dynamics(chain(name), q, qd, qdd, payload))
        assert (needed <= greatest(bounds, qd, qdd)).all()


def test_a_stretched_arm_comes_near_to_them():
    """An arm held out level bears nearly what the links laid end to end would weigh at its second joint."""
    q = random_joints(machine("ur10e").joints, 3000, seed=2)
    bounds = effort_bounds(chain("ur10e"), TOOL)
    assert bounds is not None
    needed = np.abs(inverse_dynamics(chain("ur10e"), q, 0.0, 0.0, TOOL))[:, 1].max()
    assert greatest(bounds, np.zeros((1, 6)), np.zeros((1, 6)))[0, 1] < 1.5 * needed


def test_links_that_grow_have_none():
    assert effort_bounds(chain("gantry_xyz"), None) is None
