"""What every controller of CONTROLLERS has to do, in both worlds, with gears that are springs and with rigid ones."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
import pytest

from gcodesim.controllers import CONTROLLERS, Controller, Sense
from gcodesim.controllers.controller import Law
from gcodesim.controllers.flexible import Flexible
from gcodesim.controllers.pd import PD
from gcodesim.frozen import frozen
from gcodesim.kinematics.dynamics import inverse_dynamics
from gcodesim.kinematics.elasticity import compliance, shift_jacobian
from gcodesim.kinematics.machine import Machine
from gcodesim.world import WORLDS, RobotBody, World, open_world
from gcodesim.world.payload import payload_of
from tests.unit.world import machines

GEARS = (1.5e5, 1.4e5, 9e4, 3e4, 2.5e4, 1.5e4)
LOAD = np.array([60.0, -40.0, 30.0, 0.0, 0.0, 0.0])
SHIPPED = [name for name in CONTROLLERS.own() if name != "ideal"]


@frozen(slots=False, eq=False)
class Sampled(Controller):
    """One's own: a position loop and the efforts of the model, once a step."""

    kind: ClassVar[str] = "sampled"
    law: ClassVar[Law] = "given"

    def torques(self, sense: Sense) -> np.ndarray:
        sense.memory["asked"] = sense.memory.get("asked", 0) + 1
        inertia = np.diag(sense.model.mass(sense.q)) + sense.model.rotors
        pull = sense.model.rotors * sense.qdd_ref + inertia * (
            900.0 * (sense.q_ref - sense.q) + 60.0 * (sense.qd_ref - sense.qd)
        )
        return sense.model.efforts(sense.q_ref, sense.qd_ref, sense.qdd_ref) + pull


@frozen(slots=False, eq=False)
class Stiffened(Flexible):
    """One's own: motors turn further by what the measured wrench winds up in the gears."""

    kind: ClassVar[str] = "stiffened"

    def aim(self, sense: Sense) -> np.ndarray:
        wound: np.ndarray = (sense.model.jacobian(sense.q).T @ sense.wrench) / sense.model.gears
        return sense.q_ref - wound


def robot(controller: Controller, gears: tuple[float, ...] | None = GEARS, **more: Any) -> RobotBody:
    return RobotBody(chain=machines.machine("kr10"), stiffness=gears, controller=controller, **more)


def opened(world: str, body: RobotBody) -> World:
    opened = open_world(world, body, machines.STEP_NS)
    opened.attach(machines.SPINDLE)
    opened.reset(machines.rest(body.chain))
    return opened


def links(steps: Any) -> np.ndarray:
    ends: np.ndarray = steps.q + steps.gear
    return ends


@pytest.mark.parametrize("gears", [GEARS, None], ids=["elastic", "rigid"])
@pytest.mark.parametrize("kind", SHIPPED)
def test_bullet_moves_the_links_as_our_own_equations_do(kind: str, gears: tuple[float, ...] | None) -> None:
    body = robot(CONTROLLERS[kind](), gears)
    q = machines.swing(body.chain, 120, 0.3)
    one, other = (opened(name, body).run(q, np.tile(LOAD, (120, 1))) for name in ("kinematic", "bullet"))

    assert np.abs(links(one) - links(other)).max() < 1e-5
    assert np.abs(one.q - other.q).max() < 1e-5


@pytest.mark.parametrize("world", list(WORLDS))
@pytest.mark.parametrize("kind", SHIPPED)
def test_it_stands_still_under_its_own_weight(kind: str, world: str) -> None:
    """Gravity and the gears that it winds up are known to the control; the efforts are those that gravity asks for."""
    body = robot(CONTROLLERS[kind]())
    rest = machines.rest(body.chain)

    steps = opened(world, body).run(np.tile(rest, (60, 1)))

    assert np.abs(links(steps) - rest).max() < 1e-7
    weight = inverse_dynamics(body.chain, rest, 0.0, 0.0, payload_of(machines.SPINDLE))
    assert np.abs(steps.effort[-1] - weight[0]).max() < 0.01


@pytest.mark.parametrize("kind", ["flexible", "computed_torque"])
def test_a_commanded_swing_is_followed(kind: str) -> None:
    """Without load, and with gears that are rigid, what the model knows is enough."""
    body = robot(CONTROLLERS[kind](), None)
    q = machines.swing(body.chain, 200, 0.3)

    steps = opened("kinematic", body).run(q)

    assert np.abs(steps.q - q).max() < 2e-4


def test_a_settled_load_bends_the_gears_by_their_compliance() -> None:
    """Salisbury 1980: the tip yields by J K^-1 J' F, whatever masses and dampers did on the way."""
    body = robot(Flexible())
    rest = machines.rest(body.chain)
    steps = opened("kinematic", body).run(np.tile(rest, (500, 1)), np.tile(LOAD, (500, 1)))

    machine = Machine(chain=body.chain)
    lever = np.array([0.0, 0.0, machines.SPINDLE.length])
    J = shift_jacobian(machine.jacobian(rest[None]), machine.forward(rest[None]), lever)
    exact = compliance(J, np.array(GEARS))[0] @ LOAD
    found = J[0] @ steps.gear[-1]
    assert found == pytest.approx(exact, rel=0.01, abs=1e-3 * np.abs(exact[:3]).max())


def test_a_gear_swings_with_its_own_frequency() -> None:
    """One joint after a blow: omega = sqrt(K / M), Spong 1987 with a motor that stands."""
    stiff = np.array([1.5e5, np.inf, np.inf, np.inf, np.inf, np.inf])
    body = robot(Flexible(gear_damping=0.0), tuple(stiff))
    world = opened("kinematic", body)
    rest = machines.rest(body.chain)
    blow = np.zeros((400, 6))
    blow[0] = [0.0, 200.0, 0.0, 0.0, 0.0, 0.0]
    swing = world.run(np.tile(rest, (400, 1)), blow).gear[:, 0]

    unit = np.eye(6)[:1]
    inertia = inverse_dynamics(body.chain, rest, 0.0, unit, payload_of(machines.SPINDLE), gravity=(0.0, 0.0, 0.0))[0, 0]
    crossings = np.flatnonzero(np.diff(np.sign(swing)) != 0)
    fraction = swing[crossings] / (swing[crossings] - swing[crossings + 1])
    period = 2.0 * np.mean(np.diff(crossings + fraction)) * world.dt if len(crossings) > 2 else np.inf
    assert period == pytest.approx(2.0 * np.pi * np.sqrt(inertia / stiff[0]), rel=0.01)


@pytest.mark.parametrize("world", list(WORLDS))
def test_no_motor_gives_more_than_it_can(world: str) -> None:
    """A load that is too heavy: the joint gives way, and says so."""
    body = robot(PD(), effort=(200.0, 120.0, 60.0, 20.0, 20.0, 10.0))
    rest = machines.rest(body.chain)

    steps = opened(world, body).run(np.tile(rest, (100, 1)), np.tile([0.0, 0.0, -300.0, 0.0, 0.0, 0.0], (100, 1)))

    assert (np.abs(steps.effort) <= np.array(body.effort) * (1.0 + 1e-9)).all()
    assert steps.saturated.any()
    assert np.abs(steps.q[-1] - rest).max() > 0.01


def test_friction_is_felt_by_the_motors_and_holds_a_joint_at_rest() -> None:
    chain = machines.machine("kr10")
    q = machines.rest(chain) + np.linspace(0.004, 0.4, 100)[:, None] * np.eye(6)[0]
    runs = [opened("kinematic", robot(Flexible(friction=(each,)), None)).run(q) for each in (0.0, 8.0)]

    assert (runs[1].effort - runs[0].effort)[50:, 0] == pytest.approx(np.full(50, 8.0), rel=0.01)


@pytest.mark.parametrize("kind", SHIPPED)
def test_windows_do_not_show(kind: str) -> None:
    body = robot(CONTROLLERS[kind]())
    q = machines.swing(body.chain, 60)
    load = np.linspace(0.0, 20.0, 60)[:, None] * np.ones(6)
    whole = opened("kinematic", body).run(q, load)
    world = opened("kinematic", body)
    parts = [world.run(q[rows], load[rows]) for rows in (slice(0, 7), slice(7, 8), slice(8, 8), slice(8, 60))]

    for name in ("q", "qd", "qdd", "effort", "saturated", "reaction", "gear"):
        assert np.array_equal(np.vstack([getattr(part, name) for part in parts]), getattr(whole, name)), name


@pytest.mark.parametrize("world", list(WORLDS))
def test_the_end_of_a_step_is_foreseen(world: str) -> None:
    """The process hears where the links will end and how they give way; the step then ends there."""
    body = robot(Flexible())
    q = machines.swing(body.chain, 30, 0.3)
    machine = Machine(chain=body.chain)
    lever = np.array([0.0, 0.0, machines.SPINDLE.length])
    ends = []

    class Process:
        def __call__(self, first: int, rows: np.ndarray) -> np.ndarray:
            raise AssertionError("asked for joints, not for a step")

        def react(self, k: int, q_before: np.ndarray, q_free: np.ndarray, response: np.ndarray) -> np.ndarray:
            X = machine.forward(q_free[None])[0]
            ends.append(X[:3, :3] @ lever + X[:3, 3] + response[:3] @ LOAD)
            return LOAD

    steps = opened(world, body).run(q, Process())

    X = machine.forward(links(steps))
    tips = X[:, :3, :3] @ lever + X[:, :3, 3]
    assert np.abs(tips - np.array(ends)).max() < 1e-6


def test_a_controller_of_ones_own_gives_torques() -> None:
    body = robot(Sampled(), None)
    q = machines.swing(body.chain, 200, 0.3)
    one, other = (opened(name, body).run(q) for name in ("kinematic", "bullet"))

    assert np.abs(one.q - q).max() < 2e-3
    assert np.abs(one.q - other.q).max() < 1e-4


def test_a_controller_of_ones_own_uses_the_measured_wrench() -> None:
    """The tip of an arm that knows what pushes it ends where it was commanded; without that it yields."""
    rest = np.tile(machines.rest(machines.machine("kr10")), (300, 1))
    load = np.tile(LOAD, (300, 1))
    runs = [opened("kinematic", robot(own)).run(rest, load) for own in (Flexible(), Stiffened())]
    left = [np.abs(links(run)[-1] - rest[-1]).max() for run in runs]

    assert left[1] < 0.02 * left[0]


def test_an_answer_of_the_wrong_shape_is_a_fault() -> None:
    @frozen(slots=False, eq=False)
    class Short(Flexible):
        kind: ClassVar[str] = "short"

        def aim(self, sense: Sense) -> np.ndarray:
            return sense.q_ref[:2]

    with pytest.raises(ValueError, match=r"`aim` of Short returned .* 6 finite numbers"):
        opened("kinematic", robot(Short())).run(machines.swing(machines.machine("kr10"), 3))
