"""What robots and tools have in common: a body read from a URDF, with its links and joints by name."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
import pybullet as p

from gcodesim.frames import Array


class UrdfBody:
    """A body in the client; `urdf` is its number there. Links that touch their parents do not collide with them."""

    def __init__(self, urdf_model: str, position: Any, orientation: Any, *, fixed: bool) -> None:
        flags = p.URDF_USE_SELF_COLLISION_EXCLUDE_ALL_PARENTS
        self.urdf: int = p.loadURDF(urdf_model, position, orientation, flags=flags, useFixedBase=fixed)
        self._link_name_to_index: dict[str, int] = {}
        self._joint_name_to_index: dict[str, int] = {}
        count = p.getNumJoints(self.urdf)
        self._lower_joint_limit, self._upper_joint_limit = np.zeros(count), np.zeros(count)
        for index in range(count):
            info = p.getJointInfo(self.urdf, index)
            self._link_name_to_index[info[12].decode("utf-8")] = index
            if info[2] == p.JOINT_FIXED:
                continue
            self._joint_name_to_index[info[1].decode("utf-8")] = index
            lower, upper = info[8:10]
            free = upper < lower  # how pybullet says that there is no limit
            self._lower_joint_limit[index], self._upper_joint_limit[index] = (
                (-np.inf, np.inf) if free else (lower, upper)
            )

    @property
    def last_link(self) -> int:
        """The link that is used where none is named: the last one in the order of the alphabet."""
        if not self._link_name_to_index:
            raise ValueError("the model has no link besides its base, so there is none to work with")
        return self._link_name_to_index[max(self._link_name_to_index)]

    def link_index(self, name: str) -> int:
        """The number of a link; TypeError unless the name is text, ValueError if there is no such link."""
        if not isinstance(name, str):
            raise TypeError(f"a link is named by text, not by {name!r}")
        if name not in self._link_name_to_index:
            raise ValueError(f"there is no link `{name}`; there are {', '.join(self._link_name_to_index)}")
        return self._link_name_to_index[name]

    def link_pose(self, index: int) -> tuple[Array, Array]:
        """Position (3,) of the centre of mass of a link and its orientation x y z w, in the world."""
        state = p.getLinkState(self.urdf, index)
        return np.array(state[0]), np.array(state[1])


def with_changes(properties: dict[str, Any], changes: Mapping[str, Any], names: Iterable[str] | None = None) -> None:
    """Put `changes` into `properties`; KeyError, with all names, for one that is not there."""
    known = list(names or properties)
    for name, value in changes.items():
        if name not in known:
            raise KeyError(f"there is no property `{name}`; there are {', '.join(known)}")
        properties[name] = value
