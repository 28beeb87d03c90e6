"""Beams that take material at a distance: jets by their rate, lasers by the balance of energy."""

from __future__ import annotations

from math import pi
from typing import Any, ClassVar, Final

from gcodesim.arithmetic.scalars import cos
from gcodesim.calculator.model import CannotComputeError, Model, Result, Value
from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import NOT_NEGATIVE, POSITIVE, Range
from gcodesim.declarations.quantity import Quantity
from gcodesim.frozen import frozen
from gcodesim.material.beam import PROFILES, BeamForm, radius_at, share_within
from gcodesim.processes.beam_laws import energy_rate, gaussian_at, jet_depth, peak_intensity, track_fluence
from gcodesim.processes.melting import ROOM, Metal, melting_energy
from gcodesim.units import UM

_LENGTH: Final = Quantity("length", POSITIVE)
_SPEED: Final = Quantity("speed", POSITIVE)
_SHARE: Final = Quantity("ratio", Range(above=0.0, most=1.0))
_ICE: Final = 273.15


def _optional(kind: Any, doc: str) -> Any:
    return key(kind, doc, default=None)


@frozen
class JetCut(Model):
    """The kerf of a water jet, or of anything that takes a volume for each time, upright or leaning."""

    kind: ClassVar[str] = "remove.jet"
    says: ClassVar[str] = "depth of a jet's kerf, and the feed at which it goes through"
    source: ClassVar[str] = "depth = rate cos(lean) / (width feed): the volume of a straight kerf"
    also: ClassVar[tuple[str, ...]] = ("jet", "jet.depth", "jet.kerf", "jet.cut", "remove.oblique_jet", "jet.oblique")
    spellings: ClassVar[dict[str, str]] = {
        "rate": "removal_rate", "width": "kerf_width", "jet_diameter": "kerf_width", "diameter": "kerf_width",
        "speed": "feed", "traverse_speed": "feed", "thickness": "plate_thickness", "length": "path_length",
        "angle": "lean", "tilt": "lean", "incidence": "lean", "incidence_angle": "lean", "tilt_angle": "lean",
        "jet_angle": "lean", "angle_from_normal": "lean", "lean_angle": "lean",
    }  # fmt: skip
    gives: ClassVar[tuple[Result, ...]] = (
        Result("depth", "length", "of the kerf", ("kerf_depth", "cut_depth")),
        Result("depth_along_jet", "length", "of the kerf, measured along the jet", ("depth_along_axis", "slant_depth")),
        Result("footprint_width", "length", "of the jet on the surface, across its way", ("surface_width", "width")),
        Result("footprint_area", "area", "of the jet on the surface"),
        Result("kerf_section", "area", "across the way", ("section",)),
        Result("separation_feed", "speed", "at which it goes just through `plate_thickness`", ("max_feed",)),
        Result("path_through_plate", "length", "of the jet in the plate", ("effective_thickness", "path_in_material")),
        Result("separated", "", "whether `feed` is slow enough for `plate_thickness`", ("through",)),
        Result("volume", "volume", "of `path_length`", ("removed", "removed_volume")),
    )

    removal_rate: float = key(
        Quantity("volume flow", POSITIVE), "volume that it takes for each time", example="8 mm^3/s"
    )
    kerf_width: float = key(_LENGTH, "width of the jet", example="1 mm")
    feed: float = key(_SPEED, "of the nozzle", example="240 mm/min")
    lean: float = key(
        Quantity("angle", Range(above=-0.5 * pi, below=0.5 * pi)),
        "of the jet across its way, from upright",
        default=0.0,
    )
    passes: float = key(Quantity("ratio", POSITIVE), "times that it goes the same way", default=1.0)
    plate_thickness: float | None = _optional(_LENGTH, "of the plate")
    path_length: float | None = _optional(_LENGTH, "length of the kerf")

    def compute(self) -> dict[str, Value]:
        cosine = cos(self.lean)
        depth = self.passes * jet_depth(self.removal_rate, self.kerf_width, self.feed, cosine)
        area = 0.25 * pi * (self.kerf_width * self.kerf_width)
        found: dict[str, Value] = {
            "depth": depth,
            "depth_along_jet": depth / cosine,
            "footprint_width": self.kerf_width / cosine,
            "footprint_area": area / cosine,
            "kerf_section": self.passes * self.removal_rate / self.feed,
        }
        if self.plate_thickness is not None:
            limit = self.passes * jet_depth(self.removal_rate, self.kerf_width, self.plate_thickness, cosine)
            found |= {
                "separation_feed": limit,
                "path_through_plate": self.plate_thickness / cosine,
                "separated": self.feed <= limit,
            }
        if self.path_length is not None:
            found["volume"] = self.passes * self.removal_rate / self.feed * self.path_length
        return found


@frozen
class GaussianSpot(Model):
    """A Gaussian beam that moves or stands: intensity, dose, and the groove that it leaves."""

    kind: ClassVar[str] = "remove.gaussian"
    says: ClassVar[str] = "intensity, dose and groove of a Gaussian laser spot"
    source: ClassVar[str] = "I = 2 P/(pi w^2) exp(-2 r^2/w^2), w by ISO 11146; track: sqrt(2/pi) P/(w v)"
    also: ClassVar[tuple[str, ...]] = (
        "laser.gaussian", "remove.gaussian_spot", "remove.laser", "laser", "laser.spot", "gaussian_spot",
    )  # fmt: skip
    spellings: ClassVar[dict[str, str]] = {
        "beam_power": "power", "laser_power": "power", "w": "radius", "w0": "radius", "spot_radius": "radius",
        "beam_radius": "radius", "diameter": "spot_diameter", "beam_diameter": "spot_diameter", "feed": "speed",
        "scan_speed": "speed", "v": "speed", "time": "dwell", "dwell_time": "dwell", "absorption": "absorptivity",
        "r": "offset", "distance": "offset", "defocus": "out_of_focus", "m2": "beam_quality",
        "ablation_energy": "specific_energy",
    }  # fmt: skip
    gives: ClassVar[tuple[Result, ...]] = (
        Result("radius", "length", "of the spot where it strikes", ("spot_radius", "w")),
        Result("rayleigh_length", "length", "from the focus to twice the area", ("rayleigh",)),
        Result("peak_intensity", "power per area", "in the middle", ("intensity_peak", "I0", "max_intensity")),
        Result("intensity", "power per area", "at `offset`", ("intensity_at_offset",)),
        Result("share_within", "ratio", "of the power, within `offset`", ("power_fraction", "enclosed_fraction")),
        Result("power_within", "power", "within `offset`", ("enclosed_power",)),
        Result("peak_fluence", "energy per area", "in the middle of the track, or of the spot after `dwell`",
               ("fluence_peak", "max_fluence", "line_fluence", "peak_dose")),
        Result("fluence", "energy per area", "at `offset` from that", ("fluence_at_offset",)),
        Result("depth", "length", "in the middle", ("max_depth", "peak_depth", "centre_depth")),
        Result("depth_at_offset", "length", "at `offset`"),
        Result("section", "area", "of the groove", ("groove_section", "groove_area")),
        Result("volume", "volume", "of the crater after `dwell`", ("removed", "removed_volume")),
    )  # fmt: skip

    power: float = key(Quantity("power", POSITIVE), "of the beam", example="40 W")
    radius: float | None = _optional(_LENGTH, "of the spot at its focus, where 1/e² of the intensity is left")
    spot_diameter: float | None = _optional(_LENGTH, "twice that")
    sigma: float | None = _optional(_LENGTH, "half of that radius: standard deviation")
    speed: float | None = _optional(_SPEED, "of the spot")
    dwell: float | None = _optional(Quantity("time", POSITIVE), "for which it stands")
    offset: float = key(Quantity("length", NOT_NEGATIVE), "distance from the axis", default=0.0)
    absorptivity: float = key(_SHARE, "share that the material takes up", default=1.0)
    specific_energy: float | None = _optional(Quantity("energy per volume", POSITIVE), "to remove material")
    out_of_focus: float = key("length", "from the focus to where it strikes", default=0.0)
    wavelength: float = key(_LENGTH, "of the light", default=1.06 * UM)
    beam_quality: float = key(Quantity("ratio", Range(least=1.0)), "M²", default=1.0)

    def compute(self) -> dict[str, Value]:
        given = [self.radius, None if self.spot_diameter is None else 0.5 * self.spot_diameter,
                 None if self.sigma is None else 2.0 * self.sigma]  # fmt: skip
        sizes = [size for size in given if size is not None]
        if len(sizes) != 1:
            raise CannotComputeError("how wide is the spot? give one of `radius`, `spot_diameter` and `sigma`")
        rayleigh = pi * (sizes[0] * sizes[0]) / (self.beam_quality * self.wavelength)
        form = BeamForm(PROFILES["gaussian"], sizes[0], 0.0, rayleigh, 0.0, 0.0, 1.0)
        radius = float(radius_at(form, self.out_of_focus))
        within = float(share_within(PROFILES["gaussian"], self.offset / radius))
        peak, beside = peak_intensity(self.power, radius), gaussian_at(self.offset, radius)
        found: dict[str, Value] = {
            "radius": radius,
            "rayleigh_length": rayleigh,
            "peak_intensity": peak,
            "intensity": peak * beside,
            "share_within": within,
            "power_within": within * self.power,
        }
        if self.speed is None and self.dwell is None:
            return found
        fluence = peak * self.dwell if self.dwell is not None else track_fluence(self.power, radius, self.speed or 1.0)
        found |= {"peak_fluence": fluence, "fluence": fluence * beside}
        if self.specific_energy is not None:
            rate = energy_rate(self.power, self.absorptivity, self.specific_energy)
            depth = self.absorptivity * fluence / self.specific_energy
            found |= {"depth": depth, "depth_at_offset": depth * beside}
            if self.dwell is not None:
                found["volume"] = rate * self.dwell
            elif self.speed is not None:
                found["section"] = rate / self.speed
        return found


@frozen
class EnergyBalance(Model):
    """What a power removes, by the energy that a volume needs, given or from the data of the material."""

    kind: ClassVar[str] = "remove.energy"
    says: ClassVar[str] = "volume, depth and feed of a laser or torch by its balance of energy"
    source: ClassVar[str] = "V = A P t / e; e = rho (c (Tm - T0) + Lm + share Lv)"
    also: ClassVar[tuple[str, ...]] = (
        "remove.energy_balance", "laser.energy", "laser.energy_balance", "energy_balance", "laser.cut",
        "remove.laser_cut",
    )  # fmt: skip
    spellings: ClassVar[dict[str, str]] = {
        "beam_power": "power", "laser_power": "power", "absorption": "absorptivity", "efficiency": "absorptivity",
        "dwell": "time", "duration": "time", "feed": "speed", "v": "speed", "cutting_speed": "speed",
        "width": "kerf_width", "kerf": "kerf_width", "thickness": "plate_thickness", "depth": "plate_thickness",
        "length": "path_length", "specific_heat": "heat_capacity", "c": "heat_capacity",
        "melting_temperature": "melting_point", "start_temperature": "room", "ambient": "room",
        "ambient_temperature": "room", "heat_of_fusion": "latent_heat", "latent_heat_fusion": "latent_heat",
        "heat_of_melting": "latent_heat", "latent_heat_vaporisation": "heat_of_vaporisation",
        "latent_heat_vaporization": "heat_of_vaporisation", "volumetric_energy": "specific_energy",
        "ablation_energy": "specific_energy", "temperature_rise": "rise", "delta_T": "rise",
    }  # fmt: skip
    gives: ClassVar[tuple[Result, ...]] = (
        Result("specific_energy", "energy per volume", "that it takes", ("energy_per_volume", "volumetric_energy")),
        Result("removal_rate", "volume flow", "volume for each time", ("rate",)),
        Result("absorbed_power", "power", "that the material takes up"),
        Result("energy", "energy", "of the beam in `time`", ("beam_energy",)),
        Result("absorbed_energy", "energy", "of that, in the material"),
        Result("volume", "volume", "removed in `time`", ("removed", "removed_volume")),
        Result("depth", "length", "of a kerf of `kerf_width` at `speed`", ("kerf_depth", "cut_depth")),
        Result("max_speed", "speed", "through `plate_thickness` with `kerf_width`",
               ("separation_feed", "cutting_speed", "max_feed", "feed", "speed")),
        Result("power_needed", "power", "for `kerf_width`, `plate_thickness` and `speed`", ("required_power",)),
    )  # fmt: skip

    power: float = key(Quantity("power", POSITIVE), "of the beam", example="2 kW")
    absorptivity: float = key(_SHARE, "share that the material takes up", default=1.0)
    specific_energy: float | None = _optional(Quantity("energy per volume", POSITIVE), "to remove material")
    density: float | None = _optional(Quantity("density", POSITIVE), "of the material, where that is not given")
    heat_capacity: float | None = _optional(Quantity("specific heat", POSITIVE), "of the material")
    melting_point: float | None = _optional("temperature", "of the material")
    rise: float | None = _optional("temperature", "of its temperature, in K, in place of `melting_point`")
    room: float = key("temperature", "temperature at first", default=ROOM + _ICE)
    latent_heat: float = key(Quantity("latent heat", NOT_NEGATIVE), "heat of fusion", default=0.0)
    heat_of_vaporisation: float = key(Quantity("latent heat", NOT_NEGATIVE), "of what turns to vapour", default=0.0)
    vapour_share: float = key(Quantity("ratio", Range(least=0.0, most=1.0)), "of it that does", default=1.0)
    time: float | None = _optional(Quantity("time", POSITIVE), "for which it is on")
    speed: float | None = _optional(_SPEED, "of the beam")
    path_length: float | None = _optional(_LENGTH, "of its way at `speed`, in place of `time`")
    kerf_width: float | None = _optional(_LENGTH, "of the kerf")
    plate_thickness: float | None = _optional(_LENGTH, "of the plate")

    def _needed(self) -> float:
        if self.specific_energy is not None:
            return self.specific_energy
        rise = self.rise
        if rise is None and self.melting_point is not None:
            rise = self.melting_point - self.room
        if self.density is None or self.heat_capacity is None or rise is None:
            raise CannotComputeError(
                "what does a volume need? give `specific_energy`, or `density`, `heat_capacity`, `melting_point`"
            )
        heat = self.latent_heat + self.vapour_share * self.heat_of_vaporisation
        return melting_energy(Metal(self.density, self.heat_capacity, rise, heat), start=0.0)

    def compute(self) -> dict[str, Value]:
        needed = self._needed()
        rate = energy_rate(self.power, self.absorptivity, needed)
        found: dict[str, Value] = {
            "specific_energy": needed,
            "removal_rate": rate,
            "absorbed_power": self.absorptivity * self.power,
        }
        time = self.time
        if time is None and self.path_length is not None and self.speed is not None:
            time = self.path_length / self.speed
        if time is not None:
            energy = self.power * time
            found |= {"energy": energy, "absorbed_energy": self.absorptivity * energy, "volume": rate * time}
        if self.kerf_width is not None and self.speed is not None:
            found["depth"] = jet_depth(rate, self.kerf_width, self.speed)
        if self.kerf_width is not None and self.plate_thickness is not None:
            section = self.kerf_width * self.plate_thickness
            found["max_speed"] = rate / section
            if self.speed is not None:
                found["power_needed"] = section * self.speed * needed / self.absorptivity
        return found
