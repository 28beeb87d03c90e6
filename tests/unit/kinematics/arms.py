"""Machines and slow twins that several tests here use."""

from functools import cache
from pathlib import Path

import numpy as np

from gcodesim.frames import rotation_about
from gcodesim.kinematics import MODELS, Cartesian, kinematics_of, load_urdf
from gcodesim.kinematics.cartesian import chain_of_axes
from gcodesim.kinematics.chain import Chain

DATA = Path(__file__).parents[2] / "data" / "kinematics"


@cache
def machine(name):
    """The kinematics of a shipped model."""
    return kinematics_of(chain(name))


def machine_of(axes):
    """A machine tool from plain axis data, in chain order."""
    return Cartesian(chain=chain_of_axes(axes))


def nose_on_table(k, q):
    """X_CF (n, 4, 4): the spindle nose as the work sees it."""
    return np.linalg.inv(k.table(q)) @ k.forward(q)


@cache
def chain(name):
    found, findings = load_urdf(MODELS[name].path)
    assert findings == []
    return found


def slow_link_poses(chain: Chain, q):
    """Poses of all links by walking the joints one by one: the twin of the compiled walk."""
    place = {index: i for i, index in enumerate(chain.driven)}
    poses = {chain.links[0].name: np.eye(4)}
    for index, joint in enumerate(chain.joints):
        motion = np.eye(4)
        if index in place and joint.kind == "revolute":
            motion[:3, :3] = rotation_about(joint.axis, q[place[index]])
        elif index in place:
            motion[:3, 3] = joint.axis * q[place[index]]
        poses[joint.child] = poses[joint.parent] @ joint.X @ motion
    return np.array([poses[link.name] for link in chain.links])


def random_joints(joints, count, seed, margin=0.0):
    """Joint vectors (count, j) within limits; unlimited joints within one turn."""
    rng = np.random.default_rng(seed)
    lower, upper = np.maximum(joints.lower, -2 * np.pi), np.minimum(joints.upper, 2 * np.pi)
    return rng.uniform(lower + margin, upper - margin, (count, len(joints)))


def wrapped(angles):
    """Angles within ±π."""
    return (np.asarray(angles) + np.pi) % (2 * np.pi) - np.pi
