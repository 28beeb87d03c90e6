"""Spray: the stripe of one pass, passes side by side, and the spot of a cone that leans."""

from __future__ import annotations

from math import pi, sqrt
from typing import ClassVar

import numpy as np

from gcodesim.arithmetic.elementary import log
from gcodesim.calculator.model import CannotComputeError, Model, Result, Value
from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import POSITIVE, Range
from gcodesim.declarations.quantity import Quantity
from gcodesim.frozen import frozen
from gcodesim.processes.spray_pattern import Stripe, gaussian_stripe, passes, tilted_cone
from gcodesim.units import DEG

_LENGTH = Quantity("length", POSITIVE)
_SHARE = Quantity("ratio", Range(above=0.0, most=1.0))

_SPELLINGS = {
    "flow": "paint_flow", "volume_flow": "paint_flow", "flow_rate": "paint_flow", "paint_flow_rate": "paint_flow",
    "solids": "solids_volume_fraction", "solids_fraction": "solids_volume_fraction",
    "volume_solids": "solids_volume_fraction", "solid_fraction": "solids_volume_fraction",
    "efficiency": "transfer_efficiency", "transfer": "transfer_efficiency",
    "v": "speed", "gun_speed": "speed", "feed": "speed", "travel_speed": "speed", "std": "sigma", "spread": "sigma",
}  # fmt: skip


@frozen
class SprayKeys(Model):
    """What a gun with a Gaussian spot lays in one straight pass."""

    paint_flow: float = key(Quantity("volume flow", POSITIVE), "what leaves the gun", example="120 ml/min")
    solids_volume_fraction: float = key(_SHARE, "share that stays when it is dry", default=1.0)
    transfer_efficiency: float = key(_SHARE, "share of that which stays on the surface", default=1.0)
    speed: float = key(Quantity("speed", POSITIVE), "of the gun", example="400 mm/s")
    sigma: float = key(_LENGTH, "standard deviation of the spot", example="25 mm")

    @property
    def stripe(self) -> Stripe:
        return gaussian_stripe(
            flow=self.paint_flow,
            solids=self.solids_volume_fraction,
            efficiency=self.transfer_efficiency,
            speed=self.speed,
            sigma=self.sigma,
        )


@frozen
class SprayStripe(SprayKeys):
    """One straight pass over a plane."""

    kind: ClassVar[str] = "spray.gaussian"
    says: ClassVar[str] = "film of one straight pass of a gun"
    source: ClassVar[str] = "int t dy = flow solids efficiency / speed; t(y) = section normal(y, sigma)"
    also: ClassVar[tuple[str, ...]] = ("spray", "spray.stripe")
    spellings: ClassVar[dict[str, str]] = {**_SPELLINGS, "y": "offset", "at": "offset"}
    gives: ClassVar[tuple[Result, ...]] = (
        Result("centre_thickness", "length", "in its middle", ("center_thickness", "peak_thickness", "max_thickness")),
        Result("stripe_section", "area", "section across it", ("section", "stripe_area")),
        Result("thickness", "length", "at `offset` from its middle", ("thickness_at_offset", "offset_thickness")),
        Result("width", "length", "between half the thickness on either side", ("fwhm", "half_width")),
    )

    offset: float | None = key("length", "place across the stripe", default=None)

    def compute(self) -> dict[str, Value]:
        stripe = self.stripe
        found: dict[str, Value] = {
            "centre_thickness": stripe.middle,
            "stripe_section": stripe.section,
            "width": 2.0 * self.sigma * sqrt(2.0 * log(2.0)),
        }
        if self.offset is not None:  # a pass alone: the next ones are far away
            (alone,) = passes(stripe, self.sigma, 1e3 * self.sigma, np.array([self.offset]))
            found["thickness"] = float(alone)
        return found


@frozen
class SprayOverlap(SprayKeys):
    """Many parallel passes at one distance from each other."""

    kind: ClassVar[str] = "spray.overlap"
    says: ClassVar[str] = "film of parallel passes, and how even it is"
    source: ClassVar[str] = "sum of the stripes' normal distributions; mean = flow solids efficiency / (speed pitch)"
    also: ClassVar[tuple[str, ...]] = ("spray.passes", "spray.gaussian_overlap")
    spellings: ClassVar[dict[str, str]] = {
        **_SPELLINGS, "pass_distance": "pitch", "pass_spacing": "pitch", "spacing": "pitch", "stripe_pitch": "pitch",
        "pass_pitch": "pitch", "stripe_distance": "pitch", "step_over": "pitch", "stripe_spacing": "pitch",
        "track_pitch": "pitch", "line_spacing": "pitch", "index": "pitch",
    }  # fmt: skip
    gives: ClassVar[tuple[Result, ...]] = (
        Result("mean_thickness", "length", "over many passes", ("average_thickness",)),
        Result("most", "length", "on a pass", ("max_thickness", "peak_thickness", "on_pass_thickness")),
        Result(
            "least", "length", "between two passes",
            ("min_thickness", "valley_thickness", "thickness_min", "between_passes_thickness", "mid_thickness"),
        ),
        Result("ripple", "ratio", "most less least, over the mean", ("ripple_fraction", "waviness", "relative_ripple")),
        Result("evenness", "ratio", "least over most", ("uniformity", "min_max_ratio")),
        Result("stripe_section", "area", "section of one stripe", ("section", "stripe_area")),
        Result("centre_thickness", "length", "of one stripe alone", ("center_thickness",)),
    )  # fmt: skip

    pitch: float = key(_LENGTH, "distance of passes", example="50 mm")

    def compute(self) -> dict[str, Value]:
        if self.pitch < 1e-3 * self.sigma:
            raise CannotComputeError("passes are nearer than a thousandth of the spot")
        stripe = self.stripe
        on, between = passes(stripe, self.sigma, self.pitch, np.array([0.0, 0.5 * self.pitch])).tolist()
        mean = stripe.section / self.pitch
        return {
            "mean_thickness": mean,
            "most": on,
            "least": between,
            "ripple": (on - between) / mean,
            "evenness": between / on,
            "stripe_section": stripe.section,
            "centre_thickness": stripe.middle,
        }


@frozen
class TiltedCone(Model):
    """Where a round cone that leans meets a plane."""

    kind: ClassVar[str] = "spray.tilted_cone"
    says: ClassVar[str] = "spot of a round cone on a plane that leans"
    source: ClassVar[str] = (
        "edge at h tan(tilt ± half) from the nozzle's foot, h = distance cos(tilt); a section of a cone"
    )
    also: ClassVar[tuple[str, ...]] = ("spray.cone", "spray.tilted", "tilted_cone")
    spellings: ClassVar[dict[str, str]] = {
        "cone_angle": "cone", "full_angle": "cone", "opening": "cone", "spray_angle": "cone", "opening_angle": "cone",
        "cone_half_angle": "half_angle", "half_cone": "half_angle", "half_cone_angle": "half_angle",
        "stand_off": "distance", "standoff": "distance", "standoff_distance": "distance", "tilt_angle": "tilt",
        "inclination": "tilt", "gun_tilt": "tilt", "lean": "tilt",
    }  # fmt: skip
    gives: ClassVar[tuple[Result, ...]] = (
        Result("semi_major", "length", "half of the spot along the lean", ("semi_axis_along", "semi_major_axis", "a")),
        Result("semi_minor", "length", "half of it across", ("semi_axis_across", "semi_minor_axis", "b")),
        Result("major_axis", "length", "whole, along", ("major", "length", "footprint_length")),
        Result("minor_axis", "length", "whole, across", ("minor", "footprint_width")),
        Result("area", "area", "of the spot", ("footprint_area", "ellipse_area")),
        Result("shift", "length", "of its middle from where the axis meets the plane", ("centre_shift", "center_shift",
               "centre_offset", "center_offset", "offset")),
        Result("near", "length", "edge from the axis, nearer side", ("near_edge", "extent_near")),
        Result("far", "length", "edge from the axis, farther side", ("far_edge", "extent_far")),
        Result("height", "length", "of the nozzle over the plane"),
    )  # fmt: skip

    distance: float = key(_LENGTH, "along the axis to the plane", example="200 mm")
    tilt: float = key(Quantity("angle", Range(above=-90.0 * DEG, below=90.0 * DEG)), "of the axis", default=0.0)
    half_angle: float | None = key(
        Quantity("angle", Range(above=0.0, below=90.0 * DEG)), "of the cone; or `cone`", default=None
    )
    cone: float | None = key(Quantity("angle", Range(above=0.0, below=180.0 * DEG)), "full angle", default=None)

    def compute(self) -> dict[str, Value]:
        half = self.half_angle if self.half_angle is not None else None if self.cone is None else 0.5 * self.cone
        if half is None:
            raise CannotComputeError("how wide is the cone? give `cone` or `half_angle`")
        try:
            spot = tilted_cone(half_angle=half, distance=self.distance, tilt=self.tilt)
        except ValueError as fault:
            raise CannotComputeError(str(fault)) from None
        return {
            "semi_major": spot.along,
            "semi_minor": spot.across,
            "major_axis": 2.0 * spot.along,
            "minor_axis": 2.0 * spot.across,
            "area": pi * spot.along * spot.across,
            "shift": spot.shift,
            "near": spot.along - abs(spot.shift),
            "far": spot.along + abs(spot.shift),
            "height": spot.height,
        }
