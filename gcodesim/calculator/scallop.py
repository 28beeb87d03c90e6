"""Ridges between passes of a ball or a bull nose, and the step-over for a wanted height."""

from __future__ import annotations

from math import sqrt
from typing import ClassVar

from gcodesim.arithmetic.elementary import asin, cos
from gcodesim.calculator.model import CannotComputeError, Model, Result, Value
from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import POSITIVE
from gcodesim.declarations.plain_kinds import Choice
from gcodesim.declarations.quantity import Quantity
from gcodesim.frozen import frozen
from gcodesim.units import MM

_LENGTH = Quantity("length", POSITIVE)


@frozen
class Scallop(Model):
    """Two passes side by side on a flat face: circles of the edge's radius, one step-over apart along the face."""

    kind: ClassVar[str] = "scallop"
    says: ClassVar[str] = "ridges between passes of a ball or bull nose, and the step-over for a height"
    source: ClassVar[str] = "h = R - sqrt(R^2 - (s/2)^2), s along the face less the flat of a bull nose"
    also: ClassVar[tuple[str, ...]] = ("milling.scallop", "scallop_height", "cusp", "cusp_height", "step_over")
    spellings: ClassVar[dict[str, str]] = {
        "D": "diameter", "d": "diameter", "s": "step_over", "stepover": "step_over", "ae": "step_over",
        "step": "step_over", "h": "scallop_height", "scallop": "scallop_height", "cusp_height": "scallop_height",
        "cusp": "scallop_height", "r": "corner_radius", "angle": "slope",
    }  # fmt: skip
    gives: ClassVar[tuple[Result, ...]] = (
        Result("scallop_height", "length", "of the ridges, across the face", ("h", "cusp_height", "scallop")),
        Result("step_over", "length", "seen along the tool", ("s", "stepover", "ae")),
        Result("mean_height", "length", "of what is left, over the face"),
    )

    diameter: float = key(_LENGTH, "of the tool", example="10 mm")
    type: str = key(Choice(("ball", "bull")), "edge", default="ball")
    corner_radius: float | None = key(_LENGTH, "of a bull nose", default=None)
    step_over: float | None = key(_LENGTH, "seen along the tool; or `scallop_height`", default=None, example="0.5 mm")
    scallop_height: float | None = key(_LENGTH, "that is wanted", default=None)
    slope: float = key("angle", "of the face, up which the passes are set over; for a ball", default=0.0)

    def compute(self) -> dict[str, Value]:
        radius, flat = self._edge()
        lean = cos(self.slope)
        if not 0.0 < lean <= 1.0:
            raise CannotComputeError("`slope` has to be below 90°")
        if (self.step_over is None) == (self.scallop_height is None):
            raise CannotComputeError("give either `step_over` or the `scallop_height` that is wanted")
        if self.step_over is not None:
            round_ = max(self.step_over / lean - flat, 0.0)
            if round_ > 2.0 * radius:
                raise CannotComputeError(f"passes {self.step_over / MM:g} mm apart leave a wall between them")
            height, along = radius - sqrt(radius * radius - 0.25 * round_ * round_), self.step_over / lean
        else:
            assert self.scallop_height is not None
            height = self.scallop_height
            if height > radius:
                raise CannotComputeError(f"an edge of radius {radius / MM:g} mm leaves no ridge that high")
            round_ = 2.0 * sqrt(height * (2.0 * radius - height))
            along = round_ + flat
        return {
            "scallop_height": height,
            "step_over": along * lean,
            "mean_height": _below_circle(radius, round_) / along,
        }

    def _edge(self) -> tuple[float, float]:
        """Radius of the round of the edge, and how wide it is flat between [m]."""
        if self.type == "ball":
            return 0.5 * self.diameter, 0.0
        corner = self.corner_radius
        if corner is None or corner > 0.5 * self.diameter * (1.0 + 1e-12):
            raise CannotComputeError("a bull nose needs a `corner_radius` of at most half its diameter")
        if self.slope:
            raise CannotComputeError("on a slope the round of a bull nose is no circle; give `slope` for a ball")
        return corner, self.diameter - 2.0 * corner


def _below_circle(radius: float, width: float) -> float:
    """Area [m²] between a circle that touches a line and the line, over a width of it."""
    half = 0.5 * width
    rise = sqrt(max(radius * radius - half * half, 0.0))
    return 2.0 * radius * half - half * rise - radius * radius * asin(min(half / radius, 1.0))
