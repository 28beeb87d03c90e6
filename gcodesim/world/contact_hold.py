"""A part between two pads of a gripper, held by nothing but contact: Coulomb's friction as Bullet solves it.

The world is the tool frame T, in which the pads do not move but press: that on the side of -X stands, the other slides
along X and is pushed by the force of a finger. What the part feels is its weight and, against its acceleration, its
inertia (d'Alembert 1743). It slides, turns between the pads and drops out as its contacts let it.
"""

from __future__ import annotations

from math import ceil
from typing import Any, Final, NamedTuple

import numpy as np

from gcodesim.arithmetic.matrices import applied, norm
from gcodesim.frames import Array, quaternion_from_rotation, rotation_from_quaternion
from gcodesim.solids.mass import MassOfSkin
from gcodesim.solids.mesh_file import Triangles
from gcodesim.tools.gripper import PadFaces

FINEST: Final = 1e-3  # [s] that a step of the engine lasts at most
SETTLING: Final = 40  # steps in which the pads press before anything pulls: contacts need some to be found
PAD_MASS: Final = 0.2  # [kg] of the pad that slides
MARGIN: Final = 1e-5  # [m] by which the engine lets shapes stand off each other
FREE: Final = 5  # steps without contact after which the part is lost
FAR: Final = 0.5  # [m] that it has gone when nothing is asked any more
OF_PADS: Final = 0.5  # coefficient that the engine gives a link; it multiplies those of two bodies
STIFFNESS: Final = 2e5  # [N/m] of each point of contact: with rigid ones the pressure would lie on any corner
DAMPING: Final = 2e3  # [N·s/m]
_SQUARE: Final = 1e-9  # [m]


class Press(NamedTuple):
    """How two `pads` press: each with `force` [N]; `friction` is the coefficient between them and the part."""

    pads: PadFaces
    force: float
    friction: float


class ContactHold:
    """A part of a `mass` and a skin that is at X_TP (4, 4) when the pads close on it; steps last `dt` [s].

    Each pad presses with a force [N], and has friction with the part.
    """

    def __init__(self, body: Triangles, mass: MassOfSkin, X_TP: Array, press: Press, dt: float) -> None:
        self._body, self._mass, self._X, self._press, self._dt = body, mass, X_TP.copy(), press, dt
        self._loads: list[Array] = []  # (3,) of each step since it was taken

    def run(self, first: int, loads: Array) -> tuple[Array, int | None]:
        """X_TP (n, 4, 4) at the ends of the steps from `first` after the taking on, under `loads` (n, 3) [N] in T.

        And the step, counted from `first`, in which it is lost; None: it is not. Steps may be asked for again: then
        everything since the taking is computed anew, so that no number depends on how steps are asked for.
        """
        from gcodesim.world.bullet import import_pybullet

        self._loads = [*self._loads[:first], *loads]
        p = import_pybullet()
        client = p.connect(p.DIRECT)
        try:
            rows, lost = _slid(p, client, self._body, self._mass, self._X, self._press, np.array(self._loads), self._dt)
        finally:
            p.disconnect(client)
        count = len(rows)
        X = np.tile(np.eye(4), (len(self._loads), 1, 1))
        X[:count, :3, :3] = rotation_from_quaternion(np.array([q for _, q in rows]))
        X[:count, :3, 3] = np.array([c for c, _ in rows]) - applied(X[:count, :3, :3], self._mass.center)
        X[count:] = X[count - 1]
        return X[first:], None if lost is None else max(lost - first, 0)


Rows = list[tuple[tuple[float, ...], tuple[float, ...]]]


def _slid(
    p: Any, client: int, body: Triangles, mass: MassOfSkin, X_TP: Array, press: Press, loads: Array, dt: float
) -> tuple[Rows, int | None]:
    """Centre of mass and quaternion at the ends of steps, and the step in which the part is lost."""
    parts = max(ceil(dt / FINEST - 1e-9), 1)
    p.setPhysicsEngineParameter(
        fixedTimeStep=dt / parts,
        numSolverIterations=200,
        deterministicOverlappingPairs=1,
        enableFileCaching=0,
        physicsClientId=client,
    )
    part = _part(p, client, body, mass, X_TP)
    fingers = _fingers(p, client, press.pads)
    for number, friction in ((part, press.friction / OF_PADS), (fingers, OF_PADS)):
        p.changeDynamics(
            number,
            -1,
            lateralFriction=friction,
            restitution=0.0,
            linearDamping=0.0,
            angularDamping=0.0,
            collisionMargin=MARGIN,
            contactStiffness=STIFFNESS,
            contactDamping=DAMPING,
            physicsClientId=client,
        )
    p.setJointMotorControl2(fingers, 0, p.VELOCITY_CONTROL, force=0.0, physicsClientId=client)

    def step(load: Array) -> None:
        p.applyExternalForce(
            fingers, 0, [-press.force, 0.0, 0.0], [0.0, 0.0, 0.0], p.LINK_FRAME, physicsClientId=client
        )
        at = p.getBasePositionAndOrientation(part, physicsClientId=client)[0]
        p.applyExternalForce(part, -1, load.tolist(), at, p.WORLD_FRAME, physicsClientId=client)
        p.stepSimulation(physicsClientId=client)

    for _ in range(SETTLING):
        step(np.zeros(3))
    start = np.array(p.getBasePositionAndOrientation(part, physicsClientId=client)[0])
    rows: Rows = []
    free = 0
    for k, load in enumerate(loads):
        for _ in range(parts):
            step(load)
            touches = p.getContactPoints(part, fingers, -1, 0, physicsClientId=client)
            free = 0 if touches else free + 1
        rows.append(p.getBasePositionAndOrientation(part, physicsClientId=client))
        if free >= FREE or norm(np.array(rows[-1][0]) - start) > FAR:
            return rows, k
    return rows, None


def _part(p: Any, client: int, body: Triangles, mass: MassOfSkin, X_TP: Array) -> int:
    """The part as the convex hull of its skin; a box stays one, since boxes touch with whole faces."""
    local = body.points - mass.center
    low, high = local.min(axis=0), local.max(axis=0)
    square = np.minimum(np.abs(local - low), np.abs(local - high)).max() < _SQUARE
    if square and norm(low + high) < _SQUARE:
        shape = p.createCollisionShape(p.GEOM_BOX, halfExtents=(0.5 * (high - low)).tolist(), physicsClientId=client)
    else:
        shape = p.createCollisionShape(p.GEOM_MESH, vertices=local.tolist(), physicsClientId=client)
    center = applied(X_TP[:3, :3], mass.center) + X_TP[:3, 3]
    number: int = p.createMultiBody(
        max(mass.mass, 1e-3),
        shape,
        basePosition=center.tolist(),
        baseOrientation=quaternion_from_rotation(X_TP[:3, :3]).tolist(),
        physicsClientId=client,
    )
    return number


def _fingers(p: Any, client: int, pads: PadFaces) -> int:
    """The pad that stands, and the one that slides on it as its link 0."""
    half = [0.5 * pads.thickness, 0.5 * pads.width, 0.5 * pads.length]
    shapes = [p.createCollisionShape(p.GEOM_BOX, halfExtents=half, physicsClientId=client) for _ in range(2)]
    left, right = pads.left - half[0], pads.right + half[0]
    number: int = p.createMultiBody(
        0.0,
        shapes[0],
        basePosition=[left, 0.0, -half[2]],
        linkMasses=[PAD_MASS],
        linkCollisionShapeIndices=[shapes[1]],
        linkVisualShapeIndices=[-1],
        linkPositions=[[right - left, 0.0, 0.0]],
        linkOrientations=[[0.0, 0.0, 0.0, 1.0]],
        linkInertialFramePositions=[[0.0, 0.0, 0.0]],
        linkInertialFrameOrientations=[[0.0, 0.0, 0.0, 1.0]],
        linkParentIndices=[0],
        linkJointTypes=[p.JOINT_PRISMATIC],
        linkJointAxis=[[1.0, 0.0, 0.0]],
        physicsClientId=client,
    )
    return number
