"""What only the bullet world has: motors that give way, pockets, and nothing left behind."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from gcodesim.frames import Pose, rotation_from_quaternion
from gcodesim.solids import Box, Cylinder, Placed, Sphere
from gcodesim.world import RobotBody, ToolBody, WorldUnavailable, open_world
from gcodesim.world.bullet import BulletWorld, import_pybullet
from tests.unit.world import machines

CHAIN = machines.machine("kr10")
REST = np.radians([0.0, -90.0, 90.0, 0.0, 90.0, 0.0])  # tool straight down
PEN = ToolBody(
    name="pen",
    length=0.15,
    mass=1.0,
    com=(0.0, 0.0, 0.08),
    inertia=(2e-3, 2e-3, 4e-4, 0.0, 0.0, 0.0),
    solids=(
        Placed(Cylinder(radius=0.01, bottom=0.03, top=0.13)),
        Placed(Sphere(radius=0.01), Pose.from_xyz_rpy((0.0, 0.0, 0.14))),
        Placed(Box.about_origin((0.05, 0.05, 0.02)), Pose.from_xyz_rpy((0.0, 0.0, 0.01))),
    ),
)


def opened(effort: tuple[float, ...] | None = None) -> BulletWorld:
    world = open_world("bullet", RobotBody(chain=CHAIN, effort=effort), machines.STEP_NS)
    assert isinstance(world, BulletWorld)
    world.reset(REST)
    return world


@pytest.fixture
def world() -> Iterator[BulletWorld]:
    world = opened()
    yield world
    world.close()


def test_a_motor_at_its_limit_falls_behind_and_catches_up(world: BulletWorld) -> None:
    """A load above the wrist's 41.6 N·m for a moment: saturated, away from the command, then back."""
    world.attach(PEN)
    load = np.zeros((100, 6))
    load[10:13] = [0.0, 0.0, 0.0, 0.0, 60.0, 0.0]

    steps = world.run(np.tile(REST, (100, 1)), load)

    assert not steps.saturated[:10].any()
    assert steps.saturated[10:13].any()
    assert np.abs(steps.effort).max(axis=0) == pytest.approx(np.minimum(np.abs(steps.effort).max(axis=0), 312.0))
    assert (np.abs(steps.effort) <= np.array([288.4, 312.0, 119.8, 46.1, 41.6, 28.0]) * (1.0 + 1e-9)).all()
    assert np.abs(steps.q[12] - REST).max() > 1e-5
    assert np.abs(steps.q[-1] - REST).max() < 1e-9


def test_the_process_hears_of_the_lag(world: BulletWorld) -> None:
    """A joint that cannot follow is not where it was told to be; the process hears where it is and will be."""
    world.attach(PEN)
    before, foreseen = np.empty((40, 6)), np.empty((40, 6))

    class Pushed:
        def __call__(self, first: int, q: np.ndarray) -> np.ndarray:
            raise AssertionError("asked for joints, not for a step")

        def react(self, k: int, q_before: np.ndarray, q_free: np.ndarray, response: np.ndarray) -> np.ndarray:
            before[k], foreseen[k] = q_before, q_free
            return np.array([0.0, 0.0, 0.0, 0.0, 60.0 if 10 <= k < 14 else 0.0, 0.0])

    steps = world.run(np.tile(REST, (40, 1)), Pushed())

    assert np.abs(steps.q - REST).max() > 1e-5
    assert np.array_equal(before[1:], steps.q[:-1])
    missed, gone = np.abs(foreseen[15:] - steps.q[15:]).max(), np.abs(np.diff(steps.q[14:], axis=0)).max()
    assert missed < 0.1 * gone


@pytest.mark.parametrize("torque", [30.0, 60.0])
def test_it_knows_beforehand_whether_the_motors_will_do(world: BulletWorld, torque: float) -> None:
    """A load below and one above what the wrist's 41.6 N·m can bear."""
    world.attach(PEN)
    load = np.zeros((30, 6))
    load[10:20, 4] = torque
    q = np.tile(REST, (30, 1))

    promised = world.keeps_up(q, load)
    steps = world.run(q, load)

    assert promised == (torque < 41.0)
    assert promised == (not steps.saturated.any())
    assert promised == bool(np.abs(steps.q - q).max() < 1e-9)


def test_a_lagging_arm_promises_nothing(world: BulletWorld) -> None:
    load = np.zeros((30, 6))
    load[:, 4] = 60.0
    q = np.tile(REST, (30, 1))
    world.run(q, load)
    assert not world.keeps_up(q[:1], np.zeros((1, 6)))


def stands_at(world: BulletWorld, name: str) -> Pose:
    """Where Bullet has the parked tool `name`: its flange side in W; KeyError if it is not parked."""
    p, q = world._bullet.getBasePositionAndOrientation(world._pockets[name], physicsClientId=world._client)
    return Pose(np.array(p), rotation_from_quaternion(np.array(q)))


def test_a_tool_in_its_pocket_is_a_body_that_stands_there(world: BulletWorld) -> None:
    pocket = Pose.from_xyz_rpy((0.4, -0.5, 0.6), (0.1, 0.2, 0.3))
    world.attach(PEN)
    world.attach(None, pocket)

    stands = stands_at(world, "pen")
    assert np.abs(stands.p - pocket.p).max() < 1e-12
    assert np.abs(stands.R - pocket.R).max() < 1e-12

    world.attach(PEN)
    with pytest.raises(KeyError):
        stands_at(world, "pen")


def test_it_leaves_no_file_behind(world: BulletWorld, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    world.attach(PEN)

    assert list(tmp_path.iterdir()) == []


def test_it_writes_nothing_to_either_stream() -> None:
    """Standard output carries results and nothing else; Bullet likes to talk on both streams."""
    program = (
        "import sys; sys.path.insert(0, sys.argv[1])\n"
        "from tests.unit.world.test_bullet import PEN, REST, opened\n"
        "world = opened(); world.attach(PEN); world.attach(None, None); world.attach(PEN)\n"
        "world.run(REST[None]); world.close()\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program, str(Path(__file__).parents[3])], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def test_without_pybullet_the_message_says_what_to_do(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pybullet", None)
    monkeypatch.delitem(sys.modules, "pybullet")
    monkeypatch.setattr(sys, "meta_path", [_NoBullet(), *sys.meta_path])

    with pytest.raises(WorldUnavailable, match=r"pip install pybullet.*world: kinematic"):
        import_pybullet()


class _NoBullet:
    """An importer that has no pybullet, whatever is installed."""

    def find_spec(self, name: str, path: object = None, target: object = None) -> None:
        if name == "pybullet":
            raise ModuleNotFoundError("No module named 'pybullet'", name=name)


def test_importing_the_package_needs_no_pybullet() -> None:
    program = "import sys; import gcodesim.world; sys.exit('pybullet' in sys.modules or 'numba' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", program], check=False).returncode == 0
