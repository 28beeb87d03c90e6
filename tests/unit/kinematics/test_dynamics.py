"""Inverse dynamics against pybullet, against a pendulum, against energy, against Jᵀ F."""

import math

import numpy as np
import pytest
from arms import chain, machine, random_joints

from gcodesim.kinematics import MODELS, Inertial, inverse_dynamics, load_urdf, shift_jacobian
from gcodesim.kinematics.dynamics import GRAVITY, bodies, merge

ROD = """<robot name="rod"><link name="a"/><link name="b"><inertial><origin xyz="0 0 -{l}"/><mass value="{m}"/>
<inertia ixx="{i}" iyy="{i}" izz="0.001" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="j" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 1 0"/>
<limit velocity="1" effort="1"/></joint></robot>"""


def moves(joints, count, seed):
    rng = np.random.default_rng(seed)
    q = random_joints(joints, count, seed)
    return q, rng.normal(size=q.shape), 3.0 * rng.normal(size=q.shape)


@pytest.mark.parametrize("name", ["kuka_kr10_r1100_2", "kuka_kr210_r2700_2", "ur10e", "gantry_xyz"])
def test_agrees_with_pybullet(name):
    p = pytest.importorskip("pybullet")
    q, qd, qdd = moves(machine(name).joints, 20, seed=13)
    client = p.connect(p.DIRECT)
    try:
        p.setGravity(*GRAVITY, physicsClientId=client)
        body = p.loadURDF(
            str(MODELS[name].path), useFixedBase=True, flags=p.URDF_USE_INERTIA_FROM_FILE, physicsClientId=client
        )
        reference = [
            p.calculateInverseDynamics(body, list(a), list(b), list(c), physicsClientId=client)
            for a, b, c in zip(q, qd, qdd, strict=True)
        ]
    finally:
        p.disconnect(client)
    efforts = inverse_dynamics(chain(name), q, qd, qdd)
    assert efforts == pytest.approx(np.array(reference), rel=1e-7, abs=1e-6)


def test_pendulum(tmp_path):
    """A rod turned by φ from hanging: (I + m l²) φ'' + m g l sin φ."""
    m, length, inertia = 2.0, 0.7, 0.05
    path = tmp_path / "rod.urdf"
    path.write_text(ROD.format(m=m, l=length, i=inertia))
    rod, _ = load_urdf(path)
    phi, rate = np.array([[0.0], [0.4], [2.0]]), np.array([[1.0], [-2.0], [0.5]])
    expected = (inertia + m * length**2) * rate + m * 9.80665 * length * np.sin(phi)
    assert inverse_dynamics(rod, phi, 7.0, rate) == pytest.approx(expected, abs=1e-12)


def test_power_is_the_change_of_energy():
    """Along a smooth motion τ·qd equals the rate of kinetic and potential energy, by central differences."""
    name, step = "kuka_kr10_r1100_2", 1e-5
    arm = chain(name)
    payload = Inertial(mass=3.0, com=np.array([0.01, 0.02, 0.1]), inertia=np.diag([0.01, 0.02, 0.015]))
    home, size, rate = np.array(MODELS[name].home), np.array([0.3, 0.2, 0.4, 0.5, 0.3, 0.6]), np.arange(1.0, 7.0)

    def at(t):
        phase = rate * t
        return home + size * np.sin(phase), size * rate * np.cos(phase), -size * rate**2 * np.sin(phase)

    def energy(t):
        """½ qdᵀ M qd, M qd being the efforts of the acceleration qd without speed or gravity; plus m g z."""
        q, qd, _ = at(t)
        kinetic = 0.5 * qd @ inverse_dynamics(arm, q, 0.0, qd, payload, gravity=(0, 0, 0))[0]
        frames = machine(name).links(q)[0]
        moved = [*((link.inertial, X) for link, X in zip(arm.links, frames, strict=True) if link.inertial)]
        moved.append((payload, machine(name).forward(q)[0]))
        return kinetic + sum(b.mass * 9.80665 * (X[:3, :3] @ b.com + X[:3, 3])[2] for b, X in moved)

    for t in (0.1, 0.7, 1.9):
        q, qd, qdd = at(t)
        power = float(qd @ inverse_dynamics(arm, q, qd, qdd, payload)[0])
        assert power == pytest.approx((energy(t + step) - energy(t - step)) / (2 * step), rel=1e-6, abs=1e-4)


@pytest.mark.parametrize("name", ["kuka_kr10_r1100_2", "mill_xyzac_trunnion"])
def test_wrench_at_the_tip_is_carried_by_its_jacobian(name):
    """Without motion and weight the drives hold −Jᵀ w of a wrench w on the tool."""
    k, p_FT = machine(name), np.array([0.05, -0.02, 0.2])
    q = random_joints(k.joints, 10, seed=14)
    wrench = np.random.default_rng(15).normal(size=(10, 6))
    J = shift_jacobian(k.jacobian(q), k.forward(q), p_FT)
    efforts = inverse_dynamics(chain(name), q, 0.0, 0.0, None, wrench, p_FT=p_FT, gravity=(0, 0, 0))
    assert efforts == pytest.approx(-np.einsum("nij,ni->nj", J, wrench), abs=1e-12)


def test_payload_hangs_at_the_flange():
    """A 10 kg point 0.2 m off the flange: the same as its weight as a wrench there."""
    k, arm = machine("kuka_kr10_r1100_2"), chain("kuka_kr10_r1100_2")
    q = random_joints(k.joints, 5, seed=16)
    payload = Inertial(mass=10.0, com=np.array([0.0, 0.0, 0.2]), inertia=np.zeros((3, 3)))
    weight = [0, 0, -10 * 9.80665, 0, 0, 0]
    carried = inverse_dynamics(arm, q, 0.0, 0.0, payload)
    pulled = inverse_dynamics(arm, q, 0.0, 0.0, None, np.array(weight), p_FT=(0, 0, 0.2))
    assert carried == pytest.approx(pulled, abs=1e-10)


def test_gravity_of_a_robot_that_hangs_from_the_ceiling():
    arm, q = chain("ur10e"), np.array(MODELS["ur10e"].home)
    upright, hanging = (inverse_dynamics(arm, q, 0.0, 0.0, gravity=(0, 0, g)) for g in (-9.8, 9.8))
    assert hanging == pytest.approx(-upright, abs=1e-12)


def test_gantry_lifts_its_quill():
    assert inverse_dynamics(chain("gantry_xyz"), np.zeros((1, 3)), 0.0, 0.0)[0] == pytest.approx(
        [0.0, 0.0, 20.0 * 9.80665]
    )


def test_gantry_pushes_all_that_moves():
    """120, 45 and 20 kg: X carries all, Y head and quill, Z the quill."""
    efforts = inverse_dynamics(chain("gantry_xyz"), np.zeros((1, 3)), 0.0, 1.0, gravity=(0, 0, 0))[0]
    assert efforts == pytest.approx([185.0, 65.0, 20.0])


def test_two_halves_make_one_rod():
    """Two rods of length l in line are one of 2 l: m (2 l)² / 12 about the middle."""
    half = Inertial(mass=1.0, com=np.zeros(3), inertia=np.diag([1 / 12, 1 / 12, 0.0]))
    low, high = np.eye(4), np.eye(4)
    low[2, 3], high[2, 3] = -0.5, 0.5
    whole = merge([(half, low), (half, high)])
    assert whole.mass == 2.0 and whole.com == pytest.approx([0, 0, 0])
    assert np.diag(whole.inertia) == pytest.approx([2 * 4 / 12, 2 * 4 / 12, 0.0])


def test_nothing_moves_without_mass():
    assert merge([]).mass == 0.0
    assert [b.mass for b in bodies(chain("gantry_xyz"))] == [120.0, 45.0, 20.0]
    assert math.isclose(
        bodies(chain("gantry_xyz"), Inertial(mass=5.0, com=np.zeros(3), inertia=np.eye(3)))[2].mass, 25.0
    )
