"""Where the work stands, in closed form."""

from __future__ import annotations

import numpy as np
import pytest

from gcodesim.cell import place
from gcodesim.cell.placement import Placement
from tests.unit.cell.text import codes, loaded, sound

GANTRY = "machine: gantry_xyz\n"  # X 0 to 1200, Y 0 to 800, Z -400 to 0 mm


def g54(placement: Placement) -> list[float]:
    return [float(v) * 1e3 for v in placement.work_offsets[1].p]


@pytest.mark.parametrize(
    ("zero", "tools", "expected"),
    [
        # middle of travel (600, 400) less half the plate; top 100 mm below the tip of the 50 mm tool
        ("top-front-left", "{1: {type: drill, diameter: 5, length: 50}}", (550, 370, -150)),
        ("top-center", "{1: {type: drill, diameter: 5, length: 50}}", (600, 400, -150)),
        # zero at the bottom: the plate is 20 mm high
        ("bottom-front-left", "{1: {type: drill, diameter: 5, length: 50}}", (550, 370, -170)),
        # the holder counts, and so does the longest of several tools
        (
            "top-front-left",
            "{1: {type: drill, diameter: 5, length: 50, holder: {diameter: 4, length: 30}},"
            " 2: {type: drill, diameter: 5, length: 60}}",
            (550, 370, -180),
        ),
        ("top-front-left", "{}", (550, 370, -100)),
    ],
)
def test_stock_without_a_place_goes_to_mid_travel(zero: str, tools: str, expected: tuple[float, ...]) -> None:
    placement = place(sound(GANTRY + f"stock: {{box: [100, 60, 20], zero: {zero}}}\ntools: {tools}"))

    assert placement.automatic
    assert g54(placement) == pytest.approx(expected)
    np.testing.assert_allclose(placement.stocks["stock"].p * 1e3, expected)
    assert [f.code for f in placement.findings] == ["GS725"]
    assert placement.findings[0].span.line == 2


def test_a_short_z_travel_leaves_half_of_it() -> None:
    cell = sound(
        """
        machine:
          axes:
            X: {travel: [-100, 100 mm], speed: 1 m/min}
            Y: {travel: [-50, 150 mm], speed: 1 m/min}
            Z: {travel: [-80, -20 mm], speed: 1 m/min}
        stock: {min: [0, 0, -10], max: [40, 20, 5]}
        tools: {1: {type: drill, diameter: 2, length: 45}}
        """
    )

    # top of Z -20, tool 45, half of the 60 mm travel 30: top of the stock at -95, which is 5 above its zero
    assert g54(place(cell)) == pytest.approx([0 - 20, 50 - 10, -100])


def test_turned_stock_is_centred_as_it_stands() -> None:
    cell = sound(GANTRY + "stock: {box: [100, 60, 20], rpy: [0, 0, 90], xyz: [10, 0, 0]}\n")

    # turned by 90 deg the plate reaches from x -60 to 0, moved by 10; y 0 to 100; z 0 to 20
    assert g54(place(cell)) == pytest.approx([600 - (-50 + 10) / 2, 350, -120])


def test_given_offsets_rule_and_stock_without_in_stands_at_g54() -> None:
    cell = sound(
        GANTRY
        + "work_offsets: {G55: {xyz: [100, 200, -300]}, G54: {xyz: [1, 2, -3]}}\n"
        + "stock: {box: [1, 1, 1], xyz: [5, 0, 0]}"
    )
    placement = place(cell)

    assert not placement.automatic and placement.given == (1, 2) and placement.findings == ()
    assert g54(placement) == pytest.approx([1, 2, -3])
    np.testing.assert_allclose(placement.stocks["stock"].p, [0.006, 0.002, -0.003])
    parameters = placement.parameters()
    assert [parameters[n] for n in (5221, 5222, 5223, 5230, 5241, 5242, 5243, 5250, 5261)] == pytest.approx(
        [1, 2, -3, 0, 100, 200, -300, 0, 0]
    )


def test_a_system_that_nobody_names_is_at_machine_zero() -> None:
    placement = place(sound(GANTRY + "work_offsets: {G55: {xyz: [100, 0, 0]}}\nstock: {box: [1, 1, 1]}"))

    assert g54(placement) == [0, 0, 0]
    placement = place(sound(GANTRY + "stock: {box: [1, 1, 1], in: G54}"))
    assert g54(placement) == [0, 0, 0]
    assert [f.code for f in placement.findings] == ["GS725"]


def test_work_offsets_are_seen_from_the_machine() -> None:
    cell = sound(
        """
        machine: {model: gantry_xyz, base: {xyz: [2000, 0, 900], rpy: [0, 0, 90]}}
        frames: {vise: {in: machine, xyz: [300, 200, -250], rpy: [0, 0, 30]}}
        work_offsets: {G54: {in: vise, xyz: [10, 0, 0]}}
        stock: {box: [1, 1, 1], in: vise}
        fixtures: {jaw: {box: [1, 1, 1], in: G54, xyz: [0, 5, 0]}}
        """
    )
    placement = place(cell)

    turn = np.deg2rad(30)
    assert g54(placement) == pytest.approx([300 + 10 * np.cos(turn), 200 + 10 * np.sin(turn), -250])
    assert placement.parameters()[5230] == pytest.approx(30)
    np.testing.assert_allclose(placement.stocks["stock"].p, [2.0 - 0.2, 0.3, 0.65], atol=1e-12)
    jaw = placement.X_W("G54").inverse() @ placement.fixtures["jaw"]
    np.testing.assert_allclose(jaw.p, [0, 0.005, 0], atol=1e-12)


def test_a_tilted_system_on_a_machine_is_a_finding() -> None:
    placement = place(sound(GANTRY + "work_offsets: {G54: {rpy: [10, 0, 0]}}"))

    assert [f.code for f in placement.findings] == ["GS726"]
    assert "10 deg" in placement.findings[0].message


def test_on_an_arm_m_is_the_base() -> None:
    cell = sound(
        """
        frames: {table: {xyz: [650, 0, 400], rpy: [0, 0, 90]}}
        robots: {arm: {model: ur10e, base: {xyz: [100, 0, 0]}}}
        work_offsets: {G54: {in: table, xyz: [0, 0, 20]}}
        stock: {box: [100, 60, 20], in: table}
        """
    )
    placement = place(cell)

    np.testing.assert_allclose(placement.X_WM.matrix, cell.robots["arm"].X_WB.matrix)
    assert g54(placement) == pytest.approx([550, 0, 420])
    assert placement.parameters()[5230] == pytest.approx(90)
    np.testing.assert_allclose(placement.tool_axis(cell.channels["main"].orientation), [0, 0, -1], atol=1e-15)


def test_on_an_arm_m_follows_a_tilted_table() -> None:
    cell = sound(
        """
        frames: {table: {xyz: [650, 0, 400], rpy: [0, 30, 0]}}
        robots: {arm: {model: ur10e}}
        work_offsets: {G54: {in: table}, G55: {in: table, xyz: [100, 0, 0], rpy: [0, 0, 45]}}
        orientation: {tool_axis: -Z of G54}
        """
    )
    placement = place(cell)

    assert placement.findings == ()
    np.testing.assert_allclose(placement.X_WM.p, [0, 0, 0])
    np.testing.assert_allclose(placement.X_W("G54").matrix, cell.frames["table"].matrix, atol=1e-12)
    assert placement.parameters()[5250] == pytest.approx(45)
    tilt = np.deg2rad(30)
    np.testing.assert_allclose(
        placement.tool_axis(cell.channels["main"].orientation), [-np.sin(tilt), 0, -np.cos(tilt)], atol=1e-12
    )


def test_systems_of_an_arm_may_lean_against_each_other() -> None:
    cell = sound("robots: {arm: {model: ur10e}}\nwork_offsets: {G54: {rpy: [0, 30, 0]}, G55: {rpy: [0, 20, 0]}}")
    placement = place(cell)

    assert placement.findings == () and 1 not in placement.leaning and 2 in placement.leaning
    turn = np.deg2rad(-10)
    wanted = [[np.cos(turn), 0, np.sin(turn)], [0, 1, 0], [-np.sin(turn), 0, np.cos(turn)]]
    np.testing.assert_allclose(placement.work_offsets[2].R, wanted, atol=1e-12)
    assert placement.parameters()[5250] == 0.0


def test_stock_on_an_arm_needs_a_place() -> None:
    assert codes("robots: {arm: {model: ur10e}}\nstock: {box: [1, 1, 1]}") == ["GS724"]
    assert (
        codes("robots: {arm: {model: ur10e}}\nstock: {box: [1, 1, 1]}\nwork_offsets: {G54: {xyz: [600, 0, 300]}}") == []
    )
    assert codes("robots: {arm: {model: ur10e}}\nstock: {box: [1, 1, 1], in: world}") == []


def test_placing_does_not_change_the_cell() -> None:
    first = loaded(GANTRY + "stock: {box: [100, 60, 20]}").cell
    second = loaded(GANTRY + "stock: {box: [100, 60, 20]}").cell
    assert first is not None

    place(first)
    assert first == second


def test_additional_systems_of_fanuc_have_their_place_and_their_parameters() -> None:
    text = GANTRY + (
        "dialect: fanuc\nwork_offsets: {G54.1 P1: {xyz: [300, 200, -200]}, g54 p49: {xyz: [1, 2, 3]}}\n"
        "stock: {box: [10, 10, 10], zero: top-front-left, in: G54.1 P1}\n"
    )
    placement = place(sound(text))

    assert placement.given == (101, 149)
    np.testing.assert_allclose(placement.stocks["stock"].p * 1e3, (300, 200, -200))
    values = placement.parameters(placement.given)
    assert [values[n] for n in (7001, 7002, 7003, 14961)] == pytest.approx([300, 200, -200, 1])
    assert not any(7004 <= n < 7021 for n in values)


def test_additional_systems_are_fanucs() -> None:
    text = GANTRY + "dialect: linuxcnc\nwork_offsets: {G54.1 P1: {xyz: [300, 200, -200]}}\n"

    assert codes(text) == ["GS719"]
