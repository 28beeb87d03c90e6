"""Products and inverses of small matrices against numpy's."""

from __future__ import annotations

import numpy as np
import pytest

from gcodesim.arithmetic import matrices
from gcodesim.arithmetic.turn_kernels import into_axes, wrench_from_axes
from gcodesim.frames import rotation_from_rpy

RANDOM = np.random.default_rng(3)
CLOSE = 1e-13


def test_products_are_those_of_numpy_for_stacks_and_single_ones() -> None:
    A, B, v = RANDOM.normal(size=(7, 4, 6)), RANDOM.normal(size=(7, 6, 3)), RANDOM.normal(size=(7, 6))
    assert np.allclose(matrices.multiplied(A, B), A @ B, atol=CLOSE)
    assert np.allclose(matrices.multiplied(A[0], B, B.transpose(0, 2, 1)), A[0] @ B @ B.transpose(0, 2, 1), atol=CLOSE)
    assert np.allclose(matrices.applied(A, v), np.einsum("nij,nj->ni", A, v), atol=CLOSE)
    assert np.allclose(matrices.applied(A[0], v), v @ A[0].T, atol=CLOSE)
    assert np.allclose(matrices.dots(v, v[0]), v @ v[0], atol=CLOSE)
    assert matrices.dot(v[0], v[1]) == pytest.approx(float(v[0] @ v[1]), abs=CLOSE)
    assert np.allclose(matrices.norms(v), np.linalg.norm(v, axis=1), atol=CLOSE)
    assert matrices.norm(v[2]) == pytest.approx(float(np.linalg.norm(v[2])), abs=CLOSE)


def test_a_product_adds_up_from_the_first_term_on() -> None:
    row, column = np.array([[1e16, 1.0, -1e16, 1.0]]), np.ones((4, 1))
    assert matrices.multiplied(row, column)[0, 0] == ((1e16 + 1.0) - 1e16) + 1.0
    assert matrices.dot(row[0], column[:, 0]) == matrices.applied(row, column[:, 0])[0] == 1.0


def test_many_products_have_the_bits_of_few() -> None:
    A, B = RANDOM.normal(size=(matrices.MANY + 1, 6, 4)), RANDOM.normal(size=(matrices.MANY + 1, 4, 6))
    many = matrices.multiplied(A, B)
    assert np.array_equal(many[:9], matrices.multiplied(A[:9], B[:9]))
    turned = np.ascontiguousarray(B.transpose(0, 2, 1)).transpose(0, 2, 1)
    assert np.array_equal(many, matrices.multiplied(A, turned))
    assert np.array_equal(matrices.multiplied(A, B[0])[:9], matrices.multiplied(A[:9], B[0]))


def test_inverses() -> None:
    X = np.tile(np.eye(4), (5, 1, 1))
    X[:, :3, :3] = [rotation_from_rpy(*RANDOM.normal(size=3)) for _ in range(5)]
    X[:, :3, 3] = RANDOM.normal(size=(5, 3))
    assert np.allclose(matrices.inverse_pose(X), np.linalg.inv(X), atol=CLOSE)
    A, b = RANDOM.normal(size=(6, 6)), RANDOM.normal(size=6)
    A[0, 0] = 0.0  # takes a pivot from below
    assert np.allclose(matrices.solution(A, b), np.linalg.solve(A, b), atol=1e-11)
    stack, right = RANDOM.normal(size=(9, 3, 3)), RANDOM.normal(size=(9, 3))
    assert np.allclose(np.einsum("nij,nj->ni", stack, matrices.space_solutions(stack, right)), right, atol=1e-11)
    assert matrices.determinant(A[:3, :3]) == pytest.approx(float(np.linalg.det(A[:3, :3])), abs=CLOSE)
    parallel = np.array([[1.0, 1.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, -1.0]])
    for J in (RANDOM.normal(size=(3, 5)), RANDOM.normal(size=(3, 2)), parallel):
        assert np.allclose(matrices.least_inverse(J), np.linalg.pinv(J), atol=1e-11)


@pytest.mark.parametrize("A", [np.diag([3.0, 1.0, 2.0]), np.eye(3), np.zeros((3, 3)), np.ones((3, 3)), None])
def test_principal_axes(A: np.ndarray | None) -> None:
    if A is None:
        half = RANDOM.normal(size=(3, 3)) * [1.0, 1e-3, 1e-5]
        A = half.T @ half
    values, axes = matrices.principal_axes(A)
    assert np.allclose(values, np.linalg.eigvalsh(A), atol=CLOSE)
    assert np.allclose(axes @ np.diag(values) @ axes.T, A, atol=CLOSE) and np.allclose(axes.T @ axes, np.eye(3))


def test_least_gains_are_the_smallest_singular_values_also_of_singular_matrices() -> None:
    A = RANDOM.normal(size=(4, 6, 6))
    A[1, :, 3] = A[1, :, 2]
    A[2, :, 0] *= 1e-9
    for stack in (A, A[:, :3], A[:, :, :4]):
        wanted = np.linalg.svd(stack, compute_uv=False)[:, -1]
        assert np.allclose(matrices.least_gains(stack), wanted, rtol=1e-9, atol=1e-15)
    assert matrices.least_gains(A[0]).shape == ()


@pytest.mark.parametrize("shape", [(6, 6), (3, 6), (6, 4), (6, 1)])
def test_least_gains_have_the_same_bits_for_many_as_for_one(shape: tuple[int, int]) -> None:
    A = RANDOM.normal(size=(matrices.FEW + 20, *shape))
    A[1], A[2, 1] = 0.0, A[2, 0]
    with np.errstate(over="ignore"):  # of a turn that is nearly none
        each = np.concatenate([matrices.least_gains(one[None]) for one in A])
    assert matrices.least_gains(A).tobytes() == each.tobytes()


def test_turns_of_one_step() -> None:
    X, w = np.eye(4), RANDOM.normal(size=6)
    X[:3, :3] = R = rotation_from_rpy(0.3, -0.4, 2.0)
    seen, out = np.empty((2, 3)), np.empty(6)
    into_axes(X, w[:3].copy(), w[3:].copy(), seen)
    wrench_from_axes(X, w, out)
    assert np.allclose(seen, [w[:3] @ R, w[3:] @ R]) and np.allclose(out, [*(R @ w[:3]), *(R @ w[3:])])
