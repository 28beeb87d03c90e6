"""The efforts that a motion takes: inverse dynamics with gravity, payload and process wrench."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, Final

import numpy as np

from gcodesim.arithmetic.matrices import applied, dot, multiplied
from gcodesim.frames import Array
from gcodesim.kinematics.chain import Chain, Inertial
from gcodesim.kinematics.machine import rows

if TYPE_CHECKING:
    from gcodesim.kinematics.dynamics_kernels import MovedBodies

GRAVITY: Final = (0.0, 0.0, -9.80665)  # [m/s²] in base axes of an upright robot (CGPM 1901)


def merge(parts: list[tuple[Inertial, Array]]) -> Inertial:
    """One body from parts, each posed by a matrix (4, 4) in the common frame (Steiner's theorem)."""
    mass = sum(part.mass for part, _ in parts)
    centres = [applied(X[:3, :3], part.com) + X[:3, 3] for part, X in parts]
    if mass <= 0.0:
        return Inertial(mass=0.0, com=np.zeros(3), inertia=np.zeros((3, 3)))
    com = sum((part.mass * c for (part, _), c in zip(parts, centres, strict=True)), start=np.zeros(3)) / mass
    inertia = np.zeros((3, 3))
    for (part, X), centre in zip(parts, centres, strict=True):
        d = centre - com
        R = X[:3, :3]
        inertia += multiplied(R, part.inertia, R.T) + part.mass * (dot(d, d) * np.eye(3) - np.outer(d, d))
    return Inertial(mass=mass, com=com, inertia=inertia)


def bodies(chain: Chain, payload: Inertial | None = None) -> list[Inertial]:
    """What each driven joint moves by itself, in its axes: its links, and `payload` (axes of F) on the last one."""
    tree = chain.tree
    parts: list[list[tuple[Inertial, Array]]] = [[] for _ in tree.parent]
    for link, carrier, offset in zip(chain.links, tree.carrier, tree.offset, strict=True):
        if carrier >= 0 and link.inertial is not None:
            parts[carrier].append((link.inertial, offset))
    if payload is not None and tree.flange_carrier >= 0:
        parts[tree.flange_carrier].append((payload, tree.flange_offset))
    return [merge(part) for part in parts]


@lru_cache(maxsize=32)
def moved_bodies(chain: Chain, payload: Inertial | None) -> MovedBodies:
    """`bodies` in the form for kernels; a run asks for those of the same tool again and again."""
    from gcodesim.kinematics.dynamics_kernels import MovedBodies

    moved = bodies(chain, payload)
    return MovedBodies(
        np.array([b.mass for b in moved], dtype=np.float64),
        np.array([b.com for b in moved]),
        np.array([b.inertia for b in moved]),
    )


def inverse_dynamics(
    chain: Chain,
    q: Array,
    qd: Array | float,
    qdd: Array | float,
    payload: Inertial | None = None,
    wrench: Array | None = None,
    *,
    p_FT: Array | tuple[float, float, float] = (0.0, 0.0, 0.0),
    gravity: Array | tuple[float, float, float] = GRAVITY,
) -> Array:
    """Efforts (n, j) [N·m], [N] that the drives give along q, qd, qdd (n, j).

    `payload` is the tool: mass, centre of mass and inertia about it in axes of F.
    `wrench` (n, 6) acts on the tool at the tip `p_FT` (3,) [m] in F, force [N]
    then torque [N·m], base axes; `gravity` (3,) [m/s²] in base axes. Recursive
    Newton–Euler (Luh, Walker, Paul 1980). Friction and the rotors' own inertia
    are left out, and so are links without <inertial>.
    """
    from gcodesim.kinematics.dynamics_kernels import efforts_along

    q = rows(q)
    qd, qdd = (rows(np.broadcast_to(v, q.shape)) for v in (qd, qdd))
    w = rows(np.broadcast_to(0.0 if wrench is None else wrench, (len(q), 6)))
    out = np.empty_like(q)
    down = np.array(gravity, dtype=np.float64)
    efforts_along(q, qd, qdd, w, down, moved_bodies(chain, payload), chain.tree, _tip(chain, p_FT), out)
    return out


def efforts_of(
    chain: Chain,
    q: Array,
    qd: Array,
    qdd: Array,
    payload: Inertial | None = None,
    wrench: Array | None = None,
    *,
    p_FT: Array | tuple[float, float, float] = (0.0, 0.0, 0.0),
    gravity: Array | tuple[float, float, float] = GRAVITY,
) -> Array:
    """`inverse_dynamics` (m, n, j) of m motions qd, qdd (m, n, j) through the same joints q (n, j)."""
    from gcodesim.kinematics.motion_effort_kernels import efforts_of_motions

    w = np.zeros((1, 6)) if wrench is None else rows(wrench)
    out = np.empty(qd.shape)
    down = np.array(gravity, dtype=np.float64)
    efforts_of_motions(rows(q), qd, qdd, w, down, moved_bodies(chain, payload), chain.tree, _tip(chain, p_FT), out)
    return out


def _tip(chain: Chain, p_FT: Array | tuple[float, float, float]) -> Array:
    """The tip (4, 4) seen from the joint that carries the flange."""
    X_FT = np.eye(4)
    X_FT[:3, 3] = p_FT
    return np.ascontiguousarray(multiplied(chain.tree.flange_offset, X_FT))
