"""The shipped machines stand where their makers say, and their files are what the script writes."""

import json
import runpy
from pathlib import Path

import numpy as np
import pytest
from arms import DATA, chain, machine, nose_on_table

from gcodesim.frames import quaternion_from_rotation
from gcodesim.kinematics import MODELS, model_path
from gcodesim.units import DEG

REFERENCES = json.loads((DATA / "reference_poses.json").read_text())
SCRIPT = Path(__file__).parents[3] / "scripts" / "make_models.py"


def test_every_model_has_reference_poses():
    assert sorted(REFERENCES) == sorted(MODELS)


@pytest.mark.parametrize("name", sorted(MODELS))
def test_reference_poses(name):
    """Position to 1e-6 m and orientation to 1e-6 rad against the published poses."""
    k = machine(name)
    angular = np.array([kind == "revolute" for kind in k.joints.kinds])
    for row in REFERENCES[name]:
        q = np.where(angular, np.array(row["joints"]) * DEG, row["joints"])
        X = nose_on_table(k, q)[0] if MODELS[name].kind == "machine" else k.forward(q)[0]
        assert X[:3, 3] == pytest.approx(row["position_m"], abs=1e-6)
        assert abs(quaternion_from_rotation(X[:3, :3]) @ row["quaternion_xyzw"]) == pytest.approx(1.0, abs=1e-9)


@pytest.mark.parametrize("name", sorted(MODELS))
def test_files_are_what_the_script_writes(name):
    written = {model.name: runpy_globals()["urdf"](model) for model in runpy_globals()["MODELS"]}
    assert model_path(name).read_text() == written[name]


def runpy_globals(cache={}):  # noqa: B006
    if not cache:
        cache.update(runpy.run_path(str(SCRIPT)))
    return cache


@pytest.mark.parametrize("name", sorted(MODELS))
def test_home_is_within_limits_and_points_down(name):
    k, home = machine(name), np.array(MODELS[name].home)
    assert np.all(home >= k.joints.lower) and np.all(home <= k.joints.upper)
    assert k.forward(home)[0, :3, 2] == pytest.approx([0, 0, -1], abs=1e-12)


@pytest.mark.parametrize("name", sorted(MODELS))
def test_links_have_bodies_that_can_be(name):
    """Masses above zero with inertias of real bodies: positive, and no moment above the sum of the other two."""
    tree = chain(name).tree
    for link, carrier in zip(chain(name).links, tree.carrier, strict=True):
        if link.name in ("flange", "tool0"):
            continue
        assert link.visuals and link.collisions, link.name
        if carrier >= 0:
            assert link.inertial.mass > 0.0
            moments = np.linalg.eigvalsh(link.inertial.inertia)
            assert moments[0] > 0.0 and moments[2] <= (moments[0] + moments[1]) * 1.01


def test_bodies_of_the_small_arm_weigh_what_its_maker_says():
    total = sum(link.inertial.mass for link in chain("kuka_kr10_r1100_2").links)
    assert total == pytest.approx(56.753, abs=1e-9)


def test_limits_come_in_si():
    joints = machine("kuka_kr10_r1100_2").joints
    assert joints.names == tuple(f"joint_{i}" for i in range(1, 7))
    assert joints.lower[1] == pytest.approx(-190 * DEG)
    assert joints.speed[5] == pytest.approx(433 * DEG)
    assert joints.acceleration == pytest.approx([10.065, 1.725, 2.686, 56.49, 49.23, 125.45])
    assert joints.effort[2] == 119.8
    assert not joints.assumed_acceleration.any()


def test_acceleration_that_nobody_names_is_full_speed_in_a_quarter_of_a_second():
    joints = machine("ur10e").joints
    assert joints.assumed_acceleration.all()
    assert joints.acceleration == pytest.approx(joints.speed / 0.25)


def test_effort_that_nobody_names_is_unlimited():
    assert np.isinf(machine("gantry_xyz").joints.effort).all()
    assert np.isinf(machine("fanuc_m20ia").joints.effort).all()


@pytest.mark.parametrize("name", sorted(MODELS))
def test_stiffness_is_given_with_its_source(name):
    model = MODELS[name]
    if model.kind == "machine":
        assert model.stiffness is None
    else:
        assert len(model.stiffness) == len(machine(name).joints)
        assert "estimate" in model.stiffness_source
