"""What grippers of an arm hold along a path, as far as a plan can tell, for the motors that bear it.

A gripper takes the nearest part between its fingers or under its cups, by the same contacts as in a run. Whether the
grip is firm enough only the run shows: here a part is held from the word that closes the gripper to the one that opens
it. What others bring, machines or conveyors, no plan of one program knows; where a gripper closes and no part is there,
nothing is counted, nor is what stands on a part.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np

from gcodesim.arithmetic.matrices import applied, inverse_pose, multiplied
from gcodesim.canon import Event
from gcodesim.frames import Array, Pose
from gcodesim.frozen import frozen
from gcodesim.kinematics.chain import Inertial
from gcodesim.kinematics.dynamics import merge
from gcodesim.scene import CarriedParts, Hold, PartChange, Scene
from gcodesim.shop import BODIES, skin_of
from gcodesim.solids.mass import mass_of_skin

if TYPE_CHECKING:
    from gcodesim.motion.tool_path import ToolPath
    from gcodesim.tools.gripper import Gripper

Words = Callable[[Event], float | None]
"""What an event tells grippers: above one half to close, below to open; None: nothing."""

_HALF: Final = 0.5


@frozen(eq=False)
class Grip:
    """From `row` on a gripper holds parts: `payload` in axes of F without the tool; None from where it is open."""

    row: int
    payload: Inertial | None


@frozen(eq=False)
class Grips:
    """The `grippers` of `mover` by tool number, and the parts of its `scene`; `flange` is the frame that holds them.

    `past` are the grips of earlier legs, and `load` is what they left in the gripper.
    """

    scene: Scene
    mover: str
    flange: str
    grippers: Mapping[int, Gripper]
    words: Words
    past: tuple[PartChange, ...] = ()
    load: Inertial | None = None

    def along(self, path: ToolPath, joints_before: Callable[[int], Array]) -> tuple[list[Grip], Grips]:
        """The grips along a path, whose joints (j,) before a row are known; and those with which the next leg begins.

        The first one is what is held already.
        """
        parts = CarriedParts(self.scene)
        for change in self.past:
            parts.apply(change)
        past, found, load = list(self.past), [Grip(row=0, payload=self.load)], self.load
        for noted in path.events:
            value = self.words(noted.event)
            tool = path.state_of(min(noted.row, len(path) - 1)).tool if len(path) else 0
            if value is None or tool not in self.grippers or (value > _HALF) == (load is not None):
                continue
            q = {self.mover: joints_before(noted.row)[None]}
            X_WF, step = self.scene.track(self.flange, q)[0], len(past)
            if value > _HALF:
                name = self._taken(parts, self.grippers[tool], X_WF, step, q)
                if name is None:
                    continue
                X = multiplied(inverse_pose(X_WF[None])[0], parts.poses(name, step, q)[0])
                hold = Hold(step=step, body=name, parent=self.flange, X=Pose.from_matrix(X))
                load = self._mass_of(parts, name, X)
            else:
                name = past[-1].hold.body
                X = multiplied(inverse_pose(self.scene.at_rest(BODIES).matrix[None])[0], parts.poses(name, step, q)[0])
                hold, load = Hold(step=step, body=name, parent=BODIES, X=Pose.from_matrix(X)), None
            change = PartChange(hold=hold)
            parts.apply(change)
            past.append(change)
            found.append(Grip(row=noted.row, payload=load))
        return found, replace(self, past=tuple(past), load=load)

    def _taken(
        self, parts: CarriedParts, gripper: Gripper, X_WF: Array, step: int, q: Mapping[str, Array]
    ) -> str | None:
        """The part that the gripper takes; None: there is none."""
        X_TW = inverse_pose(multiplied(X_WF, gripper.X_FT.matrix)[None])[0]
        nearest: tuple[float, str] | None = None
        for name, body in parts.bodies.items():
            skin, X_TP = skin_of(body), multiplied(X_TW, parts.poses(name, step, q)[0])
            found = gripper.contacts((applied(X_TP[:3, :3], skin.points) + X_TP[:3, 3])[skin.faces], 1.0)
            if found is not None:
                off = float(np.abs(found[0][:, :3].mean(axis=0)).max())
                nearest = min(nearest or (off, name), (off, name))
        return None if nearest is None else nearest[1]

    def _mass_of(self, parts: CarriedParts, taken: str, X_FP: Array) -> Inertial:
        """A part as a body in axes of F."""
        body = parts.bodies[taken]
        skin = skin_of(body)
        mass = mass_of_skin(skin.points, skin.faces, body.mass or 0.0)
        own = Inertial(mass=mass.mass, com=mass.center, inertia=mass.inertia)
        return merge([(own, X_FP)])
