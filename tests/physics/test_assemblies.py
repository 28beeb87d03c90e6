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


def test_beads_lie_on_the_whole_stock_once_and_it_is_told():
    cell = (CELL + PLATE + ", layers: [{height: 2, material: pvc}]}\n").replace(
        "tools:\n", "tools:\n  2: {type: extruder, bead_width: 4, bead_height: 2, flow: 100 mm^3/s, length: 40}\n"
    ) + "m_codes:\n  M10: {tool: activate}\n  M11: {tool: deactivate}\n"
    program = "G21 G90 G61\nT2 M6\nG43 H2\nG0 X-15 Y0\nG0 Z2\nM10\nG1 X15 F1200\nM11\nG0 Z40\nM2\n"
    ran = run_texts(program, cell)
    deposited = {name: stock.deposited / MM3 for name, stock in ran.results.stocks.items()}

    assert [f.code for f in ran.results.findings].count("GS931") == 1
    assert deposited["plate_layer_1"] == 0.0
    assert deposited["plate"] == pytest.approx(100.0 * 30.0 / 20.0, rel=0.02)
