"""Layouts of the viewer: the panels that show a log, for milling, for a robot, or for another process.

A layout names every scene topic and every joint, because the viewer shows only
what its layout names. Numbers stay SI, as the topics have them. Panel titles
are written for Foxglove and for Lichtblick, which call the key differently.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

from gcodesim.log.description import ProcessField, with_peaks
from gcodesim.log.topics import MOST_TILES, topic_table

KINDS: Final = ("milling", "robot", "process")

Json = dict[str, Any]
LayoutNode = str | Json
"""A panel by its name, or two of these side by side."""

_VOLUME: Final = "Plot!volume"
_OWN: Final = "Plot!own"
_CELL: Final = "3D!cell"
_PART: Final = "3D!part"

_AXES: Final = 0.03
"""Length of the axes at the tip, as a share of the distance of the camera."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Camera:
    """Looks at `target` [m] in world, from `distance` [m]."""

    target: tuple[float, float, float] = (0.0, 0.0, 0.25)
    distance: float = 2.4


@dataclass(frozen=True, slots=True, kw_only=True)
class View:
    """Camera of the cell, and one close to the part where the first is far; between which volumes [m³] the plot goes.

    The volumes are needed because a viewer's axis is not finer than 0.001 by itself.
    """

    cell: Camera = Camera()
    part: Camera | None = None
    volumes: tuple[float, float] | None = None


def layout(
    kind: str,
    joints: Sequence[str],
    outputs: Sequence[str] = (),
    view: View | None = None,
    fields: Sequence[ProcessField] = (),
) -> bytes:
    """A layout as JSON for a log with those joints, outputs (names as in `/program`) and fields of its processes.

    KeyError for another kind.
    """
    view = view or View()
    panels, right = {"milling": _milling, "robot": _robot, "process": _process}[kind](joints)
    drawn = with_peaks(field.name for field in fields if not field.flag)
    numbers = {name: f"/process.{field}" for name, field in drawn.items()}
    for name, panel in _BESIDE.items():  # what is of the kind of a figure that every log has stands beside it
        if name in numbers and panel in panels:
            panels[panel]["paths"].append(_curve(name.rpartition("_")[0].replace("_", " "), numbers.pop(name)))
    if numbers:
        panels[_OWN] = _plot("of the process [SI]", numbers)
        right = {"direction": "column", "splitPercentage": 80, "first": right, "second": _OWN}
    if view.volumes is not None and _VOLUME in panels:
        panels[_VOLUME] |= {"minYValue": view.volumes[0], "maxYValue": view.volumes[1]}
    panels |= {name: _scene(name, camera) for name, camera in _cameras(view).items()}
    panels |= {
        "StateTransitions!program": _states(outputs, [field.name for field in fields if field.flag]),
        "RosOut!log": {**_titled("log"), "searchTerms": [], "minLogLevel": 1, "topicToRender": "/log"},
        "RawMessages!block": _raw("block", "/program.text"),
        "RawMessages!event": _raw("last event", "/event.message"),
    }
    whole = {
        "configById": panels,
        "globalVariables": {},
        "userNodes": {},
        "playbackConfig": {"speed": 1},
        "layout": _whole(list(_cameras(view)), right),
    }
    return (json.dumps(whole, indent=1) + "\n").encode()


def view_of(layout_json: bytes) -> View:
    """Where the camera of a layout looks; ValueError or KeyError if it is not one of our layouts."""
    panels = json.loads(layout_json)["configById"]
    plot = panels.get(_VOLUME, {})
    volumes = (plot["minYValue"], plot["maxYValue"]) if "minYValue" in plot else None
    part = _camera_of(panels[_PART]) if _PART in panels else None
    return View(cell=_camera_of(panels[_CELL]), part=part, volumes=volumes)


def _camera_of(panel: Json) -> Camera:
    x, y, z = panel["cameraState"]["targetOffset"]
    return Camera(target=(x, y, z), distance=panel["cameraState"]["distance"])


def _cameras(view: View) -> dict[str, Camera]:
    """The cameras by their panels."""
    return {_CELL: view.cell} | ({} if view.part is None else {_PART: view.part})


# ---- what each kind shows


def _milling(joints: Sequence[str]) -> tuple[Json, LayoutNode]:
    panels = {
        "Plot!force": _plot("force [N], power [W]", _LOAD),
        "Plot!feed": _plot("feed [m/s]", _FEED),
        "Plot!spindle": _plot(
            "spindle [rad/s], torque [N m]", {"spindle": "/process.spindle_rad_s", "torque": "/process.max_torque_nm"}
        ),
        _VOLUME: _plot("removed [m3]", {"removed": "/process.removed_m3"}),
        "Plot!axes": _plot("axes [m, rad]", _of_joints(joints, "position")),
    }
    right = _column(_row("Plot!force", "Plot!feed"), _row("Plot!spindle", _VOLUME), _row("Plot!axes", _TEXTS), _LOG)
    return panels, right


def _robot(joints: Sequence[str]) -> tuple[Json, LayoutNode]:
    panels = {
        "Plot!joints": _plot("joints [rad, m]", _of_joints(joints, "position")),
        "Plot!efforts": _plot("effort [N m, N]", _of_joints(joints, "effort")),
        "Plot!limits": _plot("part of the limits that is used", _LIMITS, lines=(1.0,)),
        "Plot!following": _plot(
            "following error [m], [rad]",
            {"position": "/motion.position_error_m", "orientation": "/motion.orientation_error_rad"},
        ),
        "Plot!force": _plot("force [N], power [W]", _LOAD),
        "Plot!feed": _plot("feed [m/s]", _FEED),
    }
    right = _column(
        _row("Plot!joints", "Plot!efforts"),
        _row("Plot!limits", "Plot!following"),
        _row("Plot!force", "Plot!feed"),
        _row(_LOG, _TEXTS),
    )
    return panels, right


def _process(joints: Sequence[str]) -> tuple[Json, LayoutNode]:
    panels = {
        _VOLUME: _plot("removed [m3]; below 0 added", {"volume": "/process.removed_m3"}),
        "Plot!feed": _plot("feed [m/s]", _FEED),
        "Plot!height": _plot("tip in work coordinates [m]", {letter: f"/motion.{letter}_m" for letter in "xyz"}),
        "Plot!limits": _plot("part of the limits that is used", _LIMITS, lines=(1.0,)),
        "Plot!joints": _plot("joints [rad, m]", _of_joints(joints, "position")),
    }
    right = _column(
        _VOLUME,
        _row("Plot!feed", "Plot!height"),
        _row("Plot!limits", "Plot!joints"),
        _row(_LOG, _TEXTS),
    )
    return panels, right


_BESIDE: Final = {"peak_force_n": "Plot!force", "peak_torque_nm": "Plot!spindle"}
_LOAD: Final = {"force": "/process.max_force_n", "power": "/process.max_power_w"}
_FEED: Final = {"tip": "/motion.feed_m_s", "command": "/motion.feed_command_m_s"}
_LIMITS: Final = {name: f"/motion.{name}_used" for name in ("travel", "speed", "effort")}


def _of_joints(joints: Sequence[str], field: str) -> dict[str, str]:
    return {name.rpartition("/")[2]: f'/joint_states.joints[:]{{name=="{name}"}}.{field}' for name in joints}


# ---- panels


def _titled(title: str) -> Json:
    return {"foxglovePanelTitle": title, "lichtblickPanelTitle": title}


def _plot(title: str, paths: dict[str, str], lines: Sequence[float] = ()) -> Json:
    """Curves by label over time, and level lines at fixed values."""
    curves = [_curve(label, value) for label, value in paths.items()]
    curves += [{**_curve("limit", f"{line:g}"), "color": "#d02030"} for line in lines]
    return {
        **_titled(title),
        "paths": curves,
        "showXAxisLabels": True,
        "showYAxisLabels": True,
        "showLegend": len(curves) > 1,
        "legendDisplay": "left",
        "showPlotValuesInLegend": False,
        "isSynced": True,
        "xAxisVal": "timestamp",
        "sidebarDimension": 100,
    }


def _curve(label: str, value: str) -> Json:
    return {"value": value, "label": label, "enabled": True, "timestampMethod": "receiveTime"}


def _states(outputs: Sequence[str], flags: Sequence[str]) -> Json:
    paths = [(name, f"/program.{name}") for name in ("state", "tool", "motion", "line")]
    paths += [("engaged", "/process.engaged"), ("flood", "/program.flood")]
    paths += [(name, f"/process.{name}") for name in flags]
    for name in outputs:
        field = "value" if name.startswith(("digital ", "analog ")) else "verb"
        paths.append((f"output {name}", f'/program.outputs[:]{{name=="{name}"}}.{field}'))
    shown = [{"value": value, "label": label, "timestampMethod": "receiveTime"} for label, value in paths]
    return {**_titled("program"), "isSynced": True, "paths": shown}


def _raw(title: str, topic: str) -> Json:
    unused = {"diffEnabled": False, "diffMethod": "custom", "diffTopicPath": "", "showFullMessageForDiff": False}
    return {**_titled(title), **unused, "topicPath": topic}


def _scene(panel: str, camera: Camera) -> Json:
    scenes = [topic.name for topic in topic_table(MOST_TILES, MOST_TILES) if topic.schema == "foxglove.SceneUpdate"]
    return {
        **_titled(panel.partition("!")[2]),
        "cameraState": {
            "perspective": True,
            "distance": camera.distance,
            "phi": 60,
            "thetaOffset": 40,
            "target": [0, 0, 0],
            "targetOffset": list(camera.target),
            "targetOrientation": [0, 0, 0, 1],
            "fovy": 45,
            "near": 0.01,
            "far": 200,
        },
        "followMode": "follow-none",
        "followTf": "world",
        "scene": {
            "transforms": {
                "showLabel": False,
                "axisScale": 0,
                "lineWidth": 0,
                "editable": False,
                "enablePreloading": False,
            },
            "meshUpAxis": "z_up",
        },
        "transforms": {},
        "topics": {
            **{topic: {"visible": True, "showOutlines": False} for topic in scenes},
            "/tcp": {"visible": True, "type": "axis", "axisScale": round(_AXES * camera.distance, 4)},
            "/target": {"visible": False, "type": "axis", "axisScale": round(_AXES * camera.distance, 4)},
        },
        "layers": {
            "floor": {
                "visible": True,
                "frameLocked": True,
                "label": "floor",
                "instanceId": "floor",
                "layerId": "foxglove.Grid",
                "size": 4,
                "divisions": 16,
                "lineWidth": 1,
                "color": "#66717dff",
                "position": [0, 0, 0],
                "rotation": [0, 0, 0],
                "order": 1,
            }
        },
        "publish": {
            "type": "point",
            "poseTopic": "/move_base_simple/goal",
            "pointTopic": "/clicked_point",
            "poseEstimateTopic": "/initialpose",
            "poseEstimateXDeviation": 0.5,
            "poseEstimateYDeviation": 0.5,
            "poseEstimateThetaDeviation": 0.26179939,
        },
        "imageMode": {},
    }


# ---- arrangement


def _split(direction: str, nodes: Sequence[LayoutNode]) -> LayoutNode:
    """Panels of equal size, side by side or one above another."""
    first, *others = nodes
    if not others:
        return first
    return {
        "direction": direction,
        "splitPercentage": round(100 / len(nodes), 1),
        "first": first,
        "second": _split(direction, others),
    }


def _row(*nodes: LayoutNode) -> LayoutNode:
    return _split("row", nodes)


def _column(*nodes: LayoutNode) -> LayoutNode:
    return _split("column", nodes)


def _whole(scenes: Sequence[str], right: LayoutNode) -> LayoutNode:
    left = {
        "direction": "column",
        "splitPercentage": 70,
        "first": _row(*scenes),
        "second": "StateTransitions!program",
    }
    return {"direction": "row", "splitPercentage": 58, "first": left, "second": right}


_LOG: Final = "RosOut!log"
_TEXTS: Final = _column("RawMessages!block", "RawMessages!event")
