"""Every process model of the calculator against closed forms and sums of its own, with the keys of a file of cases.

Nothing here calls the project for the truth: sections, spots and films are added up from thin slices, loads from
vectors.
"""

from __future__ import annotations

from collections.abc import Callable
from math import cos, exp, hypot, pi, radians, sin, sqrt, tan
from typing import Any

import numpy as np
import pytest

from gcodesim.calculator.answers import answer_cases

Case = tuple[str, dict[str, Any], dict[str, Any]]
TRUTHS: dict[str, list[Case]] = {}


def truth(make: Callable[[], list[Case]]) -> Callable[[], list[Case]]:
    TRUTHS[make.__name__] = make()
    return make


def middles(low: float, high: float, count: int) -> tuple[np.ndarray, float]:
    """Middles of `count` equal slices, and how wide one is."""
    edges = np.linspace(low, high, count + 1)
    return 0.5 * (edges[:-1] + edges[1:]), (high - low) / count


def section(width: float, height: float) -> float:
    """A rectangle with half a disc on either side, added up over its height."""
    angle, slice_ = middles(-0.5 * pi, 0.5 * pi, 4000)  # z = h/2 sin(angle): slices that are thin where it is steep
    return float(np.sum((width - height + height * np.cos(angle)) * 0.5 * height * np.cos(angle)) * slice_)


@truth
def bead() -> list[Case]:
    found: list[Case] = []
    for width, height, speed, length in ((6.0, 3.0, 40.0, 100.0), (0.45, 0.2, 60.0, 12.5), (20.0, 20.0, 80.0, 500.0)):
        area = section(width, height)
        wanted = {
            "bead_area_mm2": area, "flow_mm3_s": area * speed, "volume_mm3": area * length, "time_s": length / speed,
        }  # fmt: skip
        given = {"height_mm": height, "speed_mm_s": speed, "path_length_mm": length}
        found.append(("additive.bead", {**given, "width_mm": width}, wanted))
        found.append(("additive.bead", {**given, "flow_mm3_s": area * speed}, {"bead_width_mm": width}))
        said = {"bead_height_mm": height, "bead_width_mm": width, "nozzle_speed_mm_s": speed}
        found.append(("additive.bead", said, {"area_mm2": area, "flow_rate_mm3_s": area * speed}))
        filament = 0.25 * pi * 2.85**2
        line = {"extrusion_width_mm": width, "layer_height_mm": height, "move_mm": length, "filament_diameter_mm": 2.85}
        found.append(("additive.fdm", line, {"bead_area_mm2": area, "E_mm": area * length / filament}))
    return found


@truth
def spiral_wall() -> list[Case]:
    found: list[Case] = []
    for across, high, layer, width in ((80.0, 60.0, 0.3, 0.6), (5.0, 4.0, 2.0, 3.0), (1200.0, 900.0, 15.0, 40.0)):
        turn, slice_ = middles(0.0, high / layer, 1000)
        way = np.array([-pi * across * np.sin(2 * pi * turn), pi * across * np.cos(2 * pi * turn), 0 * turn + layer])
        path = float(np.sum(np.sqrt((way**2).sum(axis=0))) * slice_)  # along the tangent of the helix
        wanted = {
            "turns": high / layer, "path_length_mm": path, "volume_mm3": path * section(width, layer),
            "time_s": path / 50.0,
        }  # fmt: skip
        given = {"wall_height_mm": high, "layer_height_mm": layer, "bead_width_mm": width, "speed_mm_s": 50}
        found.append(("additive.spiral_wall", {**given, "diameter_mm": across}, wanted))
        found.append(("additive.spiral", {**given, "wall_radius_mm": 0.5 * across}, wanted))
    return found


@truth
def arc_weld() -> list[Case]:
    found: list[Case] = []
    for wire, feed, travel, volts, amps, share in (
        (1.2, 8.0, 500.0, 22.0, 180.0, 0.8),
        (0.8, 12.0, 900.0, 19.0, 110.0, 0.75),
        (1.6, 3.5, 150.0, 30.0, 320.0, 1.0),
    ):
        per_minute = 0.25 * pi * wire**2 * feed * 1e3  # [mm³/min]
        area = per_minute / travel
        height = 3.0
        width = 1.5 * area / height
        y, slice_ = middles(-0.5 * width, 0.5 * width, 20_000)
        assert np.sum(height * (1 - (2 * y / width) ** 2)) * slice_ == pytest.approx(area, rel=1e-8)  # a parabola
        wanted = {
            "bead_area_mm2": area, "heat_input_kJ_mm": share * volts * amps * 60.0 / travel / 1e3,
            "deposition_rate_kg_h": per_minute * 60.0 * 7850e-9, "bead_width_mm": width,
            "arc_power_kW": volts * amps / 1e3,
        }  # fmt: skip
        given = {"wire_diameter_mm": wire, "wire_feed_m_min": feed, "travel_speed_mm_min": travel, "height_mm": height}
        found.append(
            ("weld.arc", {**given, "voltage_V": volts, "current_A": amps, "efficiency": share}, wanted),
        )
        kept = {**given, "deposition_efficiency": 0.9}
        found.append(("additive.arc_weld", kept, {"bead_area_mm2": 0.9 * area}))
    return found


@truth
def particles() -> list[Case]:
    found: list[Case] = []
    for size, flow, time, speed, share, opening, away in (
        (2.0, 100.0, 4.0, 25.0, 0.9, 60.0, 30.0),
        (0.5, 12.0, 9.5, 8.0, 1.0, 12.0, 150.0),
        (5.0, 2500.0, 60.0, 120.0, 0.7, 140.0, 20.0),
    ):
        z, slice_ = middles(-0.5 * size, 0.5 * size, 100_000)
        ball = float(np.sum(pi * (0.25 * size**2 - z**2)) * slice_)  # a ball, disc by disc
        kept = share * flow * time
        given = {
            "particle_diameter_mm": size, "flow_mm3_s": flow, "time_s": time, "travel_speed_mm_s": speed,
            "efficiency": share, "opening_angle_deg": opening, "distance_mm": away, "rays": 25,
        }  # fmt: skip
        spot = away * tan(radians(0.5 * opening))
        wanted = {
            "particle_volume_mm3": ball, "particles": kept / ball, "volume_mm3": kept,
            "lost_volume_mm3": flow * time - kept, "particles_per_s": share * flow / ball,
            "spacing_mm": speed * ball / (share * flow),
            "volume_per_ray_mm3": kept / 25, "spot_radius_mm": spot, "spot_area_mm2": pi * spot**2,
        }  # fmt: skip
        found.append(("additive.particles", given, wanted))
        cube = {"voxel_size_mm": size, "volume_mm3": kept}
        found.append(("additive.particles", cube, {"particle_count": kept / size**3}))
    return found


def spot_density(y: float | np.ndarray, sigma: float) -> Any:
    return np.exp(-0.5 * (y / sigma) ** 2) / (sigma * sqrt(2.0 * pi))


GUNS = ((120.0, 0.5, 0.6, 400.0, 25.0), (350.0, 0.38, 0.72, 650.0, 60.0), (15.0, 1.0, 1.0, 90.0, 4.0))


@truth
def spray_stripe() -> list[Case]:
    found: list[Case] = []
    for flow, solids, share, speed, sigma in GUNS:
        laid = flow * 1e3 / 60.0 * solids * share / speed  # [mm²]
        given = {
            "paint_flow_ml_min": flow, "solids_volume_fraction": solids, "transfer_efficiency": share,
            "speed_mm_s": speed, "sigma_mm": sigma,
        }  # fmt: skip
        x, slice_ = middles(-10 * sigma, 10 * sigma, 4000)  # the gun goes by: what comes down at y as it passes
        passing = float(np.sum(spot_density(x, sigma)) * slice_)
        assert passing == pytest.approx(1.0, rel=1e-9)
        wanted = {"stripe_section_mm2": laid, "centre_thickness_um": 1e3 * laid * spot_density(0.0, sigma)}
        found.append(("spray.gaussian", given, wanted))
        beside = {"thickness_um": 1e3 * laid * spot_density(1.3 * sigma, sigma)}
        found.append(("spray.stripe", {**given, "offset_mm": 1.3 * sigma}, beside))
    return found


@truth
def overlap() -> list[Case]:
    found: list[Case] = []
    for (flow, solids, share, speed, sigma), apart in zip(GUNS, (2.0, 3.1, 1.2), strict=True):
        laid, pitch = flow * 1e3 / 60.0 * solids * share / speed, apart * sigma
        given = {
            "paint_flow_ml_min": flow, "solids_volume_fraction": solids, "transfer_efficiency": share,
            "speed_mm_s": speed, "sigma_mm": sigma, "pitch_mm": pitch,
        }  # fmt: skip
        places = np.arange(-60, 61) * pitch
        on = 1e3 * laid * float(np.sum(spot_density(places, sigma)))
        between = 1e3 * laid * float(np.sum(spot_density(places + 0.5 * pitch, sigma)))
        wanted = {
            "mean_thickness_um": 1e3 * laid / pitch, "max_thickness_um": on, "min_thickness_um": between,
            "uniformity": between / on, "ripple_percent": 100.0 * (on - between) / (1e3 * laid / pitch),
        }  # fmt: skip
        found.append(("spray.overlap", given, wanted))
    return found


@truth
def tilted_cone() -> list[Case]:
    found: list[Case] = []
    for half, away, tilt in ((15.0, 200.0, 30.0), (20.0, 150.0, 0.0), (9.0, 320.0, 55.0), (30.0, 100.0, 45.0)):
        round_ = np.linspace(0.0, 2 * pi, 100_001)
        side = sin(radians(half))
        ray = np.array([side * np.cos(round_), side * np.sin(round_), 0 * round_ - cos(radians(half))])
        c, s = cos(radians(tilt)), sin(radians(tilt))
        ray = np.array([c * ray[0] - s * ray[2], ray[1], s * ray[0] + c * ray[2]])  # the cone leans about Y
        reach = away * c / -ray[2]
        x, y = ray[0] * reach, ray[1] * reach  # where its rays meet the plane
        along, across = 0.5 * float(np.ptp(x)), 0.5 * float(np.ptp(y))
        area = abs(float(np.sum(x[:-1] * y[1:] - x[1:] * y[:-1]))) * 0.5
        shift = 0.5 * float(x.max() + x.min()) - away * s
        wanted = {"semi_major_mm": along, "semi_minor_mm": across, "area_mm2": area, "shift_mm": shift}
        found.append(
            ("spray.tilted_cone", {"cone_half_angle_deg": half, "distance_mm": away, "tilt_deg": tilt}, wanted)
        )
        found.append(("spray.cone", {"cone_angle_deg": 2 * half, "standoff_mm": away, "tilt_deg": tilt}, wanted))
    return found


@truth
def jets() -> list[Case]:
    """Upright and leaning: volume a second = kerf, as wide as the jet across it, times depth times feed."""
    found: list[Case] = []
    for rate, width, feed, plate, lean in (
        (8.0, 1.0, 240.0, 6.0, 0.0), (35.0, 0.8, 90.0, 20.0, 30.0), (2.5, 0.25, 700.0, 1.5, -55.0),
    ):  # fmt: skip
        wide = width / cos(radians(lean))  # on the surface: the jet is cut by a plane that leans
        wanted = {
            "depth_mm": rate / (wide * feed / 60.0), "footprint_width_mm": wide,
            "separation_feed_mm_min": 60.0 * rate / (wide * plate), "volume_mm3": rate * 50.0 / (feed / 60.0),
            "depth_along_axis_mm": rate / (width * feed / 60.0), "path_in_material_mm": plate / cos(radians(lean)),
        }  # fmt: skip
        given = {"removal_rate_mm3_s": rate, "kerf_width_mm": width, "feed_mm_min": feed, "path_length_mm": 50.0}
        name = "remove.oblique_jet" if lean else "remove.jet"
        found.append((name, {**given, "plate_thickness_mm": plate, **({"lean_deg": lean} if lean else {})}, wanted))
    return found


@truth
def gaussian_spot() -> list[Case]:
    found: list[Case] = []
    for power, radius, speed, aside in ((40.0, 0.1, 20.0, 0.05), (2000.0, 0.3, 150.0, 0.3), (5.0, 0.02, 3.0, 0.0)):
        r, ring = middles(0.0, 8 * radius, 100_000)
        shape = np.exp(-2 * (r / radius) ** 2)
        peak = power / float(np.sum(shape * 2 * pi * r) * ring)  # all power is in the spot
        within = float(np.sum((shape * 2 * pi * r)[r < aside]) * ring) * peak / power
        x, slice_ = middles(-8 * radius, 8 * radius, 20_000)
        track = peak * float(np.sum(np.exp(-2 * (x / radius) ** 2)) * slice_) / speed
        beside = exp(-2 * (aside / radius) ** 2)
        wanted = {
            "peak_intensity_W_mm2": peak, "intensity_W_mm2": peak * beside, "share_within": within,
            "peak_fluence_J_mm2": track, "fluence_J_mm2": track * beside, "depth_mm": 0.4 * track / 25.0,
            "section_mm2": 0.4 * power / speed / 25.0,
        }  # fmt: skip
        given = {
            "power_W": power, "scan_speed_mm_s": speed, "absorptivity": 0.4, "specific_energy_J_mm3": 25,
            "offset_mm": aside,
        }  # fmt: skip
        found.append(("laser.gaussian", {**given, "spot_diameter_mm": 2 * radius}, wanted))
        found.append(("remove.gaussian", {**given, "spot_radius_mm": radius}, wanted))
    return found


@truth
def energy_balance() -> list[Case]:
    found: list[Case] = []
    for power, share, density, heat, melts, latent in (
        (2.0, 0.4, 7850.0, 500.0, 1500.0, 270.0), (0.5, 0.1, 2700.0, 900.0, 650.0, 390.0),
    ):  # fmt: skip
        needed = density * (heat * (melts - 20.0) + latent * 1e3)  # [J/m³]
        rate = share * power * 1e3 / needed * 1e9  # [mm³/s]
        wanted = {
            "specific_energy_J_mm3": needed * 1e-9, "removal_rate_mm3_s": rate,
            "max_speed_mm_min": 60.0 * rate / (0.3 * 4.0), "volume_mm3": rate * 2.5, "beam_energy_J": power * 2500.0,
        }  # fmt: skip
        given = {
            "power_kW": power, "absorptivity": share, "density_kg_m3": density, "heat_capacity_J_kgK": heat,
            "melting_point_degC": melts, "latent_heat_kJ_kg": latent, "kerf_width_mm": 0.3, "plate_thickness_mm": 4,
            "time_s": 2.5,
        }  # fmt: skip
        found.append(("remove.energy_balance", given, wanted))
    return found


@truth
def suction_loads() -> list[Case]:
    """A part on a wall of any slope: pull off the face and slip along it, cup by cup, by vectors."""
    found: list[Case] = []
    for cups, across, vacuum, mass, up, level, tilt, friction in (
        (2, 40.0, 60.0, 8.0, 0.0, 0.0, 0.0, 0.5), (4, 30.0, 70.0, 5.0, 2.0, 3.0, 0.0, 0.5),
        (3, 60.0, 55.0, 6.0, 1.0, 2.0, 90.0, 0.4), (6, 25.0, 80.0, 3.0, 4.0, 1.0, 35.0, 0.6),
    ):  # fmt: skip
        one = vacuum * 1e3 * pi * (0.5e-3 * across) ** 2
        load = mass * np.array([level, 0.0, -9.81 - up])  # what the part pulls with; level load lies in the face
        away = np.array([0.0, sin(radians(tilt)), -cos(radians(tilt))])  # off the face
        pull = float(load @ away)
        slip = float(np.linalg.norm(load - pull * away))
        needed = pull + slip / friction  # mu (F - pull) >= slip
        wanted = {
            "force_per_cup_N": one, "total_force_N": cups * one, "pull_N": pull, "lateral_load_N": slip,
            "needed_force_N": needed, "required_force_N": 2.0 * needed, "safety_figure": cups * one / needed,
            "holds": cups * one >= 2.0 * needed, "max_vertical_accel_m_s2": cups * one / (2.0 * mass) - 9.81,
        }  # fmt: skip
        given = {
            "cups": cups, "cup_diameter_mm": across, "vacuum_kPa": vacuum, "mass_kg": mass, "g": 9.81,
            "acceleration_m_s2": up, "lateral_acceleration_m_s2": level, "tilt_deg": tilt, "friction": friction,
            "safety": 2.0,
        }  # fmt: skip
        found.append(("grip.suction", given, wanted))
    return found


@truth
def friction_grip() -> list[Case]:
    found: list[Case] = []
    for fingers, force, mass, up, level, friction, safety in (
        (2, 25.0, 2.0, 5.0, 0.0, 0.5, 1.0), (2, 80.0, 1.5, 3.0, 4.0, 0.3, 2.0), (3, 60.0, 4.0, 0.0, 2.0, 0.2, 1.5),
    ):  # fmt: skip
        load = mass * hypot(9.81 + up, level)
        needed = load / (friction * fingers)
        wanted = {
            "tangential_load_N": load, "needed_force_N": needed, "required_force_N": safety * needed,
            "friction_capacity_N": friction * fingers * force, "safety_figure": force / needed,
            "holds": force >= safety * needed, "max_mass_kg": mass * force / (safety * needed),
            "max_vertical_accel_m_s2": friction * fingers * force / (safety * mass) - 9.81,
        }  # fmt: skip
        given = {
            "fingers": fingers, "force_N": force, "mass_kg": mass, "g": 9.81, "acceleration_m_s2": up,
            "lateral_acceleration_m_s2": level, "friction": friction, "safety": safety,
        }  # fmt: skip
        found.append(("grip.friction", given, wanted))
    return found


@pytest.mark.parametrize("kind", TRUTHS)
def test_the_calculator_says_what_the_closed_form_says(kind: str) -> None:
    for name, given, wanted in TRUTHS[kind]:
        found = answer_cases([{"id": kind, "model": name, "inputs": given, "expected": wanted}])

        assert found.complete and not found.told, (name, given)
        for quantity, value in wanted.items():
            assert found.results[kind][quantity] == pytest.approx(value, rel=2e-6, abs=1e-9), (quantity, given)
