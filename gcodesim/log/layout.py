"""Layouts of the viewer: the panels that show a log, for milling, for a robot, or for another process.

A layout names every scene topic and every joint, because the viewer shows only
what its layout names. Charts are in units of the shop floor, which a log has
beside SI: a viewer converts nothing. Legends stand to the left of charts that
are some 280 pixels wide, so names in them are short. Panel titles are written
for Foxglove and for Lichtblick, which call the key differently.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any, Final

from gcodesim.frozen import frozen
from gcodesim.log.description import ProcessField, with_peaks
from gcodesim.log.labels import labels_of, short_names
from gcodesim.log.shop_units import twins_among, without_twins
from gcodesim.log.topics import MOST_TILES, topic_table, topics_of_channel

KINDS: Final = ("milling", "robot", "process")

Json = dict[str, Any]
LayoutNode = str | Json
"""A panel by its name, or two of these side by side."""

_VOLUME: Final = "Plot!volume"
_OWN: Final = "Plot!own"
_CELL: Final = "3D!cell"
_PART: Final = "3D!part"

_SIX_NAMES: Final = 28.0
"""Per cent of the height of a window in which a legend shows six joints."""

_LEGEND_EDGE: Final = 58.0
_LEGEND_LETTER: Final = 16.0
_LEGEND_MOST: Final = 160.0
"""Pixels that a legend asks for beside its names, for a letter, and at most.

A letter takes 7, but Lichtblick 1.28 gives a legend less than it asks for: in a panel of 225 pixels (a window of 1400)
76 of 100, 86 of 120, 95 of 150, of which 57 are beside the name.
"""

_AXES: Final = 0.03
"""Length of the axes at the tip, as a share of the distance of the camera."""


@frozen
class ViewerCamera:
    """Looks at `target` [m] in world, from `distance` [m]."""

    target: tuple[float, float, float] = (0.0, 0.0, 0.25)
    distance: float = 2.4


@frozen
class View:
    """ViewerCamera of the cell, and one close to the part where the first is far."""

    cell: ViewerCamera = ViewerCamera()
    part: ViewerCamera | None = None


def layout(
    kind: str,
    joints: Sequence[str],
    outputs: Sequence[str] = (),
    view: View | None = None,
    fields: Sequence[ProcessField] = (),
    channels: Sequence[str] = (),
    images: Sequence[tuple[str, str]] = (),
    drawn: Sequence[str] = (),
) -> bytes:
    """A layout as JSON for a log with those joints, outputs (names as in `/program`) and fields of its processes.

    What `channels` of further programs draw is shown as well, and the pictures of cameras, `images`: their topics and
    those of their calibrations. `drawn` are further topics with shapes.

    KeyError for another kind.
    """
    view = view or View()
    own = _own_plots([field.name for field in fields if not field.flag])
    panels, right = {"milling": _milling, "robot": _robot, "process": _process}[kind](joints, own)
    panels |= {name: _scene(name, camera, channels, drawn) for name, camera in _cameras(view).items()}
    panels |= {_image_name(topic): _image(topic, calibration) for topic, calibration in images}
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
        "layout": _whole([*_cameras(view), *(_image_name(topic) for topic, _ in images)], right),
    }
    return (json.dumps(whole, indent=1) + "\n").encode()


def view_of(layout_json: bytes) -> View:
    """Where the camera of a layout looks; ValueError or KeyError if it is not one of our layouts."""
    panels = json.loads(layout_json)["configById"]
    part = _camera_of(panels[_PART]) if _PART in panels else None
    return View(cell=_camera_of(panels[_CELL]), part=part)


def _camera_of(panel: Json) -> ViewerCamera:
    x, y, z = panel["cameraState"]["targetOffset"]
    return ViewerCamera(target=(x, y, z), distance=panel["cameraState"]["distance"])


def _cameras(view: View) -> dict[str, ViewerCamera]:
    """The cameras by their panels."""
    return {_CELL: view.cell} | ({} if view.part is None else {_PART: view.part})


# ---- what each kind shows


def _milling(joints: Sequence[str], own: Json) -> tuple[Json, LayoutNode]:
    panels = {
        "Plot!force": _plot("force [N]", {"force": "/process.max_force_n"}),
        "Plot!feed": _plot("feed [mm/min]", _FEED),
        "Plot!torque": _plot("torque [N m]", {"torque": "/process.max_torque_nm"}),
        "Plot!power": _plot("power [W], speed [rpm]", {"power": "/process.max_power_w", "rpm": "/process.spindle_rpm"}),
        _VOLUME: _plot("removed [cm3]", {"removed": "/process.removed_cm3"}),
        "Plot!tip": _plot("tip in work coordinates [mm]", _TIP),
    }
    rows = [_row("Plot!force", "Plot!feed"), _row("Plot!torque", "Plot!power"), _row(_VOLUME, "Plot!tip")]
    return _with_own(panels, own), _column(*rows, *_rows_of(own), _LOG)


def _robot(joints: Sequence[str], own: Json) -> tuple[Json, LayoutNode]:
    panels = {
        "Plot!joints": _plot("joints [deg, mm]", _of_joints("/motion", joints, "position_shown")),
        "Plot!efforts": _plot("effort [N m, N]", _of_joints("/joint_states", joints, "effort")),
        "Plot!limits": _plot("part of the limits that is used", _LIMITS, lines=(1.0,)),
        "Plot!following": _plot(
            "following error [um, deg]", {"um": "/motion.position_error_um", "deg": "/motion.orientation_error_deg"}
        ),
        "Plot!force": _plot("force [N]", {"force": "/process.max_force_n"}),
        "Plot!torque": _plot("torque [N m]", {"torque": "/process.max_torque_nm"}),
        "Plot!feed": _plot("feed [mm/min]", _FEED),
    }
    rows = [_row("Plot!limits", "Plot!following"), _row("Plot!force", "Plot!torque")]
    panels, last = _with_own(panels, own), _row("Plot!feed", _LOG)
    right = _column(*rows, *_rows_of(own), last)
    return panels, _above(_row("Plot!joints", "Plot!efforts"), right, _SIX_NAMES)


def _process(joints: Sequence[str], own: Json) -> tuple[Json, LayoutNode]:
    panels = {
        _VOLUME: _plot("removed [cm3]; below 0 added", {"volume": "/process.removed_cm3"}),
        "Plot!feed": _plot("feed [mm/min]", _FEED),
        "Plot!tip": _plot("tip in work coordinates [mm]", _TIP),
        "Plot!limits": _plot("part of the limits that is used", _LIMITS, lines=(1.0,)),
        "Plot!joints": _plot("joints [deg, mm]", _of_joints("/motion", joints, "position_shown")),
    }
    rows: list[LayoutNode] = [_VOLUME, _row("Plot!feed", "Plot!tip"), _row("Plot!limits", "Plot!joints")]
    return _with_own(panels, own), _column(*rows, *_rows_of(own), _LOG)


_FEED: Final = {"tip": "/motion.feed_mm_min", "set": "/motion.feed_command_mm_min"}
_TIP: Final = {letter.upper(): f"/motion.{letter}_mm" for letter in "xyz"}
_LIMITS: Final = {name: f"/motion.{name}_used" for name in ("travel", "speed", "effort")}


def _of_joints(topic: str, joints: Sequence[str], field: str) -> dict[str, str]:
    return {
        label: f'{topic}.joints[:]{{name=="{name}"}}.{field}'
        for name, label in zip(joints, short_names([name.rpartition("/")[2] for name in joints]), strict=True)
    }


# ---- figures that the processes of one log have

_UNITS: Final = {"_mm": "mm", "_um": "um", "_n": "N", "_nm": "N m", "_w": "W", "_mm_min": "mm/min", "_mm3": "mm3"}
_BESIDE: Final = {"peak_force_n": "Plot!force", "peak_torque_nm": "Plot!torque"}
"""What is of the kind of a figure that every log has stands beside it, if there is such a chart."""


def _own_plots(names: Sequence[str]) -> Json:
    """For each unit the curves by label, in units of the shop floor where the log has them; "" for all others."""
    twins, found = twins_among(names), Json()
    for figure, field in with_peaks(without_twins(names)).items():
        shown = twins.get(field, field)
        unit = next((said for end, said in _UNITS.items() if shown.endswith(end)), "")
        found.setdefault(unit, {})[figure] = f"/process.{shown}"
    return found


def _with_own(panels: Json, own: Json) -> Json:
    """The panels, with the figures of the processes beside their like, and the rest by units in panels of their own."""
    for unit, curves in own.items():
        for figure in [name for name in curves if _BESIDE.get(name) in panels]:
            path = curves.pop(figure)
            panels[_BESIDE[figure]]["paths"].append(_curve("peak", path))
            _fit_legend(panels[_BESIDE[figure]])
        if curves:
            title = f"of the process [{unit or 'SI'}]"
            panels[_own_name(unit)] = _plot(title, dict(zip(labels_of(list(curves)), curves.values(), strict=True)))
    return panels


def _own_name(unit: str) -> str:
    return f"{_OWN} {unit}" if unit else _OWN


def _rows_of(own: Json) -> list[LayoutNode]:
    """The panels of own figures, two in a row; they have been made by `_with_own`."""
    names = [_own_name(unit) for unit, curves in own.items() if curves]
    return [_row(*names[i : i + 2]) for i in range(0, len(names), 2)]


# ---- panels


def _titled(title: str) -> Json:
    return {"foxglovePanelTitle": title, "lichtblickPanelTitle": title}


def _plot(title: str, paths: dict[str, str], lines: Sequence[float] = ()) -> Json:
    """Curves by label over time, and level lines at fixed values."""
    curves = [_curve(label, value) for label, value in paths.items()]
    curves += [{**_curve("limit", f"{line:g}"), "color": "#d02030"} for line in lines]
    panel = {
        **_titled(title),
        "paths": curves,
        "showXAxisLabels": True,
        "showYAxisLabels": True,
        "legendDisplay": "left",
        "showPlotValuesInLegend": False,
        "isSynced": True,
        "xAxisVal": "timestamp",
    }
    _fit_legend(panel)
    return panel


def _fit_legend(panel: Json) -> None:
    """A legend as wide as its names need, and none for one curve."""
    longest = max(len(path["label"]) for path in panel["paths"])
    panel["showLegend"] = len(panel["paths"]) > 1
    panel["sidebarDimension"] = round(min(_LEGEND_EDGE + _LEGEND_LETTER * longest, _LEGEND_MOST))


def _curve(label: str, value: str) -> Json:
    return {"value": value, "label": label, "enabled": True, "timestampMethod": "receiveTime"}


def _states(outputs: Sequence[str], flags: Sequence[str]) -> Json:
    paths = [(name, f"/program.{name}") for name in ("line", "tool", "motion", "state")]
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


def _image_name(topic: str) -> str:
    return f"Image!{topic.split('/')[-2]}"


def _image(topic: str, calibration: str) -> Json:
    mode = {"imageTopic": topic, "calibrationTopic": calibration, "imageSchemaName": "foxglove.CompressedImage"}
    return {**_titled(topic), "imageMode": mode, "synchronize": False}


def _scene(panel: str, camera: ViewerCamera, channels: Sequence[str] = (), drawn: Sequence[str] = ()) -> Json:
    topics = [*topic_table(MOST_TILES, MOST_TILES), *(topic for name in channels for topic in topics_of_channel(name))]
    scenes = [*(topic.name for topic in topics if topic.schema == "foxglove.SceneUpdate"), *drawn]
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


def _above(top: LayoutNode, rest: LayoutNode, percent: float) -> LayoutNode:
    return {"direction": "column", "splitPercentage": percent, "first": top, "second": rest}


def _row(*nodes: LayoutNode) -> LayoutNode:
    return _split("row", nodes)


def _column(*nodes: LayoutNode) -> LayoutNode:
    return _split("column", nodes)


def _whole(scenes: Sequence[str], right: LayoutNode) -> LayoutNode:
    left = {
        "direction": "column",
        "splitPercentage": 64,
        "first": _row(*scenes),
        "second": {"direction": "row", "splitPercentage": 68, "first": "StateTransitions!program", "second": _TEXTS},
    }
    return {"direction": "row", "splitPercentage": 58, "first": left, "second": right}


_LOG: Final = "RosOut!log"
_TEXTS: Final = _column("RawMessages!block", "RawMessages!event")
