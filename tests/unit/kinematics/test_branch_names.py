"""Words for branches mean what they say, on every arm: the elbow is above or below, the wrist in front or behind."""

import numpy as np
import pytest
from arms import machine

from gcodesim.kinematics import MODELS
from gcodesim.kinematics.branch_names import PAIRS, WORDS, branches_named, names_of
from gcodesim.kinematics.tree_kernels import joint_frames

ARMS = [name for name, model in MODELS.items() if model.kind == "arm"]


def elbow_height(k, q, X):
    """How far joint 3 is above the line from joint 2 to the end of the forearm, in the vertical plane of both."""
    tree, frames = k.chain.tree, np.empty((6, 4, 4))
    joint_frames(q, tree.parent, tree.before, tree.axis, tree.prismatic, frames)
    start, elbow = frames[1, :3, 3], frames[2, :3, 3]
    end = frames[3, :3, 3] if k.chain.name == "ur10e" else k.centre(X)[0]
    way = end - start
    side = np.cross(way, [0.0, 0.0, 1.0])
    up = np.cross(side, way)
    return (elbow - start) @ up / np.linalg.norm(up)


@pytest.mark.parametrize("name", ARMS)
def test_words_say_where_elbow_and_wrist_are(name):
    k = machine(name)
    X = k.forward(np.array(MODELS[name].home))[0]
    q, exists = k.branches_along(X)
    assert exists.all()
    for branch in range(8):
        front, up, _ = names_of(k.arm, branch)
        assert (elbow_height(k, q[0, branch], X) > 0.0) == (up == "up")
        near = q[0, branch, 0] - MODELS[name].home[0]
        assert (abs(near - 2.0 * np.pi * np.rint(near / (2.0 * np.pi))) < 0.5) == (front == "front")


@pytest.mark.parametrize("name", ["kuka_kr10_r1100_2", "ur10e", "fanuc_m20ia"])
def test_flip_is_the_sign_of_joint_5(name):
    k = machine(name)
    q, _ = k.branches_along(k.forward(np.array(MODELS[name].home)))
    for branch in range(8):
        bent = q[0, branch, 4] + k.arm.zero6 if k.chain.name != "ur10e" else q[0, branch, 4]
        bent -= 2.0 * np.pi * np.rint(bent / (2.0 * np.pi))
        assert (bent > 0.0) == (names_of(k.arm, branch)[2] == "noflip")


def test_words_choose_branches():
    arm = machine("kuka_kr10_r1100_2").arm
    assert len({names_of(arm, b) for b in range(8)}) == 8
    assert len(branches_named(arm, ("up",))) == 4
    assert [names_of(arm, b) for b in branches_named(arm, ("flip", "front", "down"))] == [("front", "down", "flip")]
    assert branches_named(arm, ()) == tuple(range(8))
    assert [word for pair in PAIRS for word in pair] == list(WORDS)
