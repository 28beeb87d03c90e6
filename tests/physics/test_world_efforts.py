"""Efforts and reactions against statics, hand-made mechanics, and Bullet's own inverse dynamics."""

from __future__ import annotations

import numpy as np
import pytest

from gcodesim.frames import Pose
from gcodesim.kinematics import MODELS, load_urdf
from gcodesim.kinematics.dynamics import inverse_dynamics
from gcodesim.kinematics.machine import Machine
from gcodesim.world import WORLDS, RobotBody, open_world
from gcodesim.world.bullet import BulletWorld
from gcodesim.world.payload import payload_of
from tests.unit.world import machines

G = 9.80665
SPINDLE = machines.SPINDLE


def tip_jacobian(machine: Machine, q: np.ndarray) -> np.ndarray:
    """Jacobian (n, 6, j) at the tip: the flange's, shifted by the tool."""
    J = machine.jacobian(q).copy()
    lever = machine.forward(q)[:, :3, :3] @ SPINDLE.X_FT.p
    J[:, :3] += np.cross(J[:, 3:], lever[:, :, None], axisa=1, axisb=1, axisc=1)
    return J


@pytest.mark.parametrize("world_name", list(WORLDS))
@pytest.mark.parametrize("name", ["kr10", "router"])
@pytest.mark.parametrize("turned", [False, True])
def test_a_held_wrench_costs_its_jacobian_transposed(world_name: str, name: str, turned: bool) -> None:
    """Standing still, the efforts of a load are -J^T F to 1e-4 of the greatest."""
    chain = machines.machine(name)
    X_WB = Pose.from_xyz_rpy((0.3, 0.1, 0.2), (0.3, -0.4, 0.5)) if turned else Pose.identity()
    F = np.array([20.0, -10.0, 30.0, 1.0, 2.0, -0.5])
    q = np.tile(machines.rest(chain), (20, 1))
    world = open_world(world_name, RobotBody(chain=chain, X_WB=X_WB), machines.STEP_NS)
    world.reset(q[0])
    world.attach(SPINDLE)
    free, loaded = world.run(q), world.run(q, np.tile(F, (20, 1)))
    world.close()

    expected = -tip_jacobian(Machine(chain=chain), q[:1])[0].T @ F
    assert np.abs(loaded.effort[-1] - free.effort[-1] - expected).max() < 1e-4 * np.abs(expected).max()


@pytest.mark.parametrize("world_name", list(WORLDS))
def test_a_router_carries_what_hangs_on_its_axes(world_name: str) -> None:
    """Z: (20 + 3) kg against gravity; X: 188 kg, Y: 68 kg, Z: 23 kg against acceleration."""
    chain = machines.machine("router")
    n, dt, a = 50, machines.STEP_NS * 1e-9, np.array([0.5, -0.8, 0.3])
    k = np.arange(1, n + 1)[:, None]
    q = machines.rest(chain) + 0.5 * a * dt**2 * k * (k + 1)  # what the integrator makes of a constant acceleration
    world = open_world(world_name, RobotBody(chain=chain), machines.STEP_NS)
    world.reset(machines.rest(chain))
    world.attach(SPINDLE)
    steps = world.run(q)
    world.close()

    felt = a + np.array([0.0, 0.0, G])
    assert steps.qdd == pytest.approx(np.tile(a, (n, 1)), abs=1e-6)
    assert steps.effort == pytest.approx(np.tile([188.0 * 0.5, -68.0 * 0.8, 23.0 * (G + 0.3)], (n, 1)), rel=1e-6)
    assert steps.reaction[:, :3] == pytest.approx(np.tile(3.0 * felt, (n, 1)), rel=1e-6)
    # the flange looks down: y and z of F are turned over
    com = np.array(SPINDLE.com) * [1.0, -1.0, -1.0]
    assert steps.reaction[:, 3:] == pytest.approx(np.tile(np.cross(com, 3.0 * felt), (n, 1)), abs=1e-6)


@pytest.mark.parametrize("world_name", list(WORLDS))
def test_the_reaction_at_rest_is_weight_and_load_about_the_flange(world_name: str) -> None:
    chain = machines.machine("kr10")
    q = np.tile(machines.rest(chain), (5, 1))
    F = np.array([20.0, -10.0, 30.0, 1.0, 2.0, -0.5])
    world = open_world(world_name, RobotBody(chain=chain), machines.STEP_NS)
    world.reset(q[0])
    world.attach(SPINDLE)
    steps = world.run(q, np.tile(F, (5, 1)))
    world.close()

    R_BF = Machine(chain=chain).forward(q[:1])[0, :3, :3]
    weight = np.array([0.0, 0.0, -3.0 * G])
    force = -weight - F[:3]
    torque = -np.cross(R_BF @ SPINDLE.com, weight) - np.cross(R_BF @ SPINDLE.X_FT.p, F[:3]) - F[3:]
    assert steps.reaction[-1] == pytest.approx(np.concatenate([force, torque]), abs=1e-4)


def test_a_swinging_arm_under_load() -> None:
    """Inertia, Coriolis, gravity and load together, in both worlds.

    Bullet's motors give exactly what Newton and Euler ask for where a step begins. The kinematic world asks where
    it ends; at 1 ms and 1.3 rad/s that is the whole difference between the two, below 0.5 % of the greatest effort.
    """
    chain, dt = machines.machine("kr10"), 1e-3
    n = 1500
    t = np.arange(1, n + 1)[:, None] * dt
    q = machines.rest(chain) + 0.3 * (1.0 - np.cos(3.0 * t * (1.0 + 0.1 * np.arange(6))))
    load = np.tile([20.0, 10.0, -30.0, 1.0, 2.0, 0.5], (n, 1))
    found = []
    for name in ("bullet", "kinematic"):
        world = open_world(name, RobotBody(chain=chain, effort=(np.inf,) * 6), 1_000_000)
        world.reset(machines.rest(chain))
        world.attach(SPINDLE)
        found.append(world.run(q, load))
        world.close()

    bullet, kinematic = found
    for field, tolerance in (("q", 1e-9), ("qd", 1e-6), ("effort", 5e-3), ("reaction", 1e-4)):
        a, b = getattr(bullet, field), getattr(kinematic, field)
        assert (np.abs(a - b).max(axis=0) < tolerance * np.abs(b).max(axis=0)).all(), field
    asked = inverse_dynamics(
        chain,
        bullet.q[:-1],
        bullet.qd[:-1],
        bullet.qdd[1:],
        payload_of(SPINDLE),
        load[1:],
        p_FT=SPINDLE.X_FT.p,
    )
    assert np.abs(asked - bullet.effort[1:]).max() < 1e-5


def test_bullet_s_inverse_dynamics_knows_the_same_arm() -> None:
    """The merged model, asked by Bullet's calculateInverseDynamics, against our Newton and Euler, in 30 states."""
    chain = machines.machine("kr10")
    world = open_world("bullet", RobotBody(chain=chain), machines.STEP_NS)
    assert isinstance(world, BulletWorld)
    world.attach(SPINDLE)
    rng = np.random.default_rng(7)
    q, qd, qdd = (scale * rng.uniform(-1.0, 1.0, (30, 6)) for scale in (1.5, 2.0, 5.0))
    ours = inverse_dynamics(chain, q, qd, qdd, payload_of(SPINDLE))
    theirs = np.array(
        [
            world._bullet.calculateInverseDynamics(
                world._body, *(row.tolist() for row in state), physicsClientId=world._client
            )
            for state in zip(q, qd, qdd, strict=True)
        ]
    )
    world.close()

    assert np.abs(ours - theirs).max() < 1e-7 * np.abs(ours).max()


@pytest.mark.parametrize("name", list(MODELS))
def test_every_shipped_machine_moves_alike_in_both_worlds(name: str) -> None:
    """Joints on their commands, efforts within half a per cent of each other, under gravity and a load at the tip."""
    chain, _ = load_urdf(MODELS[name].path)
    assert chain is not None
    home, limits = np.array(MODELS[name].home), chain.driven_joints
    size = np.minimum(0.05, 0.2 * (limits.upper - limits.lower))
    size = np.where(home + 2.0 * size > limits.upper, -size, size)
    t = np.arange(1, 201)[:, None] * machines.STEP_NS * 1e-9
    q = home + size * (1.0 - np.cos(1.5 * t))
    load = np.tile([20.0, -10.0, 30.0, 0.3, 0.2, 0.1], (200, 1))
    found = []
    for world_name in ("bullet", "kinematic"):
        world = open_world(world_name, RobotBody(chain=chain), machines.STEP_NS)
        world.reset(home)
        world.attach(SPINDLE)
        found.append(world.run(q, load))
        world.close()

    bullet, kinematic = found
    assert np.abs(bullet.q - q).max() < 1e-9
    assert not bullet.saturated.any()
    greatest = np.abs(kinematic.effort).max(axis=0)
    assert (np.abs(bullet.effort - kinematic.effort).max(axis=0) < 5e-3 * greatest + 1e-4).all()
