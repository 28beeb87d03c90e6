"""Where frames are while machines move: against the kinematics, multiplied out by hand."""

from __future__ import annotations

import numpy as np
import pytest

from gcodesim.arithmetic.matrices import multiplied
from gcodesim.frames import WORLD, Pose
from gcodesim.kinematics import MODELS, Axis, Cartesian, kinematics_of, load_urdf
from gcodesim.kinematics.cartesian import chain_of_axes
from gcodesim.scene import WORK, Hold, Mover, Scene, Stand

X_WB = Pose.from_xyz_rpy((1.0, 2.0, 0.5), (0.0, 0.0, 0.4))
X_PF = Pose.from_xyz_rpy((0.1, -0.2, 0.3), (0.3, 0.2, 0.1))


def arm(name: str = "arm", X: Pose = X_WB) -> Mover:
    chain, _ = load_urdf(MODELS["ur10e"].path)
    assert chain is not None
    return Mover(name=name, kinematics=kinematics_of(chain), X_WB=X, home=np.zeros(6))


def mill(X: Pose = X_WB) -> Mover:
    axes = [Axis(letter="X", side="table"), Axis(letter="Z"), Axis(letter="C", point=(0.05, 0.02, 0.0))]
    kinematics = Cartesian(chain=chain_of_axes(axes))
    return Mover(name="machine", kinematics=kinematics, X_WB=X, home=np.zeros(3), joints_are_axes=True)


def joints(count: int = 5, width: int = 6, seed: int = 1) -> np.ndarray:
    return np.random.default_rng(seed).uniform(-1.0, 1.0, (count, width))


def scene(*movers: Mover, **frames: Stand) -> Scene:
    return Scene(movers={mover.name: mover for mover in movers}, frames=frames)


def test_a_frame_in_the_world_stays_where_it_is_to_the_last_bit() -> None:
    cell = scene(arm(), vise=Stand(WORLD, X_PF), jaw=Stand("vise", X_PF))
    q = {"arm": joints()}

    assert np.array_equal(cell.track("vise", q), np.tile(X_PF.matrix, (5, 1, 1)))
    assert np.array_equal(cell.track("jaw", q)[3], (X_PF @ X_PF).matrix)
    assert np.array_equal(cell.seen_from("arm", "vise", q)[3], (X_WB.inverse() @ X_PF).matrix)
    assert not cell.moves("jaw")


def test_a_frame_on_a_table_goes_along_with_it_to_the_last_bit() -> None:
    machine = mill()
    cell = scene(machine, stock=Stand(f"machine/{WORK}", X_PF))
    q = joints(width=3)

    table = machine.kinematics.table(q)

    assert np.array_equal(cell.seen_from("machine", "stock", {"machine": q}), multiplied(table, X_PF.matrix))
    assert np.array_equal(cell.track("stock", {"machine": q}), multiplied(X_WB.matrix, table, X_PF.matrix))
    assert cell.moves("stock")
    assert machine.shifts_work


def test_a_frame_on_a_link_goes_along_with_it() -> None:
    robot = arm()
    link = robot.kinematics.link_names[3]
    cell = scene(robot, bracket=Stand(f"arm/{link}", X_PF), camera=Stand("bracket", X_PF))
    q = joints()

    expected = X_WB.matrix @ robot.kinematics.links(q)[:, 3] @ X_PF.matrix @ X_PF.matrix

    assert cell.track("camera", {"arm": q}) == pytest.approx(expected, abs=1e-12)
    assert cell.standing_on("camera")[0] == f"arm/{link}"
    assert cell.standing_on("camera")[1].matrix == pytest.approx((X_PF @ X_PF).matrix)


def test_flange_and_base_are_frames_whatever_the_links_are_called() -> None:
    robot = arm()
    cell = scene(robot)
    q = joints()

    assert np.array_equal(cell.seen_from("arm", "arm/flange", {"arm": q}), robot.kinematics.forward(q))
    assert np.array_equal(cell.track("arm/base", {"arm": q})[2], X_WB.matrix)
    assert cell.moves("arm/flange")
    assert not cell.moves("arm/base")
    with pytest.raises(KeyError):
        cell.track("arm/elbow", {"arm": q})


def test_one_robot_sees_what_another_one_carries() -> None:
    left, right = arm("left"), arm("right", Pose.from_xyz_rpy((0.0, -1.0, 0.0), (0.0, 0.0, 1.5)))
    cell = scene(left, right, plate=Stand("right/flange", X_PF))
    q = {"left": joints(seed=2), "right": joints(seed=3)}

    expected = right.X_WB.matrix @ right.kinematics.forward(q["right"]) @ X_PF.matrix

    assert cell.track("plate", q) == pytest.approx(expected, abs=1e-12)
    assert left.X_WB.matrix @ cell.seen_from("left", "plate", q) == pytest.approx(expected, abs=1e-12)


def test_a_hold_changes_the_parent_from_its_step_on() -> None:
    robot = arm()
    cell = scene(robot, part=Stand(WORLD, X_WB))
    q = joints(8)
    held, put = Hold(step=3, body="part", parent="arm/flange", X=X_PF), Hold(step=6, body="part", parent=WORLD, X=X_PF)

    X = cell.track("part", {"arm": q}, [put, held])

    carried = X_WB.matrix @ robot.kinematics.forward(q) @ X_PF.matrix
    assert np.array_equal(X[:3], np.tile(X_WB.matrix, (3, 1, 1)))
    assert X[3:6] == pytest.approx(carried[3:6], abs=1e-12)
    assert np.array_equal(X[6:], np.tile(X_PF.matrix, (2, 1, 1)))


def test_what_stands_on_a_held_body_goes_along() -> None:
    robot = arm()
    cell = scene(robot, part=Stand(WORLD, X_WB), label=Stand("part", X_PF))
    q = joints(4)

    X = cell.track("label", {"arm": q}, [Hold(step=2, body="part", parent="arm/flange", X=X_PF)])

    carried = X_WB.matrix @ robot.kinematics.forward(q) @ X_PF.matrix @ X_PF.matrix
    assert X[1] == pytest.approx((X_WB @ X_PF).matrix)
    assert X[2:] == pytest.approx(carried[2:], abs=1e-12)


def test_a_body_that_is_held_from_before_the_window_is_held_in_all_of_it() -> None:
    robot = arm()
    cell = scene(robot, part=Stand(WORLD, X_WB))
    q = joints(4)

    X = cell.seen_from("arm", "part", {"arm": q}, [Hold(step=-5, body="part", parent="arm/flange", X=X_PF)])

    assert pytest.approx(robot.kinematics.forward(q) @ X_PF.matrix, abs=1e-12) == X
