"""Arms: how far the tool centre point gives way under a force."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from gcodesim.arithmetic.matrices import applied, norms
from gcodesim.calculator.model import CannotComputeError, Model, Result, Value
from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import POSITIVE
from gcodesim.declarations.quantity import Quantity, Vector
from gcodesim.frozen import frozen


@frozen
class ArmCompliance(Model):
    """A shipped arm with elastic gears, at rest."""

    kind: ClassVar[str] = "robot.compliance"
    says: ClassVar[str] = "deflection of an arm's tool point under a force"
    source: ClassVar[str] = "dx = J K^-1 J^T F (Salisbury 1980, eq. 7 inverted)"
    also: ClassVar[tuple[str, ...]] = ("compliance", "arm.compliance")
    spellings: ClassVar[dict[str, str]] = {
        "tcp_offset_in_tool0": "tcp_offset", "force_base": "force", "torque_base": "torque",
        "stiffness": "joint_stiffness",
        "model": "robot",
    }  # fmt: skip
    gives: ClassVar[tuple[Result, ...]] = (
        Result("tcp", "length", "where the point is, in the base frame"),
        Result("tcp_displacement", "length", "by how much it moves", ("displacement",)),
        Result("displacement_size", "length", "the length of that"),
        Result("rotation", "angle", "by which the tool turns, a rotation vector"),
    )

    robot: str = key("text", "an arm of `gcodesim list machines`")
    joints: tuple[float, ...] = key(Vector(Quantity("angle")), "joint angles", example="[0, -90, 90, 0, 45, 0 deg]")
    tcp_offset: tuple[float, ...] = key(Vector(Quantity("length"), 3), "of the point in tool0", default=(0.0, 0.0, 0.0))
    joint_stiffness: tuple[float, ...] | None = key(
        Vector(Quantity("torsional stiffness", POSITIVE)), "of each joint (default: that of the model)", default=None
    )
    force: tuple[float, ...] = key(
        Vector(Quantity("force"), 3), "on the point, in the base frame", default=(0.0, 0.0, 0.0)
    )
    torque: tuple[float, ...] = key(Vector(Quantity("torque"), 3), "on the tool", default=(0.0, 0.0, 0.0))

    def compute(self) -> dict[str, Value]:
        from gcodesim.kinematics import MODELS, compliance, kinematics_of, load_urdf, shift_jacobian

        if self.robot not in MODELS:
            raise CannotComputeError(f"there is no robot {self.robot}; there are {', '.join(MODELS)}")
        chain, _ = load_urdf(MODELS[self.robot].path)
        assert chain is not None
        arm = kinematics_of(chain)
        q = np.array([self.joints])
        stiffness = MODELS[self.robot].stiffness if self.joint_stiffness is None else self.joint_stiffness
        if stiffness is None:
            raise CannotComputeError(f"{self.robot} has no usual stiffness; give `joint_stiffness`")
        count = len(arm.chain.driven)
        for what, values in (("joints", self.joints), ("joint_stiffness", stiffness)):
            if len(values) != count:
                raise CannotComputeError(f"`{what}` has {len(values)} entries; {self.robot} has {count} joints")
        X = arm.forward(q)
        p = np.array(self.tcp_offset)
        J = shift_jacobian(arm.jacobian(q), X, p)
        moved = applied(compliance(J, np.array(stiffness)), np.array([*self.force, *self.torque]))[0]
        tip = X[0, :3, 3] + applied(X[:, :3, :3], p)[0]
        return {
            "tcp": tip.tolist(),
            "tcp_displacement": moved[:3].tolist(),
            "displacement_size": float(norms(moved[None, :3])[0]),
            "rotation": moved[3:].tolist(),
        }
