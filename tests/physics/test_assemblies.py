"""Stock of several materials or parts: volumes by geometry, forces as those of the parts alone or of one piece."""

import math

import numpy as np
import pytest

from gcodesim.arithmetic.matrices import norms
from gcodesim.material.embedded import take_out
from gcodesim.material.lattice import ensure_lattice
from gcodesim.material.lattice_surface import volume_inside
from gcodesim.material.stock import Stock
from gcodesim.solids import Cylinder, room_of
from gcodesim.units import MM, MM3
from tests.physics.runs import run_texts

CELL = """
gcodesim: 1
machine: gantry_xyz
work_offsets: {G54: {xyz: [400, 300, -300]}}
tools:
  1: {type: flat_end_mill, diameter: 8, flutes: 3, length: 60}
stock:
"""
PLATE = "  plate: {min: [-20, -15, -10], max: [20, 15, 0], in: G54, material: al6082_t6, resolution: 0.2"
SCREW = "  screw: {cylinder: [6, 12], zero: top-center, xyz: [0, 0, 2], inside: plate, resolution: 0.1, material: "
BORE = "G21 G90 G17 G94 G61\nT1 M6\nG43 H1\nS6000 M3\nG0 X0 Y0\nG0 Z5\nG1 Z-8 F60\nG1 Z5 F600\nM5\nM2\n"
SLOT = "G21 G90 G17 G94 G61\nT1 M6\nG43 H1\nS6000 M3\nG0 X-30 Y0\nG0 Z-4\nG1 X30 F600\nG0 Z20\nM5\nM2\n"


def removed(ran):
    return {name: stock.removed / MM3 for name, stock in ran.results.stocks.items()}


def force(ran):
    return max(tool["max_force_N"] for tool in ran.results.tools)


def test_a_screw_is_bored_out_of_a_plate():
    ran = run_texts(BORE, CELL + PLATE + "}\n" + SCREW + "c45}\n")
    own = removed(ran)

    assert ran.misuse == []
    assert own["screw"] == pytest.approx(math.pi * 9.0 * 10.0, rel=2e-3)
    assert own["plate"] == pytest.approx(math.pi * (16.0 - 9.0) * 8.0, rel=0.03)
    assert ran.results.stocks["plate"].as_json()["max_force_N"] > 0.0


@pytest.mark.parametrize("program", [BORE, SLOT.replace("G1 X30", "G1 X10")])  # which leaves a layer whole
def test_parts_of_one_material_are_cut_like_one_piece(program):
    """The force of an edge is that of the material where it is, so that parts add up to the whole."""
    whole = run_texts(program, CELL + PLATE + "}\n")
    parts = run_texts(program, CELL + PLATE + ", layers: [{height: 3, material: al6082_t6}]}\n")
    (one,) = removed(whole).values()

    assert set(removed(parts)) == {"plate", "plate_layer_1"}
    assert sum(removed(parts).values()) == pytest.approx(one, rel=1e-3)
    assert force(parts) == pytest.approx(force(whole), rel=0.01)


def test_each_layer_has_the_force_of_its_material():
    soft, hard = "tz_al_cast", "c45"
    layered = run_texts(SLOT, CELL + PLATE + f", layers: [{{height: 2, material: {hard}}}]}}\n")
    alone = {
        name: run_texts(SLOT, CELL + f"  {name}: {{min: [-20, -15, {low}], max: [20, 15, {high}], in: G54, "
                        f"material: {material}, resolution: 0.2}}\n")
        for name, low, high, material in (("plate_layer_1", -2, 0, hard), ("plate", -10, -2, "al6082_t6"))
    }  # fmt: skip
    for name, ran in alone.items():
        assert removed(layered)[name] == pytest.approx(removed(ran)[name], rel=1e-6)
        assert layered.results.stocks[name].force == pytest.approx(force(ran), rel=1e-3)
    assert soft != hard


def test_what_is_taken_out_is_out_of_columns_in_all_directions():
    stock = Stock.box((-0.02, -0.015, -0.01), (0.02, 0.015, 0.0), 0.25 * MM)
    room = room_of(Cylinder(radius=4.0 * MM, bottom=-6.0 * MM, top=1.0 * MM))
    taken = take_out(stock, room.points, room.faces)
    lattice = ensure_lattice(stock)

    assert taken / MM3 == pytest.approx(math.pi * 16.0 * 6.0, rel=0.015)  # columns of 0.25 mm
    assert stock.intervals_at(0.0, 0.0) == [(-0.01, pytest.approx(-0.006))]
    assert volume_inside(stock) == pytest.approx(stock.volume, rel=2e-3)
    along_x = lattice.fields[0].columns
    assert int(along_x.number.max()) == 2


def test_the_room_of_a_cylinder_has_its_volume():
    room = room_of(Cylinder(radius=3.0, bottom=-1.0, top=4.0))
    a, b, c = (room.points[room.faces[:, k]] for k in range(3))
    assert float(np.sum(a * np.cross(b, c)) / 6.0) == pytest.approx(math.pi * 9.0 * 5.0, rel=1e-12)
    assert norms(room.points[:, :2]).max() < 3.001


def test_a_part_beside_its_stock_is_told():
    ran = run_texts(BORE, CELL + PLATE + "}\n" + SCREW.replace("[0, 0, 2]", "[60, 0, 2]") + "c45}\n")
    assert [code for code, _ in ran.misuse] == ["GS413"]


LASER = (
    "  4: {type: laser, power: 400 W, diameter: 1.5, length: 60, absorptivity: 0.5}\n"
    "  5: {type: jet, diameter: 2, removal_rate: 30 mm^3/s, length: 60}\n"
)
BEAM = "G21 G90 G61\nT{tool} M6\nG43 H{tool}\nG0 X-15 Y1.3\nG0 Z0\nM62 P0\nG1 X15 F600\nM63 P0\nG0 Z20\nM2\n"


def beamed(stock, tool=4, program=BEAM):
    cell = (CELL + stock).replace("tools:\n", "tools:\n" + LASER) + "signals: {beam: {word: M62 P0}}\n"
    return run_texts(program.format(tool=tool), cell)


def doses(ran):
    return sum(dose["total"] for stock in ran.results.stocks.values() for dose in stock.as_json()["doses"].values())


@pytest.mark.parametrize("tool", [4, 5])
def test_a_beam_takes_of_layers_of_one_material_what_it_takes_of_one_piece(tool):
    whole = beamed(PLATE + "}\n", tool)
    layers = ", layers: [{height: 0.05, material: al6082_t6}, {height: 0.1, material: al6082_t6}]}\n"
    parts = beamed(PLATE + layers, tool)

    (one,) = removed(whole).values()
    assert all(own > 0.0 for own in removed(parts).values())
    assert sum(removed(parts).values()) == pytest.approx(one, rel=1e-9)
    assert doses(parts) == pytest.approx(doses(whole), rel=2e-8)  # a layer that is thinner than 1e-12 m is gone
    assert parts.results.tools[0]["removed_mm3"] == pytest.approx(one, rel=1e-9)
    assert parts.misuse == []


def test_each_layer_takes_energy_by_its_own_material():
    """What melts is paid for: the sum of volumes, each with the energy of its material, is the absorbed energy."""
    from gcodesim.processes.materials import LIBRARY
    from gcodesim.processes.melting import melted

    ran = beamed(PLATE + ", layers: [{height: 0.1, material: c45}]}\n")
    landed = next(tool for tool in ran.results.tools if tool["number"] == 4)["landed_energy_J"]
    paid = {
        name: removed(ran)[name] * MM3 * melted(LIBRARY[stock.material]) for name, stock in ran.results.stocks.items()
    }

    assert min(paid.values()) > 0.05 * sum(paid.values())
    assert sum(paid.values()) == pytest.approx(0.5 * landed, rel=1e-6)


def test_a_layer_that_is_not_gone_shades_what_lies_below():
    """The jet goes 1.5 mm deep: 30 mm³/s over 2 mm x 10 mm/s."""
    ran = beamed(PLATE + ", layers: [{height: 3, material: al6082_t6}]}\n", 5)
    assert removed(ran)["plate"] == 0.0
    assert removed(ran)["plate_layer_1"] == pytest.approx(30.0 * 3.0, rel=1e-3)
    assert ran.results.stocks["plate"].as_json()["doses"]["wear"]["total"] == 0.0


def test_a_beam_goes_from_a_plate_into_what_stands_in_it():
    """Columns stand closer in the screw, so that the border of the plate and that of the screw leave gaps."""
    program = BEAM.replace("G0 X-15 Y1.3", "G0 X-15 Y0")
    whole = beamed(PLATE + "}\n", 5, program)
    parts = beamed(PLATE + "}\n" + SCREW.replace("[0, 0, 2]", "[0, 0, 0]") + "al6082_t6}\n", 5, program)

    (one,) = removed(whole).values()
    share = 6.0 / 30.0  # of the way over the screw
    assert sum(removed(parts).values()) == pytest.approx(one, rel=4e-3)
    assert removed(parts)["screw"] == pytest.approx(share * one, rel=0.05)


def printed(stock, program):
    cell = (CELL + stock).replace(
        "tools:\n", "tools:\n  2: {type: extruder, bead_width: 4, bead_height: 2, flow: 100 mm^3/s, length: 40}\n"
    ) + "m_codes:\n  M10: {tool: activate}\n  M11: {tool: deactivate}\n"
    return run_texts(program, cell)


LINE = "G21 G90 G61\nT2 M6\nG43 H2\nG0 X-15 Y0\nG0 Z2\nM10\nG1 X15 F1200\nM11\nG0 Z40\nM2\n"


@pytest.mark.parametrize("part", [", layers: [{height: 2, material: pvc}]}\n", "}\n" + SCREW + "c45}\n"])
def test_beads_lie_on_a_stock_with_all_that_stands_in_it(part):
    whole = printed(PLATE + "}\n", LINE)
    parts = printed(PLATE + part.replace("[0, 0, 2]", "[0, 0, 0]"), LINE)
    deposited = {name: stock.deposited / MM3 for name, stock in parts.results.stocks.items()}
    (one,) = (stock.deposited / MM3 for stock in whole.results.stocks.values())

    assert parts.misuse == whole.misuse
    assert deposited.pop("plate") == pytest.approx(one, rel=1e-6)
    assert set(deposited.values()) == {0.0}
    assert one == pytest.approx(100.0 * 30.0 / 20.0, rel=0.02)
    assert all(stock.removed == 0.0 for stock in parts.results.stocks.values())


def test_a_part_that_stands_up_is_in_the_way_of_a_bead():
    """Over a block that is as high as the nozzle and wider than the bead there is little room for it."""
    stands = SCREW.replace("cylinder: [6, 12], zero: top-center, xyz: [0, 0, 2]", "min: [0, -4, -3], max: [8, 4, 2]")
    hole = printed(PLATE + "}\n", LINE)
    ran = printed(PLATE + "}\n" + stands + "c45}\n", LINE)
    swollen = [next(t for t in each.results.tools if t["number"] == 2)["swollen_mm3"] for each in (hole, ran)]

    assert swollen[0] == pytest.approx(0.0, abs=0.5)
    assert swollen[1] > 10.0


LYING = "  pin: {cylinder: [4, 20], zero: center, xyz: [0, 0, -3], rpy: RPY, inside: plate, resolution: 0.2, material: "
TURNS = ("[90, 0, 0]", "[75, 0, 20]", "[60, 10, 0]")


@pytest.mark.parametrize("rpy", TURNS)
def test_a_beam_goes_from_a_plate_into_a_pin_that_lies_turned_in_it(rpy):
    """All of the pin is inside of the plate, whose lid over it is 1 mm thick; the jet goes 1.5 mm deep."""
    whole = beamed(PLATE + "}\n", 5)
    parts = beamed(PLATE + "}\n" + LYING.replace("RPY", rpy) + "al6082_t6}\n", 5)

    (one,) = removed(whole).values()
    assert [f.code for f in parts.results.findings if f.code != "GS402"] == []
    assert sum(removed(parts).values()) == pytest.approx(one, rel=2e-3)
    assert sum(parts.shop.stocks[name].stock.doses["wear"].max() > 0.0 for name in removed(parts)) == 2


def test_a_bead_lies_on_a_part_that_stands_turned():
    """A block turned about Z is level with its plate: the bead is as on one piece."""
    block = "  block: {box: [10, 10, 5], zero: top-center, xyz: [0, 0, 0], rpy: [0, 0, 30], inside: plate, "
    whole = printed(PLATE + "}\n", LINE)
    parts = printed(PLATE + "}\n" + block + "resolution: 0.2, material: c45}\n", LINE)
    deposited = {name: stock.deposited / MM3 for name, stock in parts.results.stocks.items()}
    (one,) = (stock.deposited / MM3 for stock in whole.results.stocks.values())

    assert parts.misuse == whole.misuse
    assert deposited == {"plate": pytest.approx(one, rel=1e-3), "block": 0.0}
    extruder = [next(t for t in ran.results.tools if t["number"] == 2) for ran in (whole, parts)]
    assert extruder[1]["swollen_mm3"] == pytest.approx(extruder[0]["swollen_mm3"], abs=1.0)


def test_a_pin_that_leans_through_a_plate_is_milled_away_to_a_depth():
    """What is left of it is what lies below the floor, half of it less 1 mm of height."""
    pin = "  pin: {cylinder: [2, 10], zero: center, xyz: [0, 0, -5], rpy: [30, 0, 0], inside: plate, resolution: 0.05, "
    ran = run_texts(SLOT, CELL + PLATE + "}\n" + pin + "material: al6082_t6}\n")
    exact = math.pi * (5.0 - 1.0 / math.cos(math.radians(30.0)))

    assert ran.misuse == []
    assert removed(ran)["pin"] == pytest.approx(exact, rel=0.01)
    whole = run_texts(SLOT, CELL + PLATE + "}\n")
    (one,) = removed(whole).values()
    assert sum(removed(ran).values()) == pytest.approx(one, rel=2e-3)


TRUNNION = """
gcodesim: 1
machine:
  axes:
    X: {travel: [-400, 400 mm], speed: 30 m/min, acceleration: 4 m/s^2}
    Y: {travel: [-400, 400 mm], speed: 30 m/min, acceleration: 4 m/s^2}
    Z: {travel: [-400, 400 mm], speed: 30 m/min, acceleration: 4 m/s^2, home: 250 mm}
    A: {travel: [-100, 100 deg], speed: 180 deg/s, acceleration: 900 deg/s^2, at: [0, 0, -100 mm]}
work_offsets: {G54: {xyz: [0, 0, -100 mm]}}
tools:
  1: {type: flat_end_mill, diameter: 8, flutes: 3, length: 60}
stock:
"""


def test_a_screw_that_leans_is_milled_out_along_its_axis():
    """The table turns until the screw stands upright; 15 of its 16 mm go, and a ring of the plate around it."""
    screw = (
        "  screw: {cylinder: [6, 16], zero: center, xyz: [0, 0, 0], rpy: [25, 0, 0], inside: plate, resolution: 0.1, "
    )
    program = (
        "G21 G90 G17 G94 G61\nT1 M6\nG43 H1\nS6000 M3\nG0 X0 Y0\nG0 A-25\nG0 Z12\nG1 Z-7 F60\nG1 Z12 F600\nM5\nM2\n"
    )
    ran = run_texts(program, TRUNNION + PLATE + "}\n" + screw + "material: c45}\n")

    assert ran.misuse == []
    assert removed(ran)["screw"] == pytest.approx(math.pi * 9.0 * 15.0, rel=2e-3)
    assert removed(ran)["plate"] == pytest.approx(math.pi * (16.0 - 9.0) * 7.0, rel=0.05)  # its top leans
