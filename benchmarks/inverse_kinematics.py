"""Speed of inverse kinematics along a path, against pybullet's own on the same poses in the same run.

    python -m benchmarks.inverse_kinematics [POSES]

Prints poses a second (best of five), the ratio to `calculateInverseKinematics`
with its defaults on 2000 of the poses, and the greatest position error of each.
"""

from __future__ import annotations

import sys
import time

import numpy as np
import pybullet

from gcodesim.frames import Array, quaternion_from_rotation
from gcodesim.kinematics import MODELS, Kinematics, SerialArm, kinematics_of, load_urdf
from gcodesim.units import MM

ARM = "kuka_kr10_r1100_2"


def path(count: int, home: Array) -> Array:
    """A smooth joint path (count, 6) that swings every joint by 23 deg."""
    s = np.linspace(0.0, 1.0, count)[:, None]
    swing: Array = home + 0.4 * np.sin(s * np.array([2.0, 4.0, 6.0, 8.0, 10.0, 12.0]))
    return swing


def ours(kinematics: Kinematics, X: Array, home: Array) -> tuple[float, float]:
    """Poses a second and the greatest error [m]."""
    kinematics.inverse(X[:2], home)
    spent = []
    for _ in range(5):
        begin = time.perf_counter()
        q, _ = kinematics.inverse(X, home)
        spent.append(time.perf_counter() - begin)
    return len(X) / min(spent), float(np.abs(kinematics.forward(q) - X)[:, :3, 3].max())


def theirs(X: Array, home: Array, kinematics: Kinematics) -> tuple[float, float]:
    """The same of pybullet, each pose from its answer to the one before."""
    client = pybullet.connect(pybullet.DIRECT)
    body = pybullet.loadURDF(str(MODELS[ARM].path), useFixedBase=True, physicsClientId=client)
    flange = pybullet.getNumJoints(body, physicsClientId=client) - 1
    for i, value in enumerate(home):
        pybullet.resetJointState(body, i, value, physicsClientId=client)
    poses = list(zip(X[:, :3, 3].tolist(), quaternion_from_rotation(X[:, :3, :3]).tolist(), strict=True))
    q, spent = [], 0.0
    for p, orientation in poses:
        begin = time.perf_counter()
        found = pybullet.calculateInverseKinematics(body, flange, p, orientation, physicsClientId=client)
        spent += time.perf_counter() - begin
        for i, value in enumerate(found):  # the next pose starts from here; not counted
            pybullet.resetJointState(body, i, value, physicsClientId=client)
        q.append(found)
    pybullet.disconnect(client)
    return len(X) / spent, float(np.abs(kinematics.forward(np.array(q)) - X)[:, :3, 3].max())


def main(count: int = 200_000) -> None:
    chain, _ = load_urdf(MODELS[ARM].path)
    assert chain is not None
    home = np.array(MODELS[ARM].home)
    closed, numeric = kinematics_of(chain), SerialArm(chain=chain)
    X = closed.forward(path(count, home))
    base, base_error = theirs(X[:: max(1, count // 2000)], home, closed)
    print(f"{'pybullet':24} {base:12,.0f} poses/s            {base_error / MM:10.2e} mm")
    for name, kinematics in (("closed form", closed), ("numeric", numeric)):
        rate, error = ours(kinematics, X, home)
        print(f"{name:24} {rate:12,.0f} poses/s  {rate / base:6.1f} x  {error / MM:10.2e} mm")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
