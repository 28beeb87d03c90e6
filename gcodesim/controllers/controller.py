"""What every controller has in common, and what one's own may do."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any, ClassVar, Literal, Self

import numpy as np
from numpy.typing import NDArray

from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import NOT_NEGATIVE, POSITIVE, Json
from gcodesim.declarations.nodes import Node, Scalar
from gcodesim.declarations.quantity import Quantity, Vector
from gcodesim.declarations.reading import Path, Reading, Unread
from gcodesim.frames import Array
from gcodesim.frozen import frozen

Law = Literal["ideal", "placed", "servo", "computed", "given"]
"""Who decides what motors do: nobody (they are where they are to be); see `world.drive_kernels` for the others."""


@frozen(kw_only=False)
class PerJoint(Vector):
    """One value a joint, or one value for all of them; the unit of the last holds for those without one."""

    @property
    def expected(self) -> str:
        return f"one value for all joints, or one a joint, such as `[{self._example()}]`"

    def read(self, node: Node, to: Reading, path: Path) -> tuple[float, ...] | Unread:
        if isinstance(node, Scalar) and not node.empty:
            value = self.of.read(node, to, path)
            return value if isinstance(value, Unread) else (value,)
        return Vector.read(self, node, to, path)

    def schema(self, definitions: dict[str, Json]) -> Json:
        return {"anyOf": [self.of.schema(definitions), Vector.schema(self, definitions)]}


@frozen(eq=False)
class RobotModel:
    """The robot as its controller knows it, with the tool on its flange. SI, base axes.

    `jacobian(q)` (6, j) at the tip, v then w; `mass(q)` (j, j); `efforts(q, qd, qdd)` (j,) with gravity; `gears` (j,)
    is the stiffness of the gears [N·m/rad, N/m], infinite where they are rigid; `rotors` (j,) is the
    inertia of the rotors [kg·m², kg], which is no part of `mass` and `efforts`; `limit` (j,) what motors can give.
    """

    jacobian: Callable[[Array], Array]
    mass: Callable[[Array], Array]
    efforts: Callable[[Array, Array, Array], Array]
    gears: Array
    rotors: Array
    limit: Array


@frozen(eq=False)
class Sense:
    """What a controller knows at the beginning of a step of `dt` [s], at `time` [s] since the world was opened.

    reference: `q_ref`, `qd_ref`, `qdd_ref` (j,) for the end of the step; state: `q`, `qd` (j,) of the motors, without
    what gravity winds up in the gears; `wrench` (6,): mean force [N] and torque [N·m] that the process had on the tool
    at the tip during the last step, base axes, as a sensor in the flange measures it. `memory` is the
    controller's own; it is empty when the robot is put somewhere.
    """

    time: float
    dt: float
    q_ref: Array
    qd_ref: Array
    qdd_ref: Array
    q: Array
    qd: Array
    wrench: Array
    model: RobotModel
    memory: dict[str, Any]


@frozen(slots=False, eq=False)
class Controller:
    """How the motors of a robot follow the command; keys of the cell file are fields declared by `key(…)`.

    One's own overrides `aim` (the law of its base class then follows what it returns), or, with the law `given`,
    `torques`. What it wants to remember it keeps in `sense.memory`. Equal input has to give equal numbers.
    """

    kind: ClassVar[str]
    law: ClassVar[Law]

    rotor_inertia: tuple[float, ...] = key(
        PerJoint(Quantity("moment of inertia", NOT_NEGATIVE)),
        "of the rotors, seen from the links",
        default=(),
        rule="what the motor at its limit accelerates by 500 rad/s²",
        quiet=True,
        example="[8, 8, 3, 0.4, 0.4, 0.1 kg·m^2]",
    )
    friction: tuple[float, ...] = key(
        PerJoint(Quantity("torque", NOT_NEGATIVE)),
        "Coulomb friction of motors and gears",
        default=(),
        quiet=True,
        example="[20, 20, 12, 4, 4, 2 N·m]",
    )
    viscous_friction: tuple[float, ...] = key(
        PerJoint(Quantity("torque", NOT_NEGATIVE)),
        "friction that grows with the speed, at the greatest speed of the joint",
        default=(),
        quiet=True,
        example="[30, 30, 15, 6, 6, 3 N·m]",
    )
    gear_damping: float = key(
        Quantity("time", NOT_NEGATIVE),
        "damping of a gear over its stiffness; 2 ms is 10 % of critical damping at 16 Hz",
        default=2e-3,
        quiet=True,
    )

    def aim(self, sense: Sense) -> Array:
        """Where motors are to be (j,) at the end of the step; once a step. Default: the reference."""
        return sense.q_ref

    def torques(self, sense: Sense) -> Array:
        """Torques (j,) [N·m, N] of the motors during the step; asked only where `law` is `given`."""
        raise NotImplementedError(f"{type(self).__name__} has the law `given` and no `torques`")

    @property
    def aims(self) -> bool:
        """Whether it changes the reference."""
        return type(self).aim is not Controller.aim

    @property
    def ahead(self) -> bool:
        """Whether motors turn further by what the commanded motion winds up in their gears, not by gravity's alone."""
        return False

    def of_joints(self, own: NDArray[np.intp], count: int) -> Self:
        """The same for `count` joints, of which its lists mean those at `own` and have 0 for others.

        A servo stiffness of 0 stands for what `bandwidth` gives. Lists of one value hold for all joints anyway.
        """
        lists = {name: np.array(values) for name, values in self.lists().items() if len(values) == len(own)}
        spread = {name: np.zeros(count) for name in lists}
        for name, values in lists.items():
            spread[name][own] = values
        changes: dict[str, Any] = {name: tuple(values.tolist()) for name, values in spread.items()}
        return replace(self, **changes)

    def lists(self) -> dict[str, tuple[float, ...]]:
        """The keys that have one value a joint, by name; empty ones are not given."""
        return {
            "rotor_inertia": self.rotor_inertia,
            "friction": self.friction,
            "viscous_friction": self.viscous_friction,
        }


@frozen(slots=False, eq=False)
class Servo(Controller):
    """A controller with a position loop: as stiff as given, or as fast."""

    stiffness: tuple[float, ...] = key(
        PerJoint(Quantity("torsional stiffness", POSITIVE)),
        "torque per error in the posture `home`; none: from `bandwidth`",
        default=(),
        example="[2e5, 2e5, 6e4, 2000, 2000, 500 N·m/rad]",
    )
    bandwidth: float = key(
        Quantity("frequency", POSITIVE), "natural frequency of each joint in the posture `home`", default=50.0
    )
    damping: float = key(
        Quantity("ratio", NOT_NEGATIVE), "of the loop, as a share of critical damping", default=1.0, example="0.7"
    )

    def lists(self) -> dict[str, tuple[float, ...]]:
        return {**Controller.lists(self), "stiffness": self.stiffness}
