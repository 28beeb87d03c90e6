"""G68.2 in all its forms, with drawn values, against rotations that are composed otherwise."""

from __future__ import annotations

from itertools import permutations

import numpy as np
import pytest

from gcodesim.frames import Array, rotation_about

UNIT = np.eye(3)


@pytest.fixture
def plane(program):
    def run(*lines: str) -> tuple[Array, Array]:
        """Zero (3,) [mm] and axes (3, 3) of the plane, from moves in it."""
        moves = ("G00 X0. Y0. Z0.", "G00 X100. Y0. Z0.", "G00 X0. Y100. Z0.", "G00 X0. Y0. Z100.")
        done = program("%\nO1\nG21 G90\n" + "\n".join([*lines, *moves, "M30"]) + "\n%\n", dialect="fanuc")
        assert not done.errors, [finding.message for finding in done.errors]
        zero, *ends = (np.array(end) for end in done.ends)
        return zero, np.column_stack([(end - zero) / 100.0 for end in ends])

    return run


def words(letters: str, values: Array) -> str:
    return " ".join(f"{letter.upper()}{value:.3f}" for letter, value in zip(letters, values, strict=True))


def drawn(seed: int, *most: float) -> Array:
    return (np.random.default_rng(seed).uniform(-1.0, 1.0, len(most)) * np.array(most)).round(3)


@pytest.mark.parametrize("seed", range(6))
def test_euler_angles_turn_about_z_then_the_new_x_then_the_new_z(plane, seed):
    zero, angles = drawn(seed, 50, 50, 50), drawn(seed + 100, 170, 170, 170)
    z0, R = plane(f"G68.2 {words('xyz', zero)} {words('ijk', angles)}")

    wanted = UNIT
    for axis, angle in ((2, angles[0]), (0, angles[1]), (2, angles[2])):  # each about an axis of the frame so far
        wanted = rotation_about(wanted[:, axis], np.radians(angle)) @ wanted
    np.testing.assert_allclose(R, wanted, atol=1e-7)
    np.testing.assert_allclose(z0, zero, atol=1e-9)


@pytest.mark.parametrize("order", ["".join(digits) for digits in permutations("123")])
def test_roll_pitch_and_yaw_turn_about_the_axes_of_the_work_in_any_order(plane, order):
    angles = drawn(int(order), 80, 80, 80)
    _, R = plane(f"G68.2 P1 Q{order} X0. Y0. Z0. {words('ijk', angles)}")

    wanted = UNIT
    for digit in order:
        axis = int(digit) - 1
        wanted = rotation_about(UNIT[axis], np.radians(angles[axis])) @ wanted
    np.testing.assert_allclose(R, wanted, atol=1e-7)


@pytest.mark.parametrize("seed", range(6))
def test_three_points_lie_in_their_plane(plane, seed):
    points = drawn(seed, *[40.0] * 9).reshape(3, 3)
    lines = [f"G68.2 P2 Q{k + 1} {words('xyz', point)}" for k, point in enumerate(points)]
    zero, R = plane("G68.2 P2 Q0 X0. Y0. Z0.", *lines)

    seen = (points - zero) @ R  # in the plane
    np.testing.assert_allclose(zero, points[0], atol=1e-9)
    np.testing.assert_allclose(seen[:, 2], 0.0, atol=1e-6)
    assert seen[1, 0] > 0 and seen[1, 1] == pytest.approx(0.0, abs=1e-6) and seen[2, 1] > 0
    np.testing.assert_allclose(R.T @ R, UNIT, atol=1e-9)
    assert np.linalg.det(R) == pytest.approx(1.0)


@pytest.mark.parametrize("seed", range(6))
def test_two_vectors_are_x_and_z(plane, seed):
    zero, x, z = drawn(seed, 40, 40, 40), drawn(seed + 50, 1, 1, 1), drawn(seed + 70, 1, 1, 1)
    first = f"G68.2 P3 Q1 {words('xyz', zero)} {words('ijk', x)}"
    z0, R = plane(first, f"G68.2 P3 Q2 {words('ijk', z)}")

    normal = z / np.linalg.norm(z)
    along = x - (x @ normal) * normal
    np.testing.assert_allclose(R[:, 2], normal, atol=1e-7)
    np.testing.assert_allclose(R[:, 0], along / np.linalg.norm(along), atol=1e-7)
    np.testing.assert_allclose(z0, zero, atol=1e-9)


@pytest.mark.parametrize("seed", range(6))
def test_projected_angles_are_seen_from_the_sides_of_the_work(plane, seed):
    """The plane holds X turned about Y by I and Y turned about X by J; K turns it about its normal."""
    i, j, k = drawn(seed, 70, 70, 170)
    _, R = plane(f"G68.2 P4 X0. Y0. Z0. I{i:.3f} J{j:.3f} K{k:.3f}")

    along = rotation_about(UNIT[1], np.radians(i)) @ UNIT[0]
    beside = rotation_about(UNIT[0], np.radians(j)) @ UNIT[1]
    assert R[:, 2] @ along == pytest.approx(0.0, abs=1e-7) and R[:, 2] @ beside == pytest.approx(0.0, abs=1e-7)
    assert R[2, 2] > 0.0
    np.testing.assert_allclose(R[:, 0], rotation_about(R[:, 2], np.radians(k)) @ along, atol=1e-7)
