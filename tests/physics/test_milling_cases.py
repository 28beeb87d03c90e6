"""Numeric cases and identities of milling against the calculator, and the window kernel against the calculator."""

import itertools
import json
import math
from pathlib import Path

import numpy as np
import pytest

from gcodesim.material.stock import Stock
from gcodesim.processes.constant_cut import (
    ConstantCut,
    chip_force,
    end_mill_forces,
    handbook_power,
    instantaneous_forces,
    mean_chip_thickness,
    plunge_forces,
)
from gcodesim.processes.laws import Kienzle, LinearEdge
from gcodesim.processes.milling import Milling
from gcodesim.processes.window import Window
from gcodesim.tools import TOOLS
from gcodesim.units import DEG, MM, MM3, N_PER_MM2, RPM
from tests.tops import top_at

DATA = Path(__file__).parents[1] / "data" / "physics"
CASES = {case["id"]: case for case in json.loads((DATA / "milling.json").read_text())["cases"]}

STEEL = Kienzle.from_table(2500.0, 0.26)
ALUMINIUM = LinearEdge.from_table(631.0, 13.0, 99.0, 10.0, 273.0, 2.8)


def law_of(material):
    if "kc" in material:
        return Kienzle(
            kc11=material["kc"] * N_PER_MM2,
            mc=material["mc"],
            kn11=material.get("kn", 0.3 * material["kc"]) * N_PER_MM2,
            mn=material.get("mn", material["mc"]),
            ka11=material.get("ka", 0.0) * N_PER_MM2,
            ma=material.get("ma", material["mc"]),
        )
    names = ("Ktc", "Kte", "Krc", "Kre", "Kac", "Kae")
    return LinearEdge.from_table(*(material[name] for name in names))


def mill(diameter_mm=10.0, flutes=4, helix_deg=30.0, kind="flat_end_mill", **more):
    return TOOLS[kind](diameter=diameter_mm * MM, flutes=flutes, helix=helix_deg * DEG, **more)


def computed(case):
    """Quantities of a case, by the names of its expectations."""
    inputs = case["inputs"]
    law = law_of(inputs["material"])
    if case["model"] == "kienzle":
        kc = law.specific_force(inputs["h_mm"] * MM)
        fc, _, _ = chip_force(law, width=inputs["b_mm"] * MM, chip=inputs["h_mm"] * MM)
        return {"kc_N_mm2": kc / N_PER_MM2, "Fc_N": fc}
    tool = mill(inputs["tool"]["diameter_mm"], inputs["tool"]["teeth"], inputs["tool"]["helix_deg"])
    lead = inputs["tool"].get("lead_angle_deg", 90.0)
    lead_angle = None if lead == 90.0 else lead * DEG
    size = inputs["cut"]
    cut = ConstantCut(
        mode=size["mode"],
        ap=size["ap_mm"] * MM,
        ae=size["ae_mm"] * MM,
        feed_per_tooth=size["feed_per_tooth_mm"] * MM,
        spindle=size.get("spindle_rpm", 0.0) * RPM,
    )
    mean = end_mill_forces(tool, law, cut, lead_angle=lead_angle)
    found = {
        "mean_Fx_N": mean.force[0],
        "mean_Fy_N": mean.force[1],
        "mean_Fz_N": mean.force[2],
        "mean_torque_Nm": mean.torque,
        "mean_power_W": mean.power,
        "mrr_mm3_s": mean.mrr / MM3,
        "peak_Fx_N": mean.peak_force[0],
        "peak_Fy_N": mean.peak_force[1],
        "peak_Fz_N": mean.peak_force[2],
        "peak_F_N": mean.peak,
        "peak_torque_Nm": mean.peak_torque,
        "mean_chip_thickness_mm": mean_chip_thickness(tool, cut) / MM,
    }
    angles = inputs.get("theta_deg", [])
    for theta, force, torque in zip(
        angles, *instantaneous_forces(tool, law, cut, np.array(angles) * DEG, lead_angle), strict=True
    ):
        found |= {f"F{axis}_theta{theta:g}_N": force[i] for i, axis in enumerate("xyz")}
        found[f"torque_theta{theta:g}_Nm"] = torque
    return found


@pytest.mark.parametrize("name", CASES)
def test_case(name):
    found = computed(CASES[name])

    for quantity, wanted in CASES[name]["expected"].items():
        assert found[quantity] == pytest.approx(wanted["value"], rel=wanted["rel"], abs=wanted["abs"]), quantity


# --- identities -------------------------------------------------------------------------------------------------

CUTS = [
    ConstantCut(mode="slot", ap=5e-3, ae=10e-3, feed_per_tooth=0.05e-3, spindle=400.0),
    ConstantCut(mode="up", ap=4e-3, ae=3e-3, feed_per_tooth=0.06e-3, spindle=500.0),
    ConstantCut(mode="down", ap=2e-3, ae=7e-3, feed_per_tooth=0.1e-3, spindle=300.0),
]


@pytest.mark.parametrize("cut", CUTS, ids=lambda cut: cut.mode)
@pytest.mark.parametrize("law", [STEEL, ALUMINIUM], ids=["kienzle", "linear"])
def test_power_is_torque_times_speed(cut, law):
    """ID-01, for a cylinder: cutting velocity is the same everywhere, so power = mean of sum Ft times v_c."""
    tool = mill()
    mean = end_mill_forces(tool, law, cut, peaks=False)
    tangential = mean.torque / tool.radius

    assert mean.power == pytest.approx(tangential * tool.radius * cut.spindle, rel=1e-9)
    _, torques = instantaneous_forces(tool, law, cut, np.arange(720) * (2 * math.pi / 720))
    assert np.mean(torques) == pytest.approx(mean.torque, rel=1e-3)


@pytest.mark.parametrize("cut", CUTS, ids=lambda cut: cut.mode)
def test_linear_edge_power_is_removal_and_rubbing(cut):
    """ID-02: power = Ktc MRR + Kte N ap (phi_ex - phi_st) / 2 pi v_c."""
    tool = mill()
    start, end = cut.limits(tool.diameter)
    mean = end_mill_forces(tool, ALUMINIUM, cut, peaks=False)
    rubbing = ALUMINIUM.kte * tool.flutes * cut.ap * (end - start) / (2.0 * math.pi) * tool.radius * cut.spindle

    assert mean.power == pytest.approx(ALUMINIUM.ktc * mean.mrr + rubbing, rel=1e-6)


@pytest.mark.parametrize("cut", CUTS, ids=lambda cut: cut.mode)
def test_mean_does_not_depend_on_helix(cut):
    """ID-03, on the mean of instantaneous forces, which do."""
    angles = (np.arange(360) + 0.31) * (2.0 * math.pi / 360)
    straight, twisted = mill(helix_deg=0.0), mill(helix_deg=45.0)
    mean = end_mill_forces(straight, STEEL, cut, peaks=False).force
    turned = instantaneous_forces(twisted, STEEL, cut, angles)[0].mean(axis=0)

    assert end_mill_forces(twisted, STEEL, cut, peaks=False).force == pytest.approx(mean, rel=1e-12)
    assert turned == pytest.approx(mean, rel=1e-3, abs=1e-3 * np.linalg.norm(mean))


def test_slot_means_in_closed_form():
    """ID-04."""
    cut, tool, law = CUTS[0], mill(), ALUMINIUM
    n, c = tool.flutes * cut.ap, cut.feed_per_tooth
    mean = end_mill_forces(tool, law, cut, peaks=False).force

    assert mean[0] == pytest.approx(-n / 4 * law.krc * c - n / math.pi * law.kre, rel=1e-6)
    assert mean[1] == pytest.approx(n / 4 * law.ktc * c + n / math.pi * law.kte, rel=1e-6)
    assert mean[2] == pytest.approx(-n / math.pi * law.kac * c - n / 2 * law.kae, rel=1e-6)


@pytest.mark.parametrize("law", [STEEL, ALUMINIUM], ids=["kienzle", "linear"])
def test_up_and_down_mirror(law):
    """ID-05: tangential parts keep or change sign, radial parts the other way."""
    up = ConstantCut(mode="up", ap=4e-3, ae=3e-3, feed_per_tooth=0.06e-3, spindle=500.0)
    down = ConstantCut(mode="down", ap=4e-3, ae=3e-3, feed_per_tooth=0.06e-3, spindle=500.0)
    a, b = (end_mill_forces(mill(), law, cut, peaks=False) for cut in (up, down))

    assert (a.torque, a.power) == pytest.approx((b.torque, b.power), rel=1e-9)
    # only tangential and only radial forces, by laws with the other switched off
    packed = law.packed
    parts = []
    for keep in (0, 1):
        rows = np.where(np.arange(3)[:, None] == keep, packed, packed * [0.0, 1.0, 0.0])
        parts.append([end_mill_forces(mill(), Rows(rows), cut, peaks=False).force for cut in (up, down)])
    (t_up, t_down), (r_up, r_down) = parts
    assert t_up[0] == pytest.approx(-t_down[0], rel=1e-9)
    assert t_up[1] == pytest.approx(t_down[1], rel=1e-9)
    assert r_up[0] == pytest.approx(r_down[0], rel=1e-9)
    assert r_up[1] == pytest.approx(-r_down[1], rel=1e-9)


class Rows:
    """A law given by its rows."""

    def __init__(self, packed):
        self.packed = packed


@pytest.mark.parametrize("cut", CUTS, ids=lambda cut: cut.mode)
def test_handbook_power_is_an_upper_bound(cut):
    """ID-08: Jensen; equal for mc = 0."""
    assert end_mill_forces(mill(), STEEL, cut, peaks=False).power < handbook_power(STEEL, mill(), cut)
    flat = Kienzle.from_table(2000.0, 0.0)
    assert end_mill_forces(mill(), flat, cut, peaks=False).power == pytest.approx(
        handbook_power(flat, mill(), cut), rel=1e-9
    )


def test_nothing_gives_nothing():
    """ID-09: exactly zero, and only the edge force where the feed is zero."""
    for law in (STEEL, ALUMINIUM):
        for cut in (
            ConstantCut(mode="slot", ap=0.0, ae=10e-3, feed_per_tooth=0.05e-3, spindle=400.0),
            ConstantCut(mode="up", ap=5e-3, ae=0.0, feed_per_tooth=0.05e-3, spindle=400.0),
        ):
            nothing = end_mill_forces(mill(), law, cut)
            assert not nothing.force.any()
            assert (nothing.torque, nothing.power, nothing.mrr, nothing.peak) == (0.0, 0.0, 0.0, 0.0)
    rubbing = ConstantCut(mode="slot", ap=5e-3, ae=10e-3, feed_per_tooth=0.0, spindle=400.0)
    edge = Rows(ALUMINIUM.packed * [0.0, 1.0, 1.0])
    full = ConstantCut(mode="slot", ap=5e-3, ae=10e-3, feed_per_tooth=0.05e-3, spindle=400.0)
    assert end_mill_forces(mill(), ALUMINIUM, rubbing, peaks=False).force == pytest.approx(
        end_mill_forces(mill(), edge, full, peaks=False).force, rel=1e-12
    )
    assert not end_mill_forces(mill(), STEEL, rubbing, peaks=False).force.any()


def test_drilling_by_the_handbook():
    """Two lips of D / (2 sin sigma) at h = f_z sin sigma: torque from Ft at D/4, thrust from Fn sin sigma."""
    drill, f_z = mill(8.0, 2, 0.0, "drill", chisel_edge=0.0), 0.1e-3
    sigma = 59.0 * DEG
    ft, fn, _ = chip_force(STEEL, width=drill.diameter / (2.0 * math.sin(sigma)), chip=f_z * math.sin(sigma))

    found = plunge_forces(drill, STEEL, feed_per_rev=2.0 * f_z, spindle=200.0)

    assert found.torque == pytest.approx(2.0 * ft * drill.diameter / 4.0, rel=1e-9)
    assert found.force == pytest.approx([0.0, 0.0, 2.0 * fn * math.sin(sigma)], rel=1e-9)
    assert found.power == pytest.approx(200.0 * found.torque)
    assert found.mrr == pytest.approx(math.pi * 4e-3**2 * 0.2e-3 * 200.0 / (2.0 * math.pi))


# --- the window kernel, with the engagement read from a stock ----------------------------------------------------


def straight(start, end, *, feed, spindle, dt=0.004, compliance=None, rapid=False):
    """A window of equal steps along one line [m]."""
    start, end = np.array(start), np.array(end)
    length = np.linalg.norm(end - start)
    n = max(round(length / feed / dt), 1)
    points = start + np.linspace(0.0, 1.0, n + 1)[:, None] * (end - start)
    return Window(
        piece_start=points[:-1],
        piece_end=points[1:],
        piece_step=np.arange(n),
        axis=np.tile([0.0, 0.0, 1.0], (n, 1)),
        velocity=np.tile((end - start) / length * feed, (n, 1)),
        rapid=np.full(n, rapid),
        signals={"spindle": np.full(n, spindle), "active": np.zeros(n, dtype=bool)},
        dt=dt,
        compliance=None if compliance is None else np.tile(compliance, (n, 1, 1)),
    )


def run(tool, law, stock, window):
    process = Milling(cutter=tool, law=law)
    return process.run(stock, window, process.begin())


D = 10e-3
OMEGA = 400.0
CHIP = 0.05e-3


def feed_of(tool):
    return CHIP * tool.flutes * OMEGA / (2.0 * math.pi)


@pytest.mark.parametrize("cells", [12, 24, 48])
@pytest.mark.parametrize("law", [STEEL, ALUMINIUM], ids=["kienzle", "linear"])
@pytest.mark.parametrize("kind", ["flat_end_mill", "ball_end_mill", "bull_nose_end_mill"])
def test_slot_in_stock(kind, law, cells):
    """Mean force and torque within 2 % of the calculator, also at half the resolution."""
    tool = mill(kind=kind, **({"corner_radius": 2e-3} if kind == "bull_nose_end_mill" else {}))
    stock = Stock.box((0.0, 0.0, -20e-3), (30e-3, 20e-3, 0.0), D / cells)
    window = straight((8e-3, 10e-3, -3e-3), (16e-3, 10e-3, -3e-3), feed=feed_of(tool), spindle=OMEGA)
    stock.remove(np.array([[-6e-3, 10e-3, -3e-3]]), window.piece_start[:1], tool.cutting_shape)
    wanted = end_mill_forces(tool, law, ConstantCut(mode="slot", ap=3e-3, ae=D, feed_per_tooth=CHIP, spindle=OMEGA))

    found = run(tool, law, stock, window)

    late = slice(window.steps // 4, None)
    size = np.linalg.norm(wanted.force)
    assert found.wrench[late, :3].mean(axis=0) == pytest.approx(wanted.force, abs=0.02 * size)
    assert found["torque"][late].mean() == pytest.approx(wanted.torque, rel=0.02)
    assert found["power"][late].mean() == pytest.approx(wanted.power, rel=0.02)
    assert found["peak_force"][late].mean() == pytest.approx(wanted.peak, rel=0.05)
    assert found["peak_torque"][late].mean() == pytest.approx(wanted.peak_torque, rel=0.05)
    assert found["axial_depth"][late] == pytest.approx(3e-3, rel=0.01)
    assert found["chip_thickness"][late].mean() == pytest.approx(CHIP, rel=0.02) or kind == "ball_end_mill"
    assert found["removed"].sum() == pytest.approx(wanted.mrr * window.steps * window.dt, rel=0.3 / cells)


@pytest.mark.parametrize("phase", [0.0, 0.37])
@pytest.mark.parametrize("mode", ["up", "down"])
@pytest.mark.parametrize("law", [STEEL, ALUMINIUM], ids=["kienzle", "linear"])
def test_side_milling_in_stock(law, mode, phase):
    """30 % immersion within 5 % at D / 24, wherever the wall lies in the grid."""
    tool = mill(flutes=2)
    stock = Stock.box((0.0, -20e-3, -20e-3), (40e-3, 0.0, 0.0), D / 24)
    y = D / 2 - 3e-3 + phase * D / 24  # material on the right of a feed along +X
    ae = D / 2 - y
    ends = [(10e-3, y, -4e-3), (20e-3, y, -4e-3)]
    if mode == "up":
        ends.reverse()
    window = straight(*ends, feed=feed_of(tool), spindle=OMEGA)
    outside = np.array([[-10e-3 if mode == "down" else 50e-3, y, -4e-3]])
    stock.remove(outside, window.piece_start[:1], tool.cutting_shape)
    wanted = end_mill_forces(tool, law, ConstantCut(mode=mode, ap=4e-3, ae=ae, feed_per_tooth=CHIP, spindle=OMEGA))
    force = wanted.force * ([1.0, 1.0, 1.0] if mode == "down" else [-1.0, -1.0, 1.0])  # K turned into S

    found = run(tool, law, stock, window)

    late = slice(window.steps // 4, None)
    size = np.linalg.norm(force)
    assert found.wrench[late, :3].mean(axis=0) == pytest.approx(force, abs=0.05 * size)
    assert found["torque"][late].mean() == pytest.approx(wanted.torque, rel=0.05)
    assert found["radial_width"][late].mean() == pytest.approx(ae, rel=0.05)


@pytest.mark.parametrize(("cells", "off"), [(20, 4e-3), (40, 1e-4)])
@pytest.mark.parametrize("mode", ["up", "down"])
@pytest.mark.parametrize("law", [STEEL, ALUMINIUM], ids=["kienzle", "linear"])
def test_contact_ends_where_the_wall_is(law, mode, cells, off):
    """From 20 % immersion on within 0.4 % at D / 20 and 0.01 % at D / 40, wherever the wall lies between two angles."""
    tool = mill(flutes=2)
    for ae in (2e-3, 2.5e-3, 3.1e-3, 4e-3, 5e-3, 6.3e-3, 7.5e-3, 8e-3):
        stock = Stock.box((0.0, -20e-3, -20e-3), (40e-3, 0.0, 0.0), D / cells)
        ends = [(10e-3, D / 2 - ae, -4e-3), (11e-3, D / 2 - ae, -4e-3)]
        window = straight(*(ends if mode == "down" else ends[::-1]), feed=feed_of(tool), spindle=OMEGA, dt=0.001)
        state = Milling(cutter=tool, law=law).begin()
        state.values[2] = 2.0  # free: it stands in the cut that it has made
        found = Milling(cutter=tool, law=law).run(stock, window, state)
        wanted = end_mill_forces(tool, law, ConstantCut(mode=mode, ap=4e-3, ae=ae, feed_per_tooth=CHIP, spindle=OMEGA))
        force = wanted.force * ([1.0, 1.0, 1.0] if mode == "down" else [-1.0, -1.0, 1.0])
        size = np.linalg.norm(force)

        assert found.wrench[0, :3] == pytest.approx(force, abs=off * size)
        assert found["torque"][0] == pytest.approx(wanted.torque, rel=off)
        assert found["radial_width"][0] == pytest.approx(ae, rel=off)
        thickest = CHIP * (1.0 if ae >= D / 2 else math.sqrt(1.0 - (1.0 - 2.0 * ae / D) ** 2))
        assert found["chip_thickness"][0] == pytest.approx(thickest, rel=off + 2e-3)


# c / d, A, B and J: Machinery's Handbook, 31st ed., "Machining Power", table 7
@pytest.mark.parametrize(
    ("share", "A", "B", "J"), [(0.03, 1.000, 1.100, 0.001), (0.18, 1.085, 1.355, 0.030), (0.40, 1.395, 1.620, 0.160)]
)
def test_chisel_edge_by_the_handbook(share, A, B, J):
    """Thrust B T + 0.007 K d² J and torque A M beside lips that reach the axis, K from M = 2.5e-5 K f^0.8 d^1.8."""
    feed = 0.015 * 8e-3
    lips = plunge_forces(mill(8.0, 2, 0.0, "drill", chisel_edge=0.0), STEEL, feed_per_rev=feed)
    constant = lips.torque / (2.5e-5 * 0.12**0.8 * 8.0**1.8)

    found = plunge_forces(mill(8.0, 2, 0.0, "drill", chisel_edge=share * 8e-3), STEEL, feed_per_rev=feed)

    assert found.force[2] == pytest.approx(B * lips.force[2] + 0.007 * constant * 64.0 * J, rel=1e-9)
    assert found.torque == pytest.approx(A * lips.torque, rel=0.02 if share < 0.2 else 0.11)


def test_a_drill_that_goes_faster_is_pressed_harder():
    """Constants of mills have a share along helical flanks, which lips do not have: thrust fell with the feed."""
    drill = mill(6.0, 2, 30.0, "drill")
    thrusts = [plunge_forces(drill, ALUMINIUM, feed_per_rev=feed).force[2] for feed in (0.0, 0.1e-3, 0.2e-3, 0.4e-3)]

    slope = 2.0 * 3e-3 * ALUMINIUM.krc * math.sin(59.0 * DEG)  # of two lips, and more of the chisel edge
    for (slow, fast), more in zip(itertools.pairwise(thrusts), (0.1e-3, 0.1e-3, 0.2e-3), strict=True):
        assert fast - slow == pytest.approx(1.355 * slope * 0.5 * more, rel=1e-9)


@pytest.mark.parametrize("law", [STEEL, ALUMINIUM])
@pytest.mark.parametrize("kind", ["flat_end_mill", "ball_end_mill", "drill", "step_drill"])
def test_plunge_in_stock(kind, law):
    more = {"tip_diameter": 4e-3, "step_length": 3e-3} if kind == "step_drill" else {}
    tool = mill(6.0, 2, kind=kind, **more)
    stock = Stock.box((0.0, 0.0, -20e-3), (20e-3, 20e-3, 0.0), 0.25e-3)
    feed = 0.1e-3 * OMEGA / (2.0 * math.pi)
    window = straight((10e-3, 10e-3, 1e-3), (10e-3, 10e-3, -8e-3), feed=feed, spindle=OMEGA)
    wanted = plunge_forces(tool, law, feed_per_rev=0.1e-3, spindle=OMEGA)

    found = run(tool, law, stock, window)

    late = slice(-40, None)
    assert found["peak_force"][late].mean() == pytest.approx(np.linalg.norm(wanted.force), rel=0.03)
    near = 0.03 if kind == "step_drill" else 0.01  # the wall of its first bore is as soft as a cell is wide
    assert found.wrench[late, :3].mean(axis=0) == pytest.approx(wanted.force, abs=near * np.linalg.norm(wanted.force))
    assert found["torque"][late].mean() == pytest.approx(wanted.torque, rel=near)
    early = window.piece_end[:, 2] >= 0.0
    assert not found.wrench[early].any()


@pytest.mark.parametrize("angle", [90.0, 180.0, 270.0])
def test_turning_the_cell_turns_the_force(angle):
    """ID-10: quarter turns map the grid onto itself, so only rounding is left."""
    tool, cell = mill(flutes=2), D / 20
    c, s = round(math.cos(angle * DEG)), round(math.sin(angle * DEG))
    turn = np.array([[c, -s], [s, c]], dtype=float)
    results = []
    for R in (np.eye(2), turn):
        stock = Stock.box((-20e-3, -20e-3, -10e-3), (20e-3, 20e-3, 0.0), cell)
        # off the cell centres, so that which side owns a wall does not matter
        a = np.append(R @ [-26e-3, 2.1e-4], -2e-3)
        b = np.append(R @ [-10e-3, 2.1e-4], -2e-3)
        found = run(tool, ALUMINIUM, stock, straight(a, b, feed=feed_of(tool), spindle=OMEGA))
        results.append((found, R))
    (first, _), (second, R) = results
    assert second.wrench[:, :2] == pytest.approx(first.wrench[:, :2] @ R.T, abs=1e-6)
    assert second.wrench[:, 2] == pytest.approx(first.wrench[:, 2], abs=1e-6)
    assert second["removed"].sum() == pytest.approx(first["removed"].sum(), rel=1e-9)
    assert abs(first.wrench).max() > 10.0


def compliance_of(stiffness):
    """A machine as soft as `stiffness` [N/m], differently in x, y and z, with coupling between the directions."""
    C = np.zeros((6, 6))
    C[:3, :3] = np.array([[1.0, 0.1, 0.4], [0.1, 1.4, -0.2], [0.4, -0.2, 0.7]]) / stiffness
    return C


@pytest.mark.parametrize("stiffness", [2e6, 5e5, 2e5, 5e4, 2e4])
@pytest.mark.parametrize("mode", ["up", "down"])
@pytest.mark.parametrize("law", [STEEL, ALUMINIUM], ids=["kienzle", "linear"])
def test_deflection_settles_without_ringing(law, mode, stiffness):
    """From 2 down to 0.02 N/um: delta = C F within 1 %, no jump from step to step above 5 % of it."""
    tool = mill(flutes=2)
    stock = Stock.box((0.0, -20e-3, -20e-3), (80e-3, 0.0, 0.0), 0.4e-3)
    y = D / 2 - 3e-3
    ends = [(-8e-3, y, -2e-3), (70e-3, y, -2e-3)] if mode == "down" else [(88e-3, y, -2e-3), (10e-3, y, -2e-3)]
    window = straight(*ends, feed=feed_of(tool), spindle=OMEGA, compliance=compliance_of(stiffness))

    found = run(tool, law, stock, window)

    late = slice(window.steps * 6 // 10, window.steps * 8 // 10)
    given = np.einsum("nij,nj->ni", window.compliance[late, :3], found.wrench[late])
    bent = found.deflection[late]
    size = np.linalg.norm(bent, axis=1)
    assert size.min() > 0.0
    assert (np.linalg.norm(bent - given, axis=1) / size).max() < 0.01
    assert (np.linalg.norm(np.diff(bent, axis=0), axis=1) / size[1:]).max() < 0.05


def test_deflection_moves_the_cut():
    """The floor of a slot is higher by what the machine gives way along Z."""
    tool = mill(flutes=2)
    C = np.zeros((6, 6))
    C[2, 1] = C[1, 2] = 1.0 / 1e6  # lateral force lifts the tool
    C[1, 1] = C[2, 2] = 2.0 / 1e6
    stock = Stock.box((0.0, 0.0, -20e-3), (60e-3, 20e-3, 0.0), 0.25e-3)
    window = straight((-8e-3, 10e-3, -3e-3), (50e-3, 10e-3, -3e-3), feed=feed_of(tool), spindle=OMEGA, compliance=C)

    found = run(tool, STEEL, stock, window)

    at = 35e-3
    step = np.searchsorted(window.piece_end[:, 0] + D / 2, at)
    lifted = found.deflection[step, 2]
    assert lifted > 0.1e-3
    assert top_at(stock, at, 10e-3) == pytest.approx(-3e-3 + lifted, abs=0.05 * lifted)


def test_same_volume_for_any_step():
    """ID-12: removed = stock before - after, the same for any time step (but for where single columns end)."""
    tool = mill()
    totals = []
    for dt in (0.001, 0.004, 0.05):
        stock = Stock.box((0.0, 0.0, -20e-3), (30e-3, 20e-3, 0.0), D / 20)
        before = stock.volume
        found = run(
            tool, STEEL, stock, straight((-6e-3, 9e-3, -3e-3), (20e-3, 11e-3, -4e-3), feed=0.01, spindle=OMEGA, dt=dt)
        )
        assert found["removed"].sum() == pytest.approx(before - stock.volume, rel=1e-9)
        totals.append(found["removed"].sum())
    assert totals == pytest.approx([totals[0]] * 3, rel=5e-4)
