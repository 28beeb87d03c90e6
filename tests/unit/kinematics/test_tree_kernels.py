"""The compiled walk over a tree agrees with a walk joint by joint."""

import numpy as np
import pytest
from arms import chain, machine, random_joints, slow_link_poses

NAMES = ("kuka_kr10_r1100_2", "ur10e", "staubli_tx2_90", "mill_xyzac_trunnion")


@pytest.mark.parametrize("name", NAMES)
def test_link_poses(name):
    k = machine(name)
    q = random_joints(k.joints, 20, seed=1)
    assert k.links(q) == pytest.approx(np.array([slow_link_poses(chain(name), row) for row in q]), abs=1e-13)


@pytest.mark.parametrize("name", NAMES)
def test_flange_is_one_of_the_links(name):
    k = machine(name)
    q = random_joints(k.joints, 5, seed=2)
    index = k.link_names.index(chain(name).flange)
    assert k.forward(q) == pytest.approx(k.links(q)[:, index], abs=1e-15)


def test_one_row_may_come_without_its_dimension():
    k = machine("gantry_xyz")
    assert k.forward([0.6, 0.4, -0.15])[0, :3, 3] == pytest.approx([0.6, 0.4, -0.15])


def test_columns_of_the_table_axes_are_zero():
    """Axes on the work side do not move the flange."""
    k = machine("mill_xyzac_trunnion")
    J = k.jacobian(random_joints(k.joints, 3, seed=3))
    assert np.all(J[:, :, 3:] == 0.0)
    assert J[0, :3, :3] == pytest.approx(np.eye(3))
