"""Numeric cases of processes other than milling, deposited volume, and the removal programs cut by the process."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from gcodesim.material.stock import Stock
from gcodesim.processes.extrusion import Extrusion
from gcodesim.processes.milling import Milling
from gcodesim.processes.window import Window
from gcodesim.tools import TOOLS
from gcodesim.units import MM, MM3, MM_PER_MINUTE, UM
from tests.physics.process_formulas import bead_area, filament_length, jet_kerf, spray_stripe, suction_grip

DATA = Path(__file__).parents[1] / "data" / "physics"
CASES = {case["id"]: case for case in json.loads((DATA / "process.json").read_text())["cases"]}
PROGRAMS = {case["id"]: case for case in json.loads((DATA / "programs.json").read_text())["cases"]}


def additive_fdm(given):
    area = bead_area(given["extrusion_width_mm"] * MM, given["layer_height_mm"] * MM)
    volume = area * given["move_mm"] * MM
    length = filament_length(volume, given["filament_diameter_mm"] * MM)
    return {"bead_area_mm2": area / MM**2, "volume_mm3": volume / MM3, "E_mm": length / MM}


def spray_gaussian(given):
    stripe = spray_stripe(
        flow=given["paint_flow_ml_min"] * 1e-6 / 60.0,
        solids=given["solids_volume_fraction"],
        efficiency=given["transfer_efficiency"],
        speed=given["speed_mm_s"] * MM,
        sigma=given["sigma_mm"] * MM,
    )
    return {"centre_thickness_um": stripe.center_thickness / UM, "stripe_section_mm2": stripe.section / MM**2}


def remove_jet(given):
    kerf = jet_kerf(
        rate=given["removal_rate_mm3_s"] * MM3,
        width=given["kerf_width_mm"] * MM,
        feed=given["feed_mm_min"] * MM_PER_MINUTE,
        thickness=given["plate_thickness_mm"] * MM,
    )
    return {"depth_mm": kerf.depth / MM, "separation_feed_mm_min": kerf.separation_feed / MM_PER_MINUTE}


def grip_suction(given):
    grip = suction_grip(
        cups=given["cups"],
        diameter=given["cup_diameter_mm"] * MM,
        vacuum=given["vacuum_kPa"] * 1e3,
        mass=given["mass_kg"],
        gravity=given["g"],
    )
    return {"force_per_cup_N": grip.cup_force, "max_vertical_accel_m_s2": grip.vertical_acceleration}


MODELS = {
    "additive.fdm": additive_fdm,
    "spray.gaussian": spray_gaussian,
    "remove.jet": remove_jet,
    "grip.suction": grip_suction,
}
# motion and compliance have their own tests beside their packages
ELSEWHERE = {"motion.trapezoid", "motion.corner", "robot.compliance"}


def test_every_case_has_a_model_or_a_home():
    assert {case["model"] for case in CASES.values()} <= set(MODELS) | ELSEWHERE


@pytest.mark.parametrize("name", [name for name, case in CASES.items() if case["model"] not in ELSEWHERE])
def test_case(name):
    case = CASES[name]
    found = MODELS[case["model"]](case["inputs"])

    for quantity, wanted in case["expected"].items():
        assert found[quantity] == pytest.approx(wanted["value"], rel=wanted["rel"], abs=wanted["abs"]), quantity


# --- deposition ---------------------------------------------------------------------------------------------------


def path_window(points, *, dt, active, spindle=0.0):
    """One piece a step along `points` (n + 1, 3) [m]."""
    points = np.asarray(points, dtype=float)
    n = len(points) - 1
    return Window(
        piece_start=points[:-1],
        piece_end=points[1:],
        piece_step=np.arange(n),
        axis=np.tile([0.0, 0.0, 1.0], (n, 1)),
        velocity=np.diff(points, axis=0) / dt,
        rapid=np.zeros(n, dtype=bool),
        signals={
            "spindle": np.full(n, spindle),
            "active": np.broadcast_to(active, n).copy(),
            "flow": np.full(n, np.nan),
        },
        dt=dt,
    )


def line(a, b, steps):
    return np.asarray(a) + np.linspace(0.0, 1.0, steps + 1)[:, None] * (np.asarray(b) - np.asarray(a))


@pytest.mark.parametrize("steps", [1, 37, 400])
def test_deposited_volume_is_section_times_path(steps):
    """ID-14: within 0.5 % of bead area times length, whatever the step."""
    extruder = TOOLS["extruder"](bead_width=6.0 * MM, bead_height=3.0 * MM)
    stock = Stock.empty((0.0, 0.0, 0.0), (120e-3, 40e-3, 10e-3), 0.5e-3)
    process = Extrusion(extruder=extruder)
    window = path_window(line((10e-3, 20e-3, 3e-3), (110e-3, 20e-3, 3e-3), steps), dt=0.01, active=True)

    found = process.run(stock, window, process.begin())

    nominal = bead_area(6e-3, 3e-3) * 100e-3
    assert found["nominal"].sum() == pytest.approx(nominal, rel=1e-12)
    assert found["added"].sum() == pytest.approx(nominal, rel=5e-3)
    assert stock.volume == pytest.approx(found["added"].sum(), rel=1e-9)
    assert not found.wrench.any()


def test_nothing_is_laid_while_the_nozzle_is_off():
    extruder = TOOLS["extruder"](bead_width=6.0 * MM, bead_height=3.0 * MM)
    stock = Stock.empty((0.0, 0.0, 0.0), (120e-3, 40e-3, 10e-3), 0.5e-3)
    process = Extrusion(extruder=extruder)
    active = np.arange(100) >= 50
    window = path_window(line((10e-3, 20e-3, 3e-3), (110e-3, 20e-3, 3e-3), 100), dt=0.01, active=active)

    found = process.run(stock, window, process.begin())

    assert not found["added"][:50].any()
    assert not found["engaged"][:50].any()
    assert found["engaged"][50:].all()
    assert found["added"].sum() == pytest.approx(bead_area(6e-3, 3e-3) * 50e-3, rel=5e-3)


# --- removal programs, cut by the process ---------------------------------------------------------------------------


def program_path(name):
    """Tip positions of the program [m], written out by hand."""
    if name == "V-PRG-01":
        return np.vstack(
            [
                line((-15e-3, 25e-3, 10e-3), (-15e-3, 25e-3, -3e-3), 4),
                line((-15e-3, 25e-3, -3e-3), (95e-3, 25e-3, -3e-3), 600)[1:],
            ]
        )
    assert name == "V-PRG-02"
    angle = np.pi + np.linspace(0.0, 1.0, 601) * np.pi
    arc = np.column_stack([40e-3 + 20e-3 * np.cos(angle), 25e-3 + 20e-3 * np.sin(angle), np.full(601, -2e-3)])
    return np.vstack([line((20e-3, 25e-3, 5e-3), (20e-3, 25e-3, -2e-3), 40), arc[1:]])


def removed(name, resolution):
    given = PROGRAMS[name]["inputs"]
    tool = TOOLS["flat_end_mill"](diameter=given["tool"]["diameter_mm"] * MM)
    stock = Stock.box(np.array(given["stock"]["min_mm"]) * MM, np.array(given["stock"]["max_mm"]) * MM, resolution)
    process = Milling(cutter=tool)
    window = path_window(program_path(name), dt=0.02, active=False, spindle=5000.0 * 2.0 * math.pi / 60.0)
    found = process.run(stock, window, process.begin())
    assert not found.wrench.any()  # no material, no force
    return found["removed"].sum()


@pytest.mark.parametrize("name", PROGRAMS)
def test_program(name):
    wanted = PROGRAMS[name]["expected"]["removed_mm3"]
    diameter = PROGRAMS[name]["inputs"]["tool"]["diameter_mm"] * MM

    assert removed(name, diameter / 20.0) == pytest.approx(wanted["value"] * MM3, rel=wanted["rel"])
    assert removed(name, diameter / 60.0) == pytest.approx(wanted["value"] * MM3, rel=0.5 * wanted["rel"])
