"""A drill against work that turns: thrust and torque in closed form."""

from math import pi, radians, sin

import numpy as np
import pytest

from gcodesim.material.revolved import Revolved
from gcodesim.processes.laws import Kienzle
from gcodesim.processes.materials import Material
from gcodesim.processes.turning import drilling_of
from gcodesim.processes.window import Window
from gcodesim.tools import TOOLS
from gcodesim.units import MM

LAW = Kienzle.from_ratios(kc11=1700e6, mc=0.2, normal_ratio=0.5, axial_ratio=0.2)
FEED, STEPS = 0.12 * MM, 700
D = 8.0 * MM


def drilled(chisel, flutes=2, bore=0.0):
    """Thrust [N] and torque [N·m] late in a bore; `chisel` is the length of that edge over the diameter."""
    drill = TOOLS["drill"](diameter=D, flutes=flutes, chisel_edge=chisel * D)
    process = drilling_of(drill, Material(id="own", name="own", law=LAW, source=""))
    stock = Revolved.bar(15.0 * MM, -30.0 * MM, 0.0, bore=bore)
    at = np.zeros((STEPS + 1, 3))
    at[:, 2] = np.linspace(2.0 * MM, -12.0 * MM, STEPS + 1)
    dt = 14.0 * MM / STEPS / (FEED * 1000.0 / 60.0)
    window = Window(
        piece_start=at[:-1],
        piece_end=at[1:],
        piece_step=np.arange(STEPS),
        axis=np.tile([0.0, 0.0, 1.0], (STEPS, 1)),
        velocity=np.diff(at, axis=0) / dt,
        rapid=np.zeros(STEPS, dtype=bool),
        signals={
            "spindle": np.full(STEPS, 1000.0 / 60.0 * 2.0 * pi),
            "surface_speed": np.zeros(STEPS),
            "pitch": np.zeros(STEPS),
        },
        dt=dt,
    )
    found = process.run(stock, window, process.begin())
    late = slice(STEPS // 2, None)
    assert np.ptp(found["feeding_force"][late]) < 1e-3 * found["feeding_force"][late].mean()
    assert found.wrench[-1, 2] == pytest.approx(found["feeding_force"][-1])
    return float(found["feeding_force"][late].mean()), float(found["torque"][late].mean())


def test_lips_that_reach_the_axis():
    """h = f_z sin sigma on a width of d / (2 sin sigma) a lip, with sigma half the point angle."""
    sigma, f_z = radians(59.0), 0.5 * FEED
    main = 1700.0 * (f_z / MM * sin(sigma)) ** 0.8 * (D / MM) / (2.0 * sin(sigma))
    thrust, torque = drilled(0.0)

    assert thrust == pytest.approx(2.0 * 0.5 * main * sin(sigma), rel=2e-3)
    assert torque == pytest.approx(2.0 * main * D / 4.0, rel=2e-3)


# c / d, A, B and J: Machinery's Handbook, 31st ed., "Machining Power", table 7
@pytest.mark.parametrize(("share", "A", "B", "J"), [(0.03, 1.000, 1.100, 0.001), (0.18, 1.085, 1.355, 0.030)])
@pytest.mark.parametrize("flutes", [1, 2])
def test_a_drill_in_the_tailstock_has_a_chisel_edge(share, A, B, J, flutes):
    """As on a mill: thrust B T + 0.007 K d² J and torque A M, K from M = 2.5e-5 K f^0.8 d^1.8."""
    thrust, torque = drilled(0.0, flutes)
    constant = torque / (2.5e-5 * (FEED / MM) ** 0.8 * (D / MM) ** 1.8)
    blunt_thrust, blunt_torque = drilled(share, flutes)

    assert blunt_thrust == pytest.approx(B * thrust + 0.007 * constant * (D / MM) ** 2 * J, rel=0.01)
    assert blunt_torque == pytest.approx(A * torque, rel=0.025)


def test_in_a_bore_that_is_wider_than_its_chisel_edge_only_lips_cut():
    sharp, blunt = drilled(0.0, bore=3.0 * MM), drilled(0.18, bore=3.0 * MM)

    assert blunt == pytest.approx(sharp, rel=1e-3)
