"""The numbers of a run that a person reads first."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final

from gcodesim.executor.part_run import SET_DOWN
from gcodesim.jobs.coating import summary_of
from gcodesim.jobs.results import Results
from gcodesim.jobs.target_result import TargetResult
from gcodesim.units import MM

_MOST_FEATURES: Final = 8
_MOST_WORDS: Final = 5
_LEFT_OUT: Final = {
    "shape": "without forces and log",
    "motion": "nothing is cut",
    "force": "without log and files of shapes",
}


def summary_rows(results: Results) -> list[list[str]]:
    """Rows of the table that ends a run or a check: a name, a value with its unit, a remark."""
    times = results.times
    only = results.inputs.get("only")
    rows = [] if only is None else [["only", str(only), _LEFT_OUT[str(only)]]]
    rows += [
        ["time", f"{times.total:.1f} s"],
        ["  feed", f"{times.feed:.1f} s"],
        ["  rapid", f"{times.rapid:.1f} s"],
    ]
    if times.dwell:
        rows.append(["  dwell", f"{times.dwell:.1f} s"])
    if times.spindle:
        rows.append(["  spindle", f"{times.spindle:.1f} s"])
    if times.devices:
        rows.append(["  devices", f"{times.devices:.1f} s"])
    if times.tool_change:
        rows.append(["  tool changes", f"{times.tool_change:.1f} s"])
    for name, channel in results.channels.items():
        end = "does not end" if channel["end_s"] is None else f"{channel['end_s']:.1f} s"
        remark = f"{channel['program']['name']}, of it {channel['time']['wait_s']:.1f} s waiting for others"
        rows.append([f"  channel {name}", end, remark])
    rows += [
        ["feed distance", f"{results.feed_distance * 1e3:.1f} mm"],
        ["rapid distance", f"{results.rapid_distance * 1e3:.1f} mm"],
    ]
    for name, stock in results.stocks.items():
        value = stock.as_json()
        bound = f"± {value['error_bound_mm3']:.1f} mm³"
        if stock.removed or not stock.deposited:
            rows.append([f"{name}: removed", f"{value['removed_mm3']:.1f} mm³", bound])
        if stock.deposited:
            rows.append([f"{name}: deposited", f"{value['deposited_mm3']:.1f} mm³", bound])
        rows.append([f"{name}: remaining", f"{value['remaining_mm3']:.1f} mm³"])
        if stock.body is not None and stock.body.mass is not None:
            remark = f"as pure {stock.body.pure}" if stock.body.pure else ""
            rows.append([f"{name}: mass", _mass(stock.body.mass), remark])
        if stock.force:
            rows.append([f"{name}: greatest force", f"{stock.force:.1f} N"])
        if value.get("fallen"):
            volume = sum(piece["volume_mm3"] for piece in value["fallen"])
            rows.append([f"{name}: of that, in pieces that fell", f"{volume:.1f} mm³"])
    if results.target is not None:
        rows += _target_rows(results.target)
    for tool in results.tools:
        if tool["max_force_N"]:
            where = f"line {tool['line_of_max_force']}"
            rows.append([f"{tool['name']}: greatest force", f"{tool['max_force_N']:.1f} N", where])
            rows.append(
                [f"{tool['name']}: torque, power", f"{tool['max_torque_Nm']:.2f} N·m", f"{tool['max_power_W']:.0f} W"]
            )
        for column in results.columns:
            if tool[column.key]:
                most = "greatest " if column.of == "greatest" else ""
                shown = f"{tool[column.key]:.4g} {column.people_unit}".strip()
                rows.append([f"{tool['name']}: {most}{column.name.replace('_', ' ')}", shown, column.says])
    if results.coating is not None:
        rows += summary_of(results.coating)
    rows += [[f"{name}: readings", str(sensor["readings"]), sensor["type"]] for name, sensor in results.sensors.items()]
    if results.printing is not None:
        rows += _printing_rows(results.printing)
    accuracy = results.path_accuracy
    if accuracy is not None and accuracy["line_of_AT"] is not None:
        rows.append(["path accuracy AT", f"{accuracy['AT_mm']:.3f} mm", f"line {accuracy['line_of_AT']} (ISO 9283)"])
    for name, part in results.parts.items():
        rows += _part_rows(name, part)
    for joint in results.joints:
        # a margin that is least where the machine stands at the start says nothing about the program
        if joint["margin"] is not None and joint["line_of_margin"] is not None:
            where = f"line {joint['line_of_margin']}"
            rows.append([f"{joint['name']}: least margin", f"{joint['margin']:.1f} {joint['unit']}", where])
    count = sum(entry["count"] for entry in results.not_simulated)
    rows.append(["words not simulated", str(count), _words(results.not_simulated)])
    return rows


def _words(entries: Sequence[Mapping[str, Any]]) -> str:
    """The most frequent words with their counts, and how many others there are."""
    frequent = sorted(entries, key=lambda entry: -entry["count"])
    shown = ", ".join(f"{entry['word']} ({entry['count']})" for entry in frequent[:_MOST_WORDS])
    more = len(entries) - _MOST_WORDS
    return f"{shown} and {more} more: `--format json`" if more > 0 else shown


def _mass(mass: float) -> str:
    return f"{mass:.3f} kg" if mass >= 1.0 else f"{mass * 1e3:.1f} g"


def _target_rows(target: TargetResult) -> list[list[str]]:
    """How far the part is from its target."""
    value = target.as_json()
    least, most = value["least_deviation_mm"], value["most_deviation_mm"]
    remark = f"tolerance {value['tolerance_mm']:g} mm, {target.share_outside:.2%} of the target beyond it"
    rows = [[f"{target.stock}: deviation", f"{least:+.3f} to {most:+.3f} mm", remark]]
    for name, count in (("gouge", target.gouges), ("excess", target.excesses)):
        if count:
            where = f"in {count} place{'' if count == 1 else 's'}"
            rows.append([f"{target.stock}: {name}", f"{value[f'{name}_mm3']:.1f} mm³", where])
    for ridges in value["scallops"]:
        remark = f"half of {ridges['area_mm2']:.0f} mm² below, up to {ridges['most_mm']:.3f} mm; {ridges['operation']}"
        rows.append([f"{target.stock}: scallops of T{ridges['tool']}", f"{ridges['typical_mm']:.3f} mm", remark])
    return rows


def _part_rows(name: str, part: Mapping[str, Any]) -> list[list[str]]:
    """Where a part is at the end, and how far that is from where it is meant to be."""
    if not part["grips"] and part["error_from"] != "goal":
        return []
    at = " ".join(f"{axis.upper()}{part[f'{axis}_mm']:.3f}" for axis in "xyz")
    lost = f", fell {_times(part['falls'])}" if part["falls"] else ""
    rows = [[f"{name}: is at", at, f"{_place_of(part)}, {_taken(part['grips'])}{lost}"]]
    if part["pose_error_mm"] is not None:
        remark = f"{part['pose_error_deg']:.3f}°, from its {part['error_from']}"
        rows.append([f"{name}: pose error", f"{part['pose_error_mm']:.3f} mm", remark])
    return rows


def _place_of(part: Mapping[str, Any]) -> str:
    """Who holds a part, or what it lies on or hangs above."""
    if part["held_by"]:
        return f"held by {part['held_by']}"
    below = part["on"] or "the floor"
    return f"on {below}" if part["above_mm"] <= SET_DOWN / MM else f"{part['above_mm']:.1f} mm above {below}"


def _taken(count: int) -> str:
    return f"taken {_times(count)}" if count else "never taken"


def _times(count: int) -> str:
    return "once" if count == 1 else f"{count} times"


def _printing_rows(printing: Mapping[str, Any]) -> list[list[str]]:
    """Filament, the layers with the longest of them, and the features that take most time."""
    rows = [["filament", f"{printing['filament_mm']:.1f} mm", f"{printing['laid_mm3']:.1f} mm³ laid"]]
    said = [
        f"{printing[key]:.1f} {unit}"
        for key, unit in (("slicer_filament_mm", "mm"), ("slicer_time_s", "s"))
        if key in printing
    ]
    if said:
        rows.append(["  as the slicer says", ", ".join(said), ""])
    if "model_time_s" in printing:
        told = f"{printing['slicer_model_time_s']:.1f} s as the slicer says"
        rows.append(["  the model alone", f"{printing['model_time_s']:.1f} s", told])
    layers, features = printing["layers"], printing["features"]
    if layers:
        slowest = max(layers, key=lambda each: each["time_s"])
        where = f"longest: {slowest['time_s']:.1f} s at Z {slowest['z_mm']:g} mm"
        rows.append(["layers", str(len(layers)), where])
    for each in sorted(features, key=lambda one: -one["time_s"])[:_MOST_FEATURES]:
        if each["feature"]:
            rows.append([f"  {each['feature']}", f"{each['time_s']:.1f} s", f"{each['laid_mm3']:.1f} mm³"])
    return rows
