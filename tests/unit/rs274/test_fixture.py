"""G54.2: the zero of work on a rotary table goes along with the table, the axes of its system do not."""

from __future__ import annotations

import numpy as np
import pytest

from gcodesim.cell.tool_point import MachinePoint
from gcodesim.kinematics.cartesian import Axis, Cartesian, chain_of_axes
from gcodesim.kinematics.tool_point import ToolPoint

from .test_tool_point import trunnion

PLACED = ("G10 L21 P1 X30. Y0. Z5. A0. C0.", "G54 G54.2 P1")


def table(*rotary: Axis) -> MachinePoint:
    tool = ToolPoint.of(Cartesian(chain=chain_of_axes([*(Axis(letter=letter) for letter in "XYZ"), *rotary])))
    assert tool is not None
    return MachinePoint(tool)


@pytest.fixture
def fanuc(program):
    def run(*lines, **settings):
        given = {"has_cell": True, "tool_point": trunnion()} | settings
        return program("%\nO0001\n" + "\n".join(lines) + "\n%\n", dialect="fanuc", **given)

    return run


def test_a_table_that_turns_takes_the_tool_along(fanuc):
    done = fanuc(
        *PLACED, "G0 X0. Y0. Z0.", "C90.", "C180. X1.", "A90. C0. X0.", "G54.2 P0", "X0. Y0. Z0. A0. C0.", "M30"
    )

    ends = [end[:3] for end in done.ends]
    assert not done.errors
    # +C turns the work, as the table of a trunnion does; then A lays it down about X
    wanted = [[30, 0, 5], [0, 30, 5], [-29, 0, 5], [30, -5, 0], [0, 0, 0]]
    np.testing.assert_allclose(ends, wanted, atol=1e-9)


def test_offsets_count_from_the_angles_at_which_they_were_measured(fanuc):
    done = fanuc("G10 L21 P2 X0. Y30. Z0. C90.", "G54.2 P2", "G0 X0. Y0. Z0. C0.", "C90.", "C-90.", "M30")

    np.testing.assert_allclose([end[:2] for end in done.ends], [[30, 0], [0, 30], [0, -30]], atol=1e-9)


@pytest.mark.parametrize("seed", range(5))
def test_a_point_of_the_work_is_found_again_at_every_angle(fanuc, seed):
    """On a table whose axes lie anywhere, work in the closed form p = R(θ) R(θ0)⁻¹ f, with the zero on both axes."""
    random = np.random.default_rng(seed)
    middle = random.normal(0.0, 0.05, 3).round(6)
    law = table(Axis(letter="A", point=tuple(middle)), Axis(letter="C", point=tuple(middle)))
    f, (a0, c0) = random.normal(0.0, 30.0, 3).round(3), random.uniform(-90, 90, 2).round(3)
    angles = random.uniform(-100, 100, (4, 2)).round(3)
    moves = [f"G0 X0. Y0. Z0. A{a:.3f} C{c:.3f}" for a, c in angles]
    x, y, z = (1e3 * middle).tolist()
    stored = f"G10 L21 P8 X{f[0]:.3f} Y{f[1]:.3f} Z{f[2]:.3f} A{a0:.3f} C{c0:.3f}"
    done = fanuc(f"G10 L2 P1 X{x:.3f} Y{y:.3f} Z{z:.3f}", stored, "G54", "G54.2 P8", *moves, "M30", tool_point=law)

    def turned(a, c):
        (ca, sa), (cc, sc) = ((np.cos(v), np.sin(v)) for v in np.radians([a, c]))
        about_x = np.array([[1, 0, 0], [0, ca, -sa], [0, sa, ca]])
        return about_x @ np.array([[cc, -sc, 0], [sc, cc, 0], [0, 0, 1]])

    wanted = [1e3 * middle + turned(a, c) @ turned(a0, c0).T @ f for a, c in angles]
    np.testing.assert_allclose([end[:3] for end in done.ends], wanted, atol=1e-9)


def test_figures_positions_and_units_know_of_it(fanuc):
    done = fanuc(
        *PLACED,
        "G0 C90. X0. Y0. Z0.",
        "#1=#5001",
        "#2=#5500",
        "#3=#5503-4.",
        "G0 X#1 Y#2 Z#3",
        "G68 X0. Y0. R90.",
        "X10. Y0. Z0.",
        "G69",
        "G20",
        "X1. Y0. Z0.",
        "M30",
    )

    assert not done.errors
    np.testing.assert_allclose(
        [end[:3] for end in done.ends], [[0, 30, 5], [0, 31, 6], [0, 40, 5], [25.4, 30, 5]], atol=1e-9
    )


def test_the_axes_stay_when_it_begins_and_ends(fanuc):
    done = fanuc("G0 X5. Y6. Z7.", *PLACED, "G91 G0 X1.", "G54.2 P0", "Y1.", "M30")

    np.testing.assert_allclose([end[:3] for end in done.ends], [[5, 6, 7], [6, 6, 7], [6, 7, 7]], atol=1e-9)


@pytest.mark.parametrize(
    ("lines", "code"),
    [
        (("G54.2",), "GS105"),
        (("G54.2 P9",), "GS106"),
        (("G10 L21 P9 X1.",), "GS106"),
        (("G54.2 P1", "G43.4 H1"), "GS106"),
        (("G54.2 P1", "G68.2 I0. J10. K0."), "GS106"),
        (("G68.2 I0. J10. K0.", "G54.2 P1"), None),
        (("G68.2 I0. J10. K0.", "G53.1", "G54.2 P1"), "GS106"),
        (("#5501=3.",), "GS122"),
    ],
)
def test_what_does_not_go_is_said(fanuc, lines, code):
    done = fanuc("T1 M6", *lines, "M30")

    assert (code or "GS106") in {finding.code for finding in done.errors}


def test_without_a_table_whose_axes_have_a_place_nothing_is_guessed(fanuc):
    head = table(Axis(letter="B", point=(0, 0, 0.2), side="tool"))
    for law in (None, head):
        assert [f.code for f in fanuc(*PLACED, "G0 X0.", "M30", tool_point=law).errors] == ["GS915"]
    assert not fanuc(*PLACED, "G0 X0.", "M30", tool_point=None, has_cell=False).errors
