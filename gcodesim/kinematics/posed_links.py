"""Where the links of a description are while its joints, and those that follow them, stand at given values."""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite

import numpy as np

from gcodesim.frames import Pose, rotation_about
from gcodesim.kinematics.chain import Chain, Joint


def joint_values(chain: Chain, driven: Mapping[str, float]) -> dict[str, float]:
    """The value [rad, m] of every joint by its name: `driven` ones as given, else 0; followers (mimic) by their rule.

    A follower of a joint that is not there, or in a ring of followers, stands at its offset.
    """
    joints = {joint.name: joint for joint in chain.joints}

    def value(joint: Joint, seen: tuple[str, ...]) -> float:
        if joint.mimic is None:
            return driven.get(joint.name, 0.0)
        leader, factor, offset = joint.mimic
        if leader not in joints or leader in seen:
            return offset
        return factor * value(joints[leader], (*seen, leader)) + offset

    return {name: value(joint, (name,)) for name, joint in joints.items()}


def posed_links(chain: Chain, driven: Mapping[str, float]) -> dict[str, Pose]:
    """X_RL of every link L by its name, seen from the root R, with joints at `driven` [rad, m]."""
    values = joint_values(chain, driven)
    found = {chain.links[0].name: Pose.identity()}
    for joint in chain.joints:  # from the root outwards
        X_RP = found[joint.parent]
        X = X_RP @ Pose.from_matrix(joint.X)
        at = values[joint.name]
        if joint.kind == "prismatic":
            X = X @ Pose(at * joint.axis, np.eye(3))
        elif joint.kind == "revolute":
            X = X @ Pose(np.zeros(3), rotation_about(joint.axis, at))
        found[joint.child] = X
    return found


def travel_of(chain: Chain) -> dict[str, tuple[float, float]]:
    """Least and greatest value of each driven joint whose travel is known, by its name."""
    joints = (chain.joints[index] for index in chain.driven)
    return {joint.name: (joint.lower, joint.upper) for joint in joints if isfinite(joint.lower + joint.upper)}
