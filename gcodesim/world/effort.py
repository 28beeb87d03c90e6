"""What the motors have to give along a path: Newton and Euler from the base to the tool and back.

The recursion of Luh, Walker and Paul 1980 (ASME J. Dyn. Sys. Meas. Control 102,
69), in base axes and for all steps at once. Links are rigid; friction, gears
and rotors of the motors are not in it.
"""

from __future__ import annotations

import numpy as np

from gcodesim.frames import Array
from gcodesim.kinematics.machine import Machine
from gcodesim.world.body import ToolBody
from gcodesim.world.model import MassSum, carried_masses, tool_mass


def motor_efforts(
    machine: Machine, tool: ToolBody | None, q: Array, qd: Array, qdd: Array, wrench: Array, gravity_B: Array
) -> Array:
    """Efforts (n, j) of the driven joints [N·m, N] for positions, velocities and accelerations (n, j).

    `wrench` (n, 6) acts on the tool at the tip (without a tool at the flange),
    base axes; `gravity_B` (3,) [m/s²] in base axes.
    """
    chain, tree = machine.chain, machine.chain.tree
    n, count = q.shape
    masses = carried_masses(chain)
    p_LT = tree.flange_offset[:3, 3]
    if tool is not None:
        masses[tree.flange_carrier] = MassSum.of(
            [masses[tree.flange_carrier], tool_mass(tool).seen_from(tree.flange_offset)]
        )
        p_LT = (tree.flange_offset @ tool.X_FT.matrix)[:3, 3]
    places = {name: index for index, name in enumerate(machine.link_names)}
    moved = [places[chain.joints[i].child] for i in chain.driven]
    X = machine.links(q)[:, moved]
    axis = np.einsum("njab,jb->nja", X[:, :, :3, :3], tree.axis)

    # outwards: angular velocity, angular acceleration, acceleration of each joint frame; the base falls upwards
    omega, alpha, a = np.zeros((count, n, 3)), np.zeros((count, n, 3)), np.zeros((count, n, 3))
    force, moment = np.zeros((count, n, 3)), np.zeros((count, n, 3))
    still, lift = np.zeros((n, 3)), np.broadcast_to(-gravity_B, (n, 3))
    for i in range(count):
        parent = int(tree.parent[i])
        w, e, base_a = (still, still, lift) if parent < 0 else (omega[parent], alpha[parent], a[parent])
        p = X[:, i, :3, 3]
        arm = p if parent < 0 else p - X[:, parent, :3, 3]
        v, dv = axis[:, i] * qd[:, i, None], axis[:, i] * qdd[:, i, None]
        a[i] = base_a + np.cross(e, arm) + np.cross(w, np.cross(w, arm))
        if tree.prismatic[i]:
            omega[i], alpha[i] = w, e
            a[i] += 2.0 * np.cross(w, v) + dv
        else:
            omega[i], alpha[i] = w + v, e + dv + np.cross(w, v)
        body, R = masses[i], X[:, i, :3, :3]
        c = R @ body.com
        inertia = R @ body.inertia @ R.transpose(0, 2, 1)
        force[i] = body.mass * (a[i] + np.cross(alpha[i], c) + np.cross(omega[i], np.cross(omega[i], c)))
        spin = np.einsum("nij,nj->ni", inertia, omega[i])
        moment[i] = np.einsum("nij,nj->ni", inertia, alpha[i]) + np.cross(omega[i], spin) + np.cross(c, force[i])
        if i == tree.flange_carrier:
            tip = R @ p_LT
            force[i] -= wrench[:, :3]
            moment[i] -= np.cross(tip, wrench[:, :3]) + wrench[:, 3:]

    # inwards: force and moment about the joint's own origin, handed on to the parent
    effort = np.empty((n, count))
    for i in range(count - 1, -1, -1):
        z, parent = axis[:, i], int(tree.parent[i])
        effort[:, i] = np.einsum("ni,ni->n", z, force[i] if tree.prismatic[i] else moment[i])
        if parent >= 0:
            arm = X[:, i, :3, 3] - X[:, parent, :3, 3]
            force[parent] += force[i]
            moment[parent] += moment[i] + np.cross(arm, force[i])
    return effort
