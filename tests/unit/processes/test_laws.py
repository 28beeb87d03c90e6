"""Cutting-force laws and their units."""

import pytest

from gcodesim.processes.constant_cut import chip_force
from gcodesim.processes.laws import Kienzle, LinearEdge, rake_factor, with_rake
from gcodesim.processes.materials import LIBRARY, Material
from gcodesim.processes.milling import Milling
from gcodesim.processes.turning import Turning
from gcodesim.tools import TOOLS
from gcodesim.units import DEG

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


def test_a_degree_of_rake_is_a_per_cent_of_cutting_and_none_of_rubbing():
    steel, aluminium = Kienzle.from_table(2200.0, 0.24, 0.4, 0.1), LinearEdge.from_table(600.0, 12.0, 200.0, 8.0, 100.0)
    sharp, blunt = (with_rake(steel, rake * DEG, 6.0 * DEG) for rake in (16.0, -4.0))

    assert rake_factor(0.0, 12.0 * DEG) == pytest.approx(1.12)
    assert sharp.packed[:, 0] == pytest.approx(0.9 * steel.packed[:, 0])
    assert blunt.kc11 == pytest.approx(1.1 * steel.kc11) and blunt.mc == steel.mc
    other = with_rake(aluminium, 20.0 * DEG, 10.0 * DEG)
    assert (other.ktc, other.krc, other.kac) == pytest.approx([0.9 * k * 1e6 for k in (600.0, 200.0, 100.0)])
    assert (other.kte, other.kre) == (aluminium.kte, aluminium.kre)


def test_a_tool_and_a_table_that_both_say_their_rake_are_corrected():
    """Low-alloy steel of the Tabellenbuch holds for 6 degrees."""
    table, unsaid = LIBRARY["tz_low_alloy"], LIBRARY["42crmo4"]
    mill, insert = TOOLS["flat_end_mill"], TOOLS["turning_tool"]

    def law(material: Material, **more: float):
        return Milling.of(mill(diameter=6 * MM, **more), material).law

    assert law(table) is table.law and law(unsaid, rake=20.0 * DEG) is unsaid.law
    assert law(table, rake=16.0 * DEG).kc11 == pytest.approx(0.9 * table.law.kc11)
    turned = Turning.of(insert(nose_radius=0.4 * MM, rake=-4.0 * DEG), table)
    assert turned.law is not None and turned.law.kc11 == pytest.approx(1.1 * table.law.kc11)
