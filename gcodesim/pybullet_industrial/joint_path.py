"""`JointPath`: joint vectors one after the other, by the names of the joints."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from gcodesim.frames import Array


class JointPath:
    """n joint vectors: `joint_values` (j, n) [rad, m] of the joints `joint_order`, `tool_activations` (n,), all off.

    ValueError when the numbers of joints, or of poses and activations, differ. Iterating gives a dictionary of joints
    and the activation.
    """

    def __init__(self, joint_values: Array, joint_order: Sequence[str], tool_activations: ArrayLike | None = None):
        rows, count = joint_values.shape
        if rows != len(joint_order):
            raise ValueError(f"{rows} rows of joint values do not fit {len(joint_order)} joints")
        activations: Any = np.zeros(count, dtype=bool) if tool_activations is None else tool_activations
        if len(activations) != count:
            raise ValueError(f"{len(activations)} tool activations do not fit {count} joint vectors")
        self.joint_values, self.joint_order, self.tool_activations = joint_values, list(joint_order), activations

    def offset(self, offsets: Mapping[str, float]) -> None:
        """Add an offset [rad, m] to each joint named; other names are left alone."""
        for row, name in zip(self.joint_values, self.joint_order, strict=True):
            row += offsets.get(name, 0)

    def append(self, joint_path: JointPath) -> None:
        """Put another path after this one; ValueError unless its joints have the same order."""
        self._join(self, joint_path)

    def prepend(self, joint_path: JointPath) -> None:
        """Put another path before this one; ValueError unless its joints have the same order."""
        self._join(joint_path, self)

    def get_joint_configuration(self, index: int) -> dict[str, Any]:
        """The joint vector at `index` by the names of the joints."""
        return dict(zip(self.joint_order, self.joint_values[:, index], strict=True))

    def _join(self, first: JointPath, second: JointPath) -> None:
        if first.joint_order != second.joint_order:
            raise ValueError(f"joints {first.joint_order} and {second.joint_order} are not in the same order")
        self.joint_values, self.tool_activations = (
            np.concatenate([first.joint_values, second.joint_values], axis=1),
            np.concatenate([first.tool_activations, second.tool_activations]),
        )

    def __len__(self) -> int:
        return int(self.joint_values.shape[1])

    def __iter__(self) -> JointPath:
        self.current_index = 0
        return self

    def __next__(self) -> tuple[dict[str, Any], Any]:
        at = self.current_index
        if at >= len(self):
            raise StopIteration
        self.current_index = at + 1
        return self.get_joint_configuration(at), self.tool_activations[at]
