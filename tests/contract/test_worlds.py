"""What every world of WORLDS has to do, on an arm and on a machine of prismatic joints."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from gcodesim.frames import Pose
from gcodesim.kinematics.machine import Machine
from gcodesim.world import WORLDS, RobotBody, ToolBody, World, open_world
from tests.unit.world import machines

STEP_NS, SPINDLE = machines.STEP_NS, machines.SPINDLE
POCKET = Pose.from_xyz_rpy((0.5, -0.6, 0.4), (0.1, 0.2, 0.3))


@pytest.fixture(params=["kr10", "router"])
def robot(request: pytest.FixtureRequest) -> RobotBody:
    return RobotBody(chain=machines.machine(request.param), X_WB=Pose.from_xyz_rpy((0.1, 0.2, 0.3), (0.1, -0.2, 0.5)))


@pytest.fixture(params=list(WORLDS))
def world(request: pytest.FixtureRequest, robot: RobotBody) -> Iterator[World]:
    world = open_world(request.param, robot, STEP_NS)
    world.reset(machines.rest(robot.chain))
    yield world
    world.close()


def test_it_ends_each_step_on_its_command(world: World, robot: RobotBody) -> None:
    q = machines.swing(robot.chain, 200)

    steps = world.run(q)

    assert np.abs(steps.q - q).max() < 1e-9
    assert not steps.saturated.any()


def test_it_follows_under_load_as_well(world: World, robot: RobotBody) -> None:
    world.attach(SPINDLE)
    q = machines.swing(robot.chain, 200)

    steps = world.run(q, np.tile([20.0, 10.0, -30.0, 1.0, 2.0, 3.0], (200, 1)))

    assert np.abs(steps.q - q).max() < 1e-9


def test_velocity_and_acceleration_are_those_of_the_integrator(world: World, robot: RobotBody) -> None:
    dt, q = STEP_NS * 1e-9, machines.swing(robot.chain, 50)
    path = np.vstack([machines.rest(robot.chain), q])

    steps = world.run(q)

    qd = np.diff(path, axis=0) / dt
    assert np.abs(steps.qd - qd).max() < 1e-6
    assert np.abs(steps.qdd - np.diff(qd, axis=0, prepend=0.0 * qd[:1]) / dt).max() < 1e-3


def test_windows_do_not_show(world: World, robot: RobotBody) -> None:
    """A run cut into windows gives the numbers of the run in one piece."""
    world.attach(SPINDLE)
    q = machines.swing(robot.chain, 60)
    load = np.linspace(0.0, 20.0, 60)[:, None] * np.ones(6)
    whole = world.run(q, load)

    world.reset(machines.rest(robot.chain))
    parts = [world.run(q[rows], load[rows]) for rows in (slice(0, 7), slice(7, 8), slice(8, 8), slice(8, 60))]

    for name in ("q", "qd", "qdd", "effort", "saturated", "reaction"):
        assert np.array_equal(np.vstack([getattr(part, name) for part in parts]), getattr(whole, name)), name


def test_the_process_is_asked_for_every_row_once_and_in_order(world: World, robot: RobotBody) -> None:
    q = machines.swing(robot.chain, 30)
    asked: list[tuple[int, np.ndarray]] = []

    def couple(first: int, rows: np.ndarray) -> np.ndarray:
        asked.append((first, rows.copy()))
        return np.zeros((len(rows), 6))

    world.run(q, couple)

    assert [first for first, _ in asked] == np.cumsum([0, *(len(rows) for _, rows in asked[:-1])]).tolist()
    assert np.abs(np.vstack([rows for _, rows in asked]) - q).max() < 1e-9


def test_a_process_and_a_known_wrench_do_the_same(world: World, robot: RobotBody) -> None:
    world.attach(SPINDLE)
    q = machines.swing(robot.chain, 40)
    load = np.linspace(0.0, 4.0, 40)[:, None] * np.arange(6)
    known = world.run(q, load)

    world.reset(machines.rest(robot.chain))
    asked = world.run(q, lambda first, rows: load[first : first + len(rows)])

    assert np.array_equal(known.effort, asked.effort)
    assert np.array_equal(known.reaction, asked.reaction)


def test_a_process_of_the_wrong_shape_is_a_fault(world: World, robot: RobotBody) -> None:
    with pytest.raises(ValueError, match="wrench of shape"):
        world.run(machines.swing(robot.chain, 3), lambda first, rows: np.zeros((len(rows), 3)))


def test_a_joint_vector_of_the_wrong_length_is_a_fault(world: World) -> None:
    with pytest.raises(ValueError, match="joints"):
        world.reset(np.zeros(2))
    with pytest.raises(ValueError, match="joints"):
        world.run(np.zeros((4, 2)))


def test_a_hundred_tool_changes_leave_the_flange_where_it_was(world: World, robot: RobotBody) -> None:
    other = ToolBody(name="drill", length=0.08, mass=0.5, com=(0.0, 0.0, 0.04), inertia=(4e-4, 4e-4, 5e-5, 0, 0, 0))
    q0 = machines.rest(robot.chain)
    flange = Machine(chain=robot.chain).forward
    world.attach(SPINDLE)
    before = flange(world.run(np.tile(q0, (5, 1))).q)[-1]

    for change in range(100):
        world.attach(other if change % 2 == 0 else SPINDLE, POCKET)
    after = flange(world.run(np.tile(q0, (5, 1))).q)

    assert np.abs(after - before).max() < 1e-9
    assert world.tool is SPINDLE
    assert list(world.parked) == ["drill"]


def test_a_tool_change_in_motion_does_not_jolt(world: World, robot: RobotBody) -> None:
    """Positions and velocities are kept: the motion goes on as if nothing had happened."""
    q = machines.swing(robot.chain, 100)
    smooth = world.run(q)

    world.reset(machines.rest(robot.chain))
    first = world.run(q[:50])
    world.attach(SPINDLE)
    second = world.run(q[50:])

    assert np.abs(np.vstack([first.q, second.q]) - smooth.q).max() < 1e-9
    assert np.abs(np.vstack([first.qd, second.qd]) - smooth.qd).max() < 1e-6


def test_the_old_tool_stays_in_its_pocket_until_it_is_fetched(world: World) -> None:
    drill = ToolBody(name="drill", length=0.08, mass=0.5, com=(0.0, 0.0, 0.04))
    world.attach(SPINDLE)
    assert dict(world.parked) == {}

    world.attach(drill, POCKET)
    tool, X_WF = world.parked["spindle"]
    assert tool is SPINDLE and X_WF is POCKET

    world.attach(SPINDLE, POCKET)
    assert list(world.parked) == ["drill"]

    world.attach(None)
    assert world.tool is None
    assert list(world.parked) == ["drill"]


def test_without_a_tool_nothing_pulls_at_the_flange(world: World, robot: RobotBody) -> None:
    assert not world.run(machines.swing(robot.chain, 5)).reaction.any()


def test_saturation_is_flagged_on_the_joint_that_has_not_enough(robot: RobotBody) -> None:
    """Limits just above what holds the machine still, then a load that needs more of one joint."""
    q0, n = machines.rest(robot.chain), 20
    load = np.zeros((n, 6))
    load[10:] = [0.0, 0.0, -80.0, 0.0, 0.0, 0.0]
    for name in WORLDS:
        free = open_world(name, robot, STEP_NS)
        free.reset(q0)
        effort = free.run(np.tile(q0, (n, 1)), load).effort
        free.close()
        still, loaded = np.abs(effort[0]), np.abs(effort[-1])
        joint = int(np.argmax(loaded - still))
        limit = np.full(len(q0), np.inf)
        limit[joint] = 0.5 * (still[joint] + loaded[joint])

        weak = open_world(name, RobotBody(chain=robot.chain, X_WB=robot.X_WB, effort=tuple(limit.tolist())), STEP_NS)
        weak.reset(q0)
        steps = weak.run(np.tile(q0, (n, 1)), load)
        weak.close()

        assert not steps.saturated[:10].any(), name
        assert steps.saturated[10:, joint].all(), name
        assert not np.delete(steps.saturated, joint, axis=1).any(), name


@pytest.mark.parametrize("name", list(WORLDS))
def test_the_same_run_gives_the_same_bits(name: str, robot: RobotBody) -> None:
    """Twice, the second time beside another world that was opened in between and is still there."""

    def record() -> tuple[World, list[np.ndarray]]:
        world = open_world(name, robot, STEP_NS)
        world.reset(machines.rest(robot.chain))
        world.attach(SPINDLE)
        steps = world.run(machines.swing(robot.chain, 300), lambda first, q: 10.0 * np.cos(q[:, :1] + np.arange(6.0)))
        return world, [steps.q, steps.qd, steps.effort, steps.reaction]

    first, numbers = record()
    first.close()
    other = open_world(name, RobotBody(chain=machines.machine("kr10")), 1_000_000)
    other.reset(machines.rest(other_chain := machines.machine("kr10")))
    other.run(machines.swing(other_chain, 10))
    second, again = record()

    assert all(np.array_equal(a, b) for a, b in zip(numbers, again, strict=True))
    other.close()
    second.close()


def test_what_keeps_up_may_be_asked_all_at_once(world: World, robot: RobotBody) -> None:
    """Where the world says that it keeps up, it ends every step on its command, and the world stays as it was."""
    world.attach(SPINDLE)
    q = machines.swing(robot.chain, 100)
    load = np.tile([5.0, -4.0, 3.0, 0.2, 0.1, -0.3], (100, 1))

    assert world.keeps_up(q, load)
    steps = world.run(q, load)

    assert np.abs(steps.q - q).max() < 1e-9
    assert not steps.saturated.any()


def test_closing_twice_does_nothing(world: World) -> None:
    world.close()
    world.close()
