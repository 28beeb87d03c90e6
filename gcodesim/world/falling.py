"""How a part that nobody holds comes down: straight in the kinematic world, as a free body in `bullet`.

Nothing but the part moves meanwhile; what it may hit stands as it does in the step in which the part is let go.
"""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any, Final, NamedTuple, Protocol

import numpy as np

from gcodesim.arithmetic.matrices import applied, norm
from gcodesim.frames import Array, Pose, quaternion_from_rotation, rotation_from_quaternion
from gcodesim.solids.mass import MassOfSkin
from gcodesim.solids.mesh_file import Triangles
from gcodesim.solids.resting import Ground, gap_below

LONGEST: Final = 4.0  # s; what rolls for longer is stopped
CALM: Final = 0.1  # s of rest after which a body lies
SLOW: Final = 2e-3  # m/s, and rad/s of a body that is at rest
MARGIN: Final = 1e-5  # m by which the engine lets shapes stand off each other
ROUGHNESS: Final = 0.5  # friction between falling parts and everything else
_LEVEL: Final = 5e-3  # m by which a body may hang above its support after a fall, from the tolerances of the engine

_BOX_FACES: Final = (
    *((0, 2, 1), (1, 2, 3), (4, 5, 6), (5, 7, 6), (0, 1, 4), (1, 5, 4)),
    *((2, 6, 3), (3, 6, 7), (0, 4, 2), (2, 4, 6), (1, 3, 5), (3, 7, 5)),
)


class Drop(NamedTuple):
    """A part that begins to fall: its skin `body` in P, at `X_W` (4, 4) with `velocity` (3,) [m/s].

    `height` [m] is its way straight down. `boxes` (b, 2, 3) [m] in P stand for it in the engine; None: the convex hull
    of its skin.
    """

    body: Triangles
    mass: MassOfSkin
    X_W: Array
    velocity: Array
    height: float
    boxes: Array | None = None


class FallOf(Protocol):
    """X_WP (n, 4, 4) of a part at the ends of the steps of its fall, `dt` [s] each; the last is where it lies."""

    def __call__(self, drop: Drop, ground: Ground, gravity: Array, dt: float) -> Array: ...


def straight_down(drop: Drop, ground: Ground, gravity: Array, dt: float) -> Array:
    """By the rule of the kinematic world: it keeps its attitude, falls freely by `height`, and lies where it lands."""
    pull, height, X_W = norm(gravity), drop.height, drop.X_W
    steps = max(int(np.ceil(np.sqrt(2.0 * height / pull) / dt)), 1)
    t = dt * np.arange(1, steps + 1)
    X = np.tile(X_W, (steps, 1, 1))
    X[:, 2, 3] -= np.minimum(0.5 * pull * (t * t), height)
    X[-1, 2, 3] = X_W[2, 3] - height
    return X


def free_fall(drop: Drop, ground: Ground, gravity: Array, dt: float) -> Array:
    """As a free body in a world of its own, until it lies still."""
    from gcodesim.world.bullet import import_pybullet

    p = import_pybullet()
    client = p.connect(p.DIRECT)
    try:
        with tempfile.TemporaryDirectory(prefix="gcodesim-") as scratch:
            rows = _fallen(p, client, drop, ground, gravity, dt, Path(scratch))
    finally:
        p.disconnect(client)
    X = np.tile(np.eye(4), (len(rows), 1, 1))
    X[:, :3, :3] = rotation_from_quaternion(np.array([q for _, q in rows]))
    X[:, :3, 3] = np.array([c for c, _ in rows]) - applied(X[:, :3, :3], drop.mass.center)
    left, _ = gap_below(drop.body.moved(Pose.from_matrix(X[-1])), ground)
    if left <= _LEVEL:
        X[-1, 2, 3] -= left
    return X


def _fallen(
    p: Any, client: int, drop: Drop, ground: Ground, gravity: Array, dt: float, scratch: Path
) -> list[tuple[tuple[float, ...], tuple[float, ...]]]:
    """Centre of mass and quaternion at the ends of the steps; `scratch` is a folder for files."""
    p.setPhysicsEngineParameter(
        fixedTimeStep=dt, numSubSteps=4, deterministicOverlappingPairs=1, enableFileCaching=0, physicsClientId=client
    )
    p.setGravity(*gravity.tolist(), physicsClientId=client)
    plane = p.createCollisionShape(p.GEOM_PLANE, planeNormal=[0, 0, 1], physicsClientId=client)
    standing = [p.createMultiBody(0.0, plane, basePosition=[0.0, 0.0, ground.floor], physicsClientId=client)]
    for skin in ground.others.values():
        shape = p.createCollisionShape(
            p.GEOM_MESH,
            vertices=skin.points.tolist(),
            indices=skin.faces.ravel().tolist(),
            flags=p.GEOM_FORCE_CONCAVE_TRIMESH,
            physicsClientId=client,
        )
        standing.append(p.createMultiBody(0.0, shape, physicsClientId=client))
    mass, X_W = drop.mass, drop.X_W
    center = applied(X_W[:3, :3], mass.center) + X_W[:3, 3]
    part = p.createMultiBody(
        max(mass.mass, 1e-3),
        _shape(p, client, drop, scratch),
        basePosition=center.tolist(),
        baseOrientation=quaternion_from_rotation(X_W[:3, :3]).tolist(),
        physicsClientId=client,
    )
    for number in (part, *standing):
        p.changeDynamics(number, -1, lateralFriction=ROUGHNESS, collisionMargin=MARGIN, physicsClientId=client)
    p.resetBaseVelocity(part, drop.velocity.tolist(), [0.0, 0.0, 0.0], physicsClientId=client)
    rows: list[tuple[tuple[float, ...], tuple[float, ...]]] = []
    calm = 0
    for _ in range(int(LONGEST / dt)):
        p.stepSimulation(physicsClientId=client)
        rows.append(p.getBasePositionAndOrientation(part, physicsClientId=client))
        v, w = p.getBaseVelocity(part, physicsClientId=client)
        calm = calm + 1 if norm(np.array(v)) < SLOW and norm(np.array(w)) < SLOW else 0
        if calm * dt >= CALM:
            break
    return rows


def _shape(p: Any, client: int, drop: Drop, scratch: Path) -> int:
    """The collision shape of a part about its centre of mass."""
    if drop.boxes is None or not len(drop.boxes):
        local = drop.body.points - drop.mass.center
        return int(p.createCollisionShape(p.GEOM_MESH, vertices=local.tolist(), physicsClientId=client))
    path = scratch / "boxes.obj"  # as arguments, the engine takes no more than 16
    path.write_text("".join(_obj_lines(drop.boxes - drop.mass.center)), encoding="ascii")
    return int(p.createCollisionShape(p.GEOM_MESH, fileName=str(path), physicsClientId=client))


def _obj_lines(boxes: Array) -> list[str]:
    """Boxes (b, 2, 3), each an object of a Wavefront file, which the engine takes as a convex body."""
    lines = []
    for number, box in enumerate(boxes):
        lines.append(f"o box{number}\n")
        corners = [(box[i & 1, 0], box[i >> 1 & 1, 1], box[i >> 2, 2]) for i in range(8)]
        lines += [f"v {x:.9e} {y:.9e} {z:.9e}\n" for x, y, z in corners]
        first = 8 * number + 1
        lines += [f"f {first + a} {first + b} {first + c}\n" for a, b, c in _BOX_FACES]
    return lines


def fall_of(world: str) -> FallOf:
    """How parts fall in the world of this name."""
    return free_fall if world == "bullet" else straight_down
