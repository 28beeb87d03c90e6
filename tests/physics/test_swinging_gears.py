"""Links on gears that are springs with dampers: closed forms, and scipy's integration of the same equations."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from gcodesim.controllers.flexible import Flexible
from gcodesim.kinematics.dynamics import inverse_dynamics
from gcodesim.kinematics.elasticity import compliance, shift_jacobian
from gcodesim.kinematics.machine import Machine
from gcodesim.world import WORLDS, RobotBody, World, open_world
from gcodesim.world.payload import payload_of
from tests.unit.world import machines

GEARS = (1.5e5, 1.4e5, 9e4, 3e4, 2.5e4, 1.5e4)
LOAD = np.array([60.0, -40.0, 30.0, 0.0, 0.0, 0.0])
LEVER = np.array([0.0, 0.0, machines.SPINDLE.length])


def opened(body: RobotBody, step_ns: int = machines.STEP_NS, world: str = "kinematic") -> World:
    opened = open_world(world, body, step_ns)
    opened.attach(machines.SPINDLE)
    opened.reset(machines.rest(body.chain))
    return opened


def robot(gears: tuple[float, ...] = GEARS, **more: Any) -> RobotBody:
    own = {name: more.pop(name) for name in ("gear_damping",) if name in more}
    return RobotBody(chain=machines.machine("kr10"), stiffness=gears, controller=Flexible(**own), **more)


def dynamics(q: np.ndarray, qd: np.ndarray, qdd: np.ndarray, gravity: float = 0.0) -> np.ndarray:
    """Efforts (n, j) of the links with the spindle."""
    rows = [np.atleast_2d(each) for each in (q, qd, qdd)]
    efforts: np.ndarray = inverse_dynamics(
        machines.machine("kr10"), *rows, payload_of(machines.SPINDLE), gravity=(0.0, 0.0, -gravity)
    )
    return efforts


def mass(q: np.ndarray) -> np.ndarray:
    return dynamics(np.tile(q, (6, 1)), np.zeros((6, 6)), np.eye(6)).T


def tip_jacobian(body: RobotBody, q: np.ndarray) -> np.ndarray:
    machine = Machine(chain=body.chain)
    J: np.ndarray = shift_jacobian(machine.jacobian(q[None]), machine.forward(q[None]), LEVER)[0]
    return J


@pytest.mark.parametrize("step_ns", [1_000_000, 4_000_000, 10_000_000])
def test_one_gear_swings_and_fades_as_the_closed_form_says(step_ns: int) -> None:
    """One elastic joint: omega = sqrt(k / I), damping k tau: e(t) after a blow to 0.1 %, at any rate of steps."""
    stiff, tau = 1.5e5, 1e-3
    body = robot((stiff, *(np.inf,) * 5), gear_damping=tau)
    world, q = opened(body, step_ns), machines.rest(body.chain)
    dt, count = step_ns * 1e-9, 400_000_000 // step_ns
    blow = np.zeros((count, 6))
    blow[0] = [0.0, 200.0, 0.0, 0.0, 0.0, 0.0]
    swing = world.run(np.tile(q, (count, 1)), blow).gear
    assert swing is not None

    inertia, torque = mass(q)[0, 0], (tip_jacobian(body, q).T @ blow[0])[0]
    omega, zeta = np.sqrt(stiff / inertia), 0.5 * tau * np.sqrt(stiff / inertia)
    fast = omega * np.sqrt(1.0 - zeta * zeta)

    def pressed(t: np.ndarray) -> np.ndarray:
        """Response to a torque that begins at t = 0."""
        t = np.maximum(t, 0.0)
        wave = np.cos(fast * t) + zeta * omega / fast * np.sin(fast * t)
        return torque / stiff * (1.0 - np.exp(-zeta * omega * t) * wave)

    t = dt * np.arange(1, count + 1)
    exact = pressed(t) - pressed(t - dt)
    assert np.abs(swing[:, 0] - exact).max() < 1e-3 * np.abs(exact).max()
    assert (swing[:, 1:] == 0.0).all()


def test_a_settled_load_bends_gears_by_their_compliance() -> None:
    """Salisbury 1980: J K^-1 J' F, here to 0.1 %."""
    body = robot()
    rest = machines.rest(body.chain)
    gear = opened(body).run(np.tile(rest, (500, 1)), np.tile(LOAD, (500, 1))).gear
    assert gear is not None
    J = tip_jacobian(body, rest)
    exact = compliance(J[None], np.array(GEARS))[0] @ LOAD
    assert J @ gear[-1] == pytest.approx(exact, rel=1e-3, abs=1e-4 * np.abs(exact).max())


def corner(body: RobotBody) -> np.ndarray:
    """Joints (n, 6) along X at 20 mm/s, and from one step to the next along Y: what no real drive could do."""
    q, dt = machines.rest(body.chain), machines.STEP_NS * 1e-9
    rows = []
    for step in range(50):
        v = np.zeros(6)
        v[0 if step < 20 else 1] = 0.02
        q = q + dt * np.linalg.solve(tip_jacobian(body, q), v)
        rows.append(q)
    return np.array(rows)


@pytest.mark.slow
def test_behind_a_corner_the_tip_goes_as_scipy_says_that_it_goes() -> None:
    """The same equations, nonlinear, by Runge-Kutta; motors move as the control told them, by cubics."""
    body, dt = robot(), machines.STEP_NS * 1e-9
    q = corner(body)
    load = np.tile(LOAD, (len(q), 1)) * np.linspace(0.0, 1.0, len(q))[:, None]
    steps = opened(body).run(q, load)
    assert steps.gear is not None

    whole = np.vstack([machines.rest(body.chain), q])
    means = np.vstack([np.zeros(6), np.diff(whole, axis=0) / dt])
    speeds = np.vstack([np.zeros(6), means[1:] + 0.5 * np.diff(means, axis=0)])
    K, tau = np.array(GEARS), body.controller.gear_damping

    def slope(k: int, t: float, y: np.ndarray) -> np.ndarray:
        """y = links and their speeds, at `t` of step k."""
        x = t / dt
        d, a, b = whole[k + 1] - whole[k], speeds[k] * dt, speeds[k + 1] * dt
        motor = whole[k] + x * (a + x * (3.0 * d - 2.0 * a - b + x * (a + b - 2.0 * d)))
        speed = (a + x * (2.0 * (3.0 * d - 2.0 * a - b) + 3.0 * x * (a + b - 2.0 * d))) / dt
        e, v = y[:6] - motor, y[6:] - speed
        torque = tip_jacobian(body, y[:6]).T @ load[k] - K * e - tau * K * v
        coriolis = dynamics(y[:6], y[6:], np.zeros(6))[0]
        return np.concatenate([y[6:], np.linalg.solve(mass(y[:6]), torque - coriolis)])

    y, links = np.concatenate([whole[0], np.zeros(6)]), []
    for k in range(len(q)):
        y = solve_ivp(lambda t, y, k=k: slope(k, t, y), (0.0, dt), y, rtol=1e-5, atol=1e-8).y[:, -1]
        links.append(y[:6])
    found = np.array([tip_jacobian(body, at)[:3] @ e for at, e in zip(q, steps.gear, strict=True)])
    exact = np.array([tip_jacobian(body, at)[:3] @ e for at, e in zip(q, np.array(links) - q, strict=True)])
    assert np.abs(exact).max() > 5e-5
    assert np.abs(found - exact).max() < 0.01 * np.abs(exact).max()


@pytest.mark.parametrize("world", list(WORLDS))
def test_steps_in_one_call_are_those_one_by_one(world: str) -> None:
    """One by one they are made by shorter parts, in bullet by Bullet: as near as two ways to integrate are."""
    body = robot()
    q = machines.swing(body.chain, 200, 0.3)
    load = np.tile(LOAD, (200, 1))
    at_once = opened(body, world=world).run(q, load)
    singly = opened(body, world=world).run(q, lambda first, rows: load[: len(rows)])
    for one, other in ((at_once.gear, singly.gear), (at_once.effort, singly.effort)):
        assert one is not None and other is not None
        assert np.abs(one - other).max() < 0.04 * np.abs(other).max()
        assert np.abs(one - other)[-50:].max() < 0.01 * np.abs(other).max()


def test_motors_at_their_limit_go_step_by_step_and_come_back() -> None:
    """A load that is too heavy for a while: the joint gives way, is caught, and goes on as if nothing had been."""
    body = robot(effort=(200.0, 120.0, 60.0, 20.0, 20.0, 10.0))
    rest = machines.rest(body.chain)
    world = opened(body)
    heavy = np.tile([0.0, 0.0, -300.0, 0.0, 0.0, 0.0], (30, 1))
    steps = world.run(np.tile(rest, (30, 1)), heavy)
    assert steps.saturated.any()
    assert (np.abs(steps.effort) <= np.array(body.effort) * (1.0 + 1e-9)).all()
    after = world.run(np.tile(rest, (1000, 1)))
    assert np.abs(after.q[-1] - rest).max() < 1e-6
    assert not after.saturated[-100:].any()
    last = world.run(np.tile(rest, (50, 1)))
    assert last.gear is not None and np.abs(last.gear).max() < 1e-6


@pytest.mark.parametrize("world", list(WORLDS))
def test_where_the_control_knows_its_motion_links_go_by_the_command_and_joints_feel_what_rigid_ones_do(
    world: str,
) -> None:
    """Motors wind up their gears by what the motion takes, so nothing is left that would make links swing."""
    ahead = RobotBody(chain=machines.machine("kr10"), stiffness=GEARS, controller=Flexible(feed_forward=True))
    rigid = RobotBody(chain=machines.machine("kr10"))
    q = machines.swing(ahead.chain, 200, 0.3)
    found, plain = opened(ahead, world=world).run(q), opened(rigid, world="kinematic").run(q)

    assert found.gear is not None and np.abs(found.gear).max() < 1e-12
    assert np.abs(found.effort - plain.effort).max() < 2e-3 * np.abs(plain.effort).max()


def test_a_motor_at_its_limit_is_one_however_the_steps_are_divided() -> None:
    """Steps go one by one while a motor is at its limit, and not because some later one of the same call is."""
    body = robot(effort=(200.0, 120.0, 60.0, 20.0, 20.0, 10.0))
    rest = np.tile(machines.rest(body.chain), (300, 1))
    load = np.zeros((300, 6))
    load[120:150, 2] = -300.0
    whole = opened(body).run(rest, load)
    world = opened(body)
    parts = [world.run(rest[k : k + 7], load[k : k + 7]) for k in range(0, 300, 7)]
    assert whole.saturated.any() and not whole.saturated[:100].any()
    for name in ("q", "qd", "effort", "gear", "saturated"):
        assert np.array_equal(getattr(whole, name), np.concatenate([getattr(part, name) for part in parts])), name
