"""What every machine family promises, run over the whole table and over all shipped machines."""

import numpy as np
import pytest

from gcodesim.kinematics import KINEMATICS, MODELS, Axis, Status, chain_of_axes, kinematics_of, load_urdf


def chains():
    """All shipped models, and a machine tool from plain axes."""
    found = {name: load_urdf(model.path)[0] for name, model in MODELS.items()}
    found["own_mill"] = chain_of_axes(
        [*(Axis(letter=c, lower=-0.3, upper=0.3) for c in "XYZ"), Axis(letter="B", side="tool", point=(0, 0, 0.1))]
    )
    return found


CHAINS = chains()
# every variant with every chain that it takes
CASES = [
    (variant, name)
    for variant in KINEMATICS
    for name in sorted(CHAINS)
    if KINEMATICS[variant].of(CHAINS[name]) is not None
]


@pytest.fixture(params=CASES, ids=lambda case: "-".join(case), scope="module")
def k(request):
    variant, name = request.param
    return KINEMATICS[variant].of(CHAINS[name])


@pytest.fixture
def q(k):
    rng = np.random.default_rng(17)
    lower, upper = np.maximum(k.joints.lower, -np.pi), np.minimum(k.joints.upper, np.pi)
    middle, half = 0.5 * (lower + upper), 0.45 * (upper - lower)
    return middle + half * rng.uniform(-1, 1, (12, len(k.joints)))


def test_every_variant_takes_a_chain():
    assert sorted({variant for variant, _ in CASES}) == sorted(KINEMATICS)


def test_each_chain_has_its_family():
    for chain in CHAINS.values():
        assert kinematics_of(chain).joints.names == chain.driven_joints.names


def test_inverse_undoes_forward(k, q):
    X = k.forward(q)
    for row, pose in zip(q, X, strict=True):
        found, status = k.inverse(pose[None], row)
        assert status[0] in (Status.OK, Status.SINGULAR)
        assert k.forward(found)[0] == pytest.approx(pose, abs=1e-9)
        assert found[0] == pytest.approx(row, abs=1e-7)


def test_every_branch_is_a_solution(k, q):
    for pose in k.forward(q[:4]):
        branches = k.branches(pose)
        assert len(branches) >= 1
        assert k.forward(branches) == pytest.approx(np.broadcast_to(pose, (len(branches), 4, 4)), abs=1e-9)


def test_jacobian_is_the_derivative_of_forward(k, q):
    step = 1e-6
    J = k.jacobian(q)
    assert J.shape == (len(q), 6, len(k.joints))
    for i in range(len(k.joints)):
        d = np.zeros(len(k.joints))
        d[i] = step
        after, before = k.forward(q + d), k.forward(q - d)
        assert (after[:, :3, 3] - before[:, :3, 3]) / (2 * step) == pytest.approx(J[:, :3, i], abs=1e-8)
        spin = (after[:, :3, :3] - before[:, :3, :3]) / (2 * step) @ k.forward(q)[:, :3, :3].transpose(0, 2, 1)
        assert np.stack([spin[:, 2, 1], spin[:, 0, 2], spin[:, 1, 0]], axis=1) == pytest.approx(J[:, 3:, i], abs=1e-8)


def test_links_have_names_and_rigid_poses(k, q):
    X = k.links(q)
    assert X.shape == (len(q), len(k.link_names), 4, 4)
    assert X[..., :3, :3] @ X[..., :3, :3].swapaxes(-1, -2) == pytest.approx(
        np.broadcast_to(np.eye(3), (*X.shape[:2], 3, 3)), abs=1e-12
    )
    assert all(0 <= shape.link < len(k.link_names) for shape in k.link_shapes)
    assert k.links(np.zeros((1, len(k.joints))))[0, 0] == pytest.approx(np.eye(4))


def test_joint_arrays_have_one_order_and_length(k):
    joints = k.joints
    count = len(joints)
    arrays = (joints.lower, joints.upper, joints.speed, joints.acceleration, joints.effort, joints.assumed_acceleration)
    assert [len(a) for a in arrays] == [count] * 6 and len(joints.kinds) == count
    assert np.all(joints.lower < joints.upper) and np.all(joints.speed > 0) and np.all(joints.effort > 0)


def test_unreachable_pose_keeps_the_joints_and_has_a_reason(k, q):
    pose = k.forward(q[:1])
    pose[0, :3, 3] += 50.0
    found, status = k.inverse(pose, q[0])
    assert status[0] in (Status.REACH, Status.LIMIT)
    reason = k.reason(pose[0], q[0], status[0])
    assert reason.status == status[0] and reason.what and np.isfinite([reason.value, reason.limit]).all()
    if status[0] == Status.REACH:
        assert found[0] == pytest.approx(q[0])
        assert reason.value > reason.limit
    else:
        assert reason.joint is not None


def test_answers_repeat_bit_by_bit(k, q):
    X = k.forward(q)
    assert np.array_equal(k.inverse(X, q[0])[0], k.inverse(X, q[0])[0])
