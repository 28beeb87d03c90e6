"""Machines: pose to joints and back, with one file for each family. Knows no time and no material.

Names load on first use: reading a URDF needs no compiler.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from gcodesim.family import Family

if TYPE_CHECKING:
    from gcodesim.kinematics.cartesian import Axis, Cartesian, chain_of_axes
    from gcodesim.kinematics.chain import Chain, Inertial, Joint, Joints, Link, LinkShape, LinkSolid
    from gcodesim.kinematics.choice import kinematics_of
    from gcodesim.kinematics.dynamics import inverse_dynamics
    from gcodesim.kinematics.elasticity import compliance, shift_jacobian
    from gcodesim.kinematics.models import MODELS, ShippedModel, model_path
    from gcodesim.kinematics.parallel_axes import ParallelAxes
    from gcodesim.kinematics.protocol import Kinematics, Reason, Status
    from gcodesim.kinematics.serial import SerialArm
    from gcodesim.kinematics.spherical_wrist import SphericalWrist
    from gcodesim.kinematics.urdf import load_urdf

# `kinematics_of` asks each whether a chain is its own
KINEMATICS = Family(
    "kinematics",
    cartesian="gcodesim.kinematics.cartesian:Cartesian",
    parallel_axes="gcodesim.kinematics.parallel_axes:ParallelAxes",
    spherical_wrist="gcodesim.kinematics.spherical_wrist:SphericalWrist",
    serial="gcodesim.kinematics.serial:SerialArm",
)

_PLACES = {
    "Axis": "cartesian",
    "Cartesian": "cartesian",
    "Chain": "chain",
    "Inertial": "chain",
    "Joint": "chain",
    "Joints": "chain",
    "Kinematics": "protocol",
    "Link": "chain",
    "LinkShape": "chain",
    "MODELS": "models",
    "ShippedModel": "models",
    "ParallelAxes": "parallel_axes",
    "Reason": "protocol",
    "SerialArm": "serial",
    "LinkSolid": "chain",
    "SphericalWrist": "spherical_wrist",
    "Status": "protocol",
    "chain_of_axes": "cartesian",
    "compliance": "elasticity",
    "inverse_dynamics": "dynamics",
    "kinematics_of": "choice",
    "load_urdf": "urdf",
    "model_path": "models",
    "shift_jacobian": "elasticity",
}


def __getattr__(name: str) -> Any:
    if name not in _PLACES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"gcodesim.kinematics.{_PLACES[name]}"), name)


__all__ = [
    "KINEMATICS",
    "MODELS",
    "Axis",
    "Cartesian",
    "Chain",
    "Inertial",
    "Joint",
    "Joints",
    "Kinematics",
    "Link",
    "LinkShape",
    "LinkSolid",
    "ParallelAxes",
    "Reason",
    "SerialArm",
    "ShippedModel",
    "SphericalWrist",
    "Status",
    "chain_of_axes",
    "compliance",
    "inverse_dynamics",
    "kinematics_of",
    "load_urdf",
    "model_path",
    "shift_jacobian",
]
