"""Elastic gears against a closed form and against statics."""

import numpy as np
import pytest

from gcodesim.kinematics import MODELS, compliance, kinematics_of, load_urdf, shift_jacobian
from gcodesim.units import DEG, MM


def at_tip(name, joints_deg, p_FT):
    k = kinematics_of(load_urdf(MODELS[name].path)[0])
    q = np.array([joints_deg]) * DEG
    X_BF = k.forward(q)
    return X_BF[0, :3, 3] + X_BF[0, :3, :3] @ p_FT, shift_jacobian(k.jacobian(q), X_BF, np.array(p_FT))


def test_static_deflection_of_the_small_arm():
    """V-DEF-01: dx = J K⁻¹ Jᵀ F of a KR 10 R1100-2 under 30 N forward and 50 N down."""
    tip, J = at_tip("kuka_kr10_r1100_2", [0, -90, 90, 0, 45, 0], [0, 0, 0.1])
    C = compliance(J, np.array([150e3, 140e3, 90e3, 30e3, 25e3, 15e3]))

    assert tip == pytest.approx([0.674350288, 0.0, 0.850649712], abs=1e-6)
    assert C[0, :3, :3] @ [30, 0, -50] == pytest.approx(
        np.array([0.098126486, 0.0, -0.43832202]) * MM, rel=1e-4, abs=1e-9
    )


def test_one_soft_joint_turns_the_tip_about_its_axis():
    """Only joint 1 gives way: a side force F at radius r moves the tip by F r² / k."""
    tip, J = at_tip("kuka_kr210_r2700_2", [0, -90, 90, 0, 90, 0], [0, 0, 0.2])
    C = compliance(J, np.array([1e6, np.inf, np.inf, np.inf, np.inf, np.inf]))

    assert C[0, 1, 1] == pytest.approx(tip[0] ** 2 / 1e6)
    assert C[0, 5, 5] == pytest.approx(1e-6)


def test_compliance_is_symmetric_and_stores_no_negative_energy():
    """Maxwell and Betti: the displacement at i under a load at j is that at j under i."""
    _, J = at_tip("ur10e", [10, -80, 90, -70, -60, 30], [0.02, 0.01, 0.15])
    C = compliance(J, np.array(MODELS["ur10e"].stiffness))[0]

    assert pytest.approx(C.T, abs=1e-20) == C
    assert np.linalg.eigvalsh(C).min() > -1e-18


def test_displacement_is_that_of_the_joints_that_give_way():
    """Joints turned by K⁻¹ Jᵀ w move the tip by C w, to second order."""
    name, p_FT = "kuka_kr10_r1100_2", np.array([0.03, 0.0, 0.15])
    k = kinematics_of(load_urdf(MODELS[name].path)[0])
    q, stiffness = np.array([[20, -70, 80, 15, 50, -10]]) * DEG, np.array(MODELS[name].stiffness)
    X = k.forward(q)
    J = shift_jacobian(k.jacobian(q), X, p_FT)
    wrench = 0.1 * np.array([20.0, -35.0, 60.0, 2.0, 1.0, -3.0])

    moved = k.forward(q + (J[0].T @ wrench) / stiffness)
    shift = (moved[0, :3, 3] + moved[0, :3, :3] @ p_FT) - (X[0, :3, 3] + X[0, :3, :3] @ p_FT)

    assert compliance(J, stiffness)[0, :3] @ wrench == pytest.approx(shift, rel=1e-3, abs=1e-9)


def test_a_rigid_machine_does_not_move():
    _, J = at_tip("kuka_kr10_r1100_2", [0, -90, 90, 0, 45, 0], [0, 0, 0.1])
    assert np.all(compliance(J, None) == 0.0)


def test_the_large_arm_is_as_stiff_as_its_class():
    """0.1 to 2 N/µm at the tip of an industrial arm; the KR 210 lies above the KR 10."""
    stiffness = {}
    for name in ("kuka_kr10_r1100_2", "kuka_kr210_r2700_2"):
        _, J = at_tip(name, [0, -90, 90, 0, 90, 0], [0, 0, 0.15])
        C = compliance(J, np.array(MODELS[name].stiffness))[0, :3, :3]
        stiffness[name] = 1.0 / np.linalg.eigvalsh(C).max() * 1e-6
    assert 0.1 < stiffness["kuka_kr10_r1100_2"] < stiffness["kuka_kr210_r2700_2"] < 2.0
