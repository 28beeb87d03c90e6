"""Chamfer mill: a cone with a flat tip below a cylinder."""

from __future__ import annotations

from typing import ClassVar

from gcodesim.declarations.keys import key
from gcodesim.frozen import frozen
from gcodesim.tools.conical_cutter import ConicalCutter
from gcodesim.units import DEG


@frozen
class ChamferMill(ConicalCutter):
    """A chamfer mill; the cone and the cylinder above it have edges."""

    kind: ClassVar[str] = "chamfer_mill"

    angle: float = key("angle", "included angle of the cone, edge to edge", default=90.0 * DEG, rule="90 deg")
