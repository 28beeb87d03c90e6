"""Particles: how many a flow is, where a cone of rays throws them, and how thick they lie."""

from __future__ import annotations

from math import pi
from typing import ClassVar, Final

from gcodesim.arithmetic.scalars import tan
from gcodesim.calculator.model import CannotComputeError, Model, Result, Value
from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import POSITIVE, Range
from gcodesim.declarations.plain_kinds import Choice
from gcodesim.declarations.quantity import Quantity
from gcodesim.frozen import frozen
from gcodesim.tools.extruder import Extruder

_LENGTH: Final = Quantity("length", POSITIVE)
_COUNT: Final = Quantity("ratio", POSITIVE)
_VOLUME: Final = Quantity("volume", POSITIVE)


@frozen
class ParticleFlow(Model):
    """Material that is laid as particles of one size, by the cone of an extruder or along a bead."""

    kind: ClassVar[str] = "additive.particles"
    says: ClassVar[str] = "number of particles of a flow or a bead, and the spot of a cone of rays"
    source: ClassVar[str] = "V = pi d^3/6 (a voxel: d^3); n = efficiency volume / V; spot = distance tan(angle/2)"
    also: ClassVar[tuple[str, ...]] = ("particles", "additive.rays", "additive.cone", "additive.voxels")
    spellings: ClassVar[dict[str, str]] = {
        "particle_size": "particle_diameter", "size": "particle_diameter", "d": "particle_diameter",
        "voxel_size": "voxel", "voxel_edge": "voxel", "edge": "voxel", "radius": "particle_radius",
        "particle_shape": "shape", "flow_rate": "flow", "volume_flow": "flow", "extrusion_rate": "flow",
        "duration": "time", "dwell": "time", "t": "time", "v": "speed", "travel_speed": "speed", "feed": "speed",
        "length": "path_length", "path": "path_length", "move": "path_length", "bead_section": "bead_area",
        "section": "bead_area", "width": "bead_width", "extrusion_width": "bead_width", "height": "bead_height",
        "layer_height": "bead_height", "opening_angle": "angle", "cone_angle": "angle", "cone": "angle",
        "full_angle": "angle", "cone_half_angle": "half_angle", "stand_off": "distance", "standoff": "distance",
        "nozzle_distance": "distance", "number_of_rays": "rays", "ray_count": "rays", "n_rays": "rays",
        "transfer_efficiency": "efficiency", "deposition_efficiency": "efficiency", "hit_fraction": "efficiency",
        "packing_fraction": "packing", "packing_density": "packing", "total_volume": "volume",
        "deposited_volume": "volume", "number_of_particles": "particles", "particle_count": "particles",
        "count": "particles", "n_particles": "particles", "n": "particles", "time_step": "step",
        "dt": "step",
    }  # fmt: skip
    gives: ClassVar[tuple[Result, ...]] = (
        Result("particle_volume", "volume", "of one particle", ("volume_per_particle", "voxel_volume")),
        Result("volume", "volume", "that is laid", ("deposited_volume", "total_volume", "deposited")),
        Result("particles", "", "that it takes", ("count", "number_of_particles", "particle_count", "n_particles",
               "n", "number")),
        Result("particle_rate", "frequency", "particles for each second", ("rate", "particles_per_s", "particle_flow",
               "particles_per_second", "rate_per_s", "particle_rate_per_s", "particles_rate")),
        Result("spacing", "length", "of particles along the path", ("particle_spacing",)),
        Result("particles_per_length", "", "for each metre of the path"),
        Result("particles_per_step", "", "in each `step`"),
        Result("particles_per_ray", "", "for each of the `rays`"),
        Result("volume_per_ray", "volume", "that each ray carries"),
        Result("lost_volume", "volume", "that strikes nothing", ("lost",)),
        Result("time", "time", "for `path_length` at `speed`"),
        Result("spot_radius", "length", "of the cone at `distance`", ("footprint_radius", "cone_radius")),
        Result("spot_diameter", "length", "of the cone at `distance`", ("footprint_diameter", "cone_diameter")),
        Result("spot_area", "area", "of the cone at `distance`", ("footprint_area", "cone_area")),
        Result("mean_thickness", "length", "of what lies on the spot, or under the path", ("thickness", "height",
               "layer_thickness")),
        Result("heap_volume", "volume", "of the particles with the room between them", ("bulk_volume",)),
    )  # fmt: skip

    particle_diameter: float | None = key(_LENGTH, "of a round particle", default=None, example="1 mm")
    particle_radius: float | None = key(_LENGTH, "half of that, in its place", default=None)
    voxel: float | None = key(_LENGTH, "edge of a particle that is a cube, in its place", default=None)
    particle_volume: float | None = key(_VOLUME, "of one particle, in its place", default=None)
    shape: str = key(Choice(("sphere", "cube", "voxel")), "what `particle_diameter` is of", default="sphere")
    particles: float | None = key(_COUNT, "number of particles, for their volume", default=None)
    volume: float | None = key(_VOLUME, "that leaves the nozzle", default=None)
    flow: float | None = key(Quantity("volume flow", POSITIVE), "that leaves the nozzle", default=None)
    time: float | None = key(Quantity("time", POSITIVE), "for which it flows", default=None)
    step: float | None = key(Quantity("time", POSITIVE), "of a simulation", default=None)
    speed: float | None = key(Quantity("speed", POSITIVE), "of the nozzle", default=None)
    path_length: float | None = key(_LENGTH, "way on which it is laid", default=None)
    bead_area: float | None = key(Quantity("area", POSITIVE), "section of a bead, in place of `flow`", default=None)
    bead_width: float | None = key(_LENGTH, "of a bead, in place of `flow`", default=None)
    bead_height: float | None = key(_LENGTH, "of that bead", default=None)
    efficiency: float = key(Quantity("ratio", Range(above=0.0, most=1.0)), "share that strikes and stays", default=1.0)
    packing: float = key(
        Quantity("ratio", Range(above=0.0, most=1.0)), "share of a heap that is particles", default=1.0
    )
    angle: float | None = key(Quantity("angle", Range(above=0.0, below=pi)), "full opening of the cone", default=None)
    half_angle: float | None = key(Quantity("angle", Range(above=0.0, below=0.5 * pi)), "or half of it", default=None)
    distance: float | None = key(_LENGTH, "from the nozzle to the surface", default=None)
    rays: float | None = key(_COUNT, "among which the volume is shared", default=None)

    def compute(self) -> dict[str, Value]:
        found: dict[str, Value] = {}
        size = self._size()
        if size is not None:
            found["particle_volume"] = size
        section = self._section()
        time = self.time
        if time is None and self.path_length is not None and self.speed is not None:
            time = found["time"] = self.path_length / self.speed
        given = self._volume(size, section, time)
        if given is not None:
            kept = found["volume"] = self.efficiency * given
            found["lost_volume"] = given - kept
            found["heap_volume"] = kept / self.packing
            if size is not None:
                found["particles"] = kept / size
            if self.rays is not None:
                found["volume_per_ray"] = kept / self.rays
                if size is not None:
                    found["particles_per_ray"] = kept / size / self.rays
        flow = self.flow
        if flow is None and section is not None and self.speed is not None:
            flow = section * self.speed
        if flow is None and given is not None and time is not None:
            flow = given / time
        if flow is not None and size is not None:
            rate = found["particle_rate"] = self.efficiency * flow / size
            if self.step is not None:
                found["particles_per_step"] = rate * self.step
            if self.speed is not None:
                found |= {"spacing": self.speed / rate, "particles_per_length": rate / self.speed}
        found |= self._spot(given)
        if not found:
            raise CannotComputeError(
                "give a size of particles (`particle_diameter`, `voxel`) with `volume` or `flow`, or a cone (`angle`, "
                "`distance`)"
            )
        return found

    def _size(self) -> float | None:
        """Volume [m³] of a particle."""
        if self.particle_volume is not None:
            return self.particle_volume
        if self.voxel is not None:
            return self.voxel * self.voxel * self.voxel
        across = 2.0 * self.particle_radius if self.particle_radius is not None else self.particle_diameter
        if across is None:
            return None
        cube = across * across * across
        return cube if self.shape != "sphere" else pi / 6.0 * cube

    def _section(self) -> float | None:
        """Section [m²] of the bead."""
        if self.bead_area is not None or self.bead_width is None or self.bead_height is None:
            return self.bead_area
        bead = Extruder(bead_width=self.bead_width, bead_height=self.bead_height)
        for _, problem in bead.problems():
            raise CannotComputeError(problem)
        return bead.bead_area

    def _volume(self, size: float | None, section: float | None, time: float | None) -> float | None:
        """Volume [m³] that leaves the nozzle."""
        if self.volume is not None:
            return self.volume
        if self.flow is not None and time is not None:
            return self.flow * time
        if section is not None and self.path_length is not None:
            return section * self.path_length
        if self.particles is not None and size is not None:
            return self.particles * size / self.efficiency
        return None

    def _spot(self, given: float | None) -> dict[str, Value]:
        """The spot of the cone on a plane across its axis, and how thick `given` [m³] lies there."""
        half = self.half_angle if self.half_angle is not None else None if self.angle is None else 0.5 * self.angle
        if half is None or self.distance is None:
            return {}
        radius = self.distance * tan(half)
        area = pi * (radius * radius)
        found: dict[str, Value] = {"spot_radius": radius, "spot_diameter": 2.0 * radius, "spot_area": area}
        if given is not None:
            under = area + (2.0 * radius * self.path_length if self.path_length is not None else 0.0)
            found["mean_thickness"] = self.efficiency * given / self.packing / under
        return found
