"""Cutting-force laws and their units."""

import pytest

from gcodesim.processes.constant_cut import chip_force
from gcodesim.processes.laws import Kienzle, LinearEdge

MM = 1e-3


def test_kienzle_counts_h_and_b_in_millimetres():
    law = Kienzle.from_table(1500.0, 0.25, normal_ratio=0.4, axial_ratio=0.1)
    ft, fn, fa = chip_force(law, width=2.0 * MM, chip=0.2 * MM)

    assert ft == pytest.approx(1500.0 * 2.0 * 0.2**0.75)
    assert (fn, fa) == pytest.approx((0.4 * ft, 0.1 * ft))
    assert law.specific_force(0.2 * MM) == pytest.approx(1500.0e6 * 0.2**-0.25)


def test_missing_ratios_are_the_documented_ones():
    ft, fn, fa = chip_force(Kienzle.from_table(1500.0, 0.25), width=MM, chip=MM)

    assert (fn / ft, fa) == pytest.approx((0.3, 0.0))


def test_linear_edge_adds_a_share_without_chip():
    law = LinearEdge.from_table(600.0, 12.0, 200.0, 8.0, 100.0, 2.0)

    assert chip_force(law, width=3.0 * MM, chip=0.1 * MM) == pytest.approx(
        (3.0 * (60.0 + 12.0), 3.0 * (20.0 + 8.0), 3.0 * (10.0 + 2.0))
    )
    assert chip_force(law, width=3.0 * MM, chip=0.0) == pytest.approx((36.0, 24.0, 6.0))


@pytest.mark.parametrize("law", [Kienzle.from_table(1500.0, 0.25), LinearEdge.from_table(600.0, 12.0, 200.0, 8.0)])
@pytest.mark.parametrize(("width", "chip"), [(0.0, 1e-4), (-1.0, 1e-4), (1e-3, -1e-9)])
def test_no_contact_no_force(law, width, chip):
    assert chip_force(law, width=width, chip=chip) == (0.0, 0.0, 0.0)


def test_kienzle_without_chip_is_zero():
    assert chip_force(Kienzle.from_table(1500.0, 0.25), width=1e-3, chip=0.0) == (0.0, 0.0, 0.0)
