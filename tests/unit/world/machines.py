"""Machines and tools that the tests of the worlds share."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from gcodesim.kinematics.chain import Chain
from gcodesim.kinematics.urdf import load_urdf
from gcodesim.world import ToolBody

DATA = Path(__file__).parents[2] / "data" / "world"
STEP_NS = 4_000_000

# spindle of 3 kg, its centre of mass off the axis and its principal axes turned
SPINDLE = ToolBody(
    name="spindle", length=0.15, mass=3.0, com=(0.01, 0.02, 0.08), inertia=(0.010, 0.012, 0.004, 0.001, 0.002, -0.001)
)


def machine(name: str) -> Chain:
    """`kr10` (six revolute joints) or `router` (three prismatic joints)."""
    chain, findings = load_urdf(DATA / f"{name}.urdf")
    assert chain is not None and not findings, findings
    return chain


def rest(chain: Chain) -> np.ndarray:
    """A joint vector well inside the travel."""
    return np.radians([10.0, -80.0, 100.0, 20.0, 70.0, 30.0]) if len(chain.driven) == 6 else np.array([0.6, 0.4, -0.2])


def swing(chain: Chain, n: int, size: float = 0.1) -> np.ndarray:
    """A smooth motion (n, j) from `rest`, every joint at its own pace."""
    t = np.arange(1, n + 1)[:, None] * STEP_NS * 1e-9
    pace = 1.0 + 0.1 * np.arange(len(chain.driven))
    return rest(chain) + size * (1.0 - np.cos(t * pace))
