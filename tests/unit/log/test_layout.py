"""Layouts show every topic that a log may have, and only fields that exist: the viewer hides what they do not name."""

import json

import pytest

from gcodesim.log import ProcessField
from gcodesim.log.labels import LONGEST_LABEL, labels_of, short_names
from gcodesim.log.layout import KINDS, View, ViewerCamera, layout, view_of
from gcodesim.log.schema import message_class
from gcodesim.log.topics import MOST_TILES, topic_table

JOINTS = ["mill/x", "mill/y"]
OUTPUTS = ["analog 2", "digital 1", "gripper"]
FAR = View(
    cell=ViewerCamera(target=(0.5, -0.25, 1.0), distance=3.5),
    part=ViewerCamera(target=(0.9, 0.0, 0.5), distance=0.4),
)

every_kind = pytest.mark.parametrize("kind", KINDS)


def made(kind, joints=JOINTS, outputs=OUTPUTS, view=None):
    return json.loads(layout(kind, joints, outputs, view))


def leaves(node):
    return [node] if isinstance(node, str) else leaves(node["first"]) + leaves(node["second"])


def paths(kind):
    panels = made(kind)["configById"].values()
    shown = [path["value"] for panel in panels for path in panel.get("paths", [])]
    return shown + [panel["topicPath"] for panel in panels if "topicPath" in panel]


@every_kind
def test_every_scene_topic_is_named_and_visible(kind):
    panels = made(kind, view=FAR)["configById"]
    for panel in ("3D!cell", "3D!part"):
        for topic in topic_table(MOST_TILES, MOST_TILES):
            if topic.schema == "foxglove.SceneUpdate":
                assert panels[panel]["topics"][topic.name]["visible"], topic.name


@every_kind
@pytest.mark.parametrize("view", [None, FAR], ids=["one camera", "two cameras"])
def test_every_panel_has_its_settings_and_its_place(kind, view):
    data = made(kind, view=view)
    assert sorted(leaves(data["layout"])) == sorted(data["configById"])
    for panel in data["configById"].values():
        if "topicToRender" not in panel:
            assert panel["foxglovePanelTitle"] == panel["lichtblickPanelTitle"]


@every_kind
def test_panels_name_topics_and_fields_that_exist(kind):
    schemas = {topic.name: topic.schema for topic in topic_table(1, 0)}
    for value in paths(kind):
        if value.replace(".", "").isdigit():  # a level line
            continue
        topic, _, field = value.partition(".")
        descriptor = message_class(schemas[topic]).DESCRIPTOR
        for name in field.split("."):
            found = descriptor.fields_by_name[name.partition("[")[0]]
            descriptor = found.message_type
        assert descriptor is None, f"{value} is no number or text"


def test_joints_and_outputs_are_those_of_the_cell():
    plot = made("robot")["configById"]["Plot!joints"]
    assert [path["value"] for path in plot["paths"]] == [
        '/motion.joints[:]{name=="mill/x"}.position_shown',
        '/motion.joints[:]{name=="mill/y"}.position_shown',
    ]
    assert [path["label"] for path in plot["paths"]] == ["x", "y"]
    states = {path["label"]: path["value"] for path in made("robot")["configById"]["StateTransitions!program"]["paths"]}
    assert states["output digital 1"] == '/program.outputs[:]{name=="digital 1"}.value'
    assert states["output gripper"] == '/program.outputs[:]{name=="gripper"}.verb'
    assert states["tool"] == "/program.tool"


def test_each_kind_has_plots_of_its_own():
    plots = {kind: frozenset(name for name in made(kind)["configById"] if name.startswith("Plot!")) for kind in KINDS}
    assert "Plot!power" in plots["milling"] - plots["robot"]
    assert {"Plot!efforts", "Plot!limits"} <= plots["robot"] - plots["milling"]
    assert "Plot!volume" in plots["process"] - plots["robot"]
    with pytest.raises(KeyError):
        layout("turning", JOINTS)


def test_the_view_can_be_taken_from_one_layout_to_another():
    for view in (FAR, View(cell=FAR.cell), View()):
        assert view_of(layout("milling", JOINTS, view=view)) == view
        assert view_of(layout("process", JOINTS, view=view_of(layout("milling", JOINTS, view=view)))) == view


def test_cameras_look_where_they_are_told_and_axes_are_small_to_them():
    panels = made("robot", view=FAR)["configById"]
    for name, camera in (("3D!cell", FAR.cell), ("3D!part", FAR.part)):
        state = panels[name]["cameraState"]
        assert state["targetOffset"] == list(camera.target) and state["distance"] == camera.distance
        assert panels[name]["topics"]["/tcp"]["axisScale"] < 0.05 * camera.distance


FIGURES = [
    *("peak_force_n", "max_peak_force_n", "axial_depth_m", "max_axial_depth_m", "max_axial_depth_mm"),
    *("chip_thickness_m", "max_chip_thickness_m", "max_chip_thickness_mm", "feed_force_n", "heat_j"),
]


def test_figures_of_a_process_are_drawn_by_units_of_the_shop_floor():
    fields = [ProcessField(name=name) for name in FIGURES]
    panels = json.loads(layout("milling", JOINTS, fields=fields))["configById"]

    def curves(panel):
        return {path["label"]: path["value"] for path in panels[panel]["paths"]}

    assert curves("Plot!force") == {"force": "/process.max_force_n", "peak": "/process.max_peak_force_n"}
    wanted = {"depth": "/process.max_axial_depth_mm", "chip": "/process.max_chip_thickness_mm"}
    assert curves("Plot!own mm") == wanted
    assert list(curves("Plot!own N").values()) == ["/process.feed_force_n"]
    assert list(curves("Plot!own").values()) == ["/process.heat_j"]


def test_names_in_legends_are_short_and_tell_joints_apart():
    assert short_names(["joint_1", "joint_2", "X", "joint_a3"]) == ["J1", "J2", "X", "A3"]
    ur = ["shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint", "wrist_1_joint", "wrist_2_joint"]
    assert short_names(ur) == ["sho pan", "sho lif", "elbow", "wrist 1", "wrist 2"]
    assert short_names(["left_finger_of_one", "left_finger_of_two"]) == ["left_finger_of_one", "left_finger_of_two"]
    assert all(len(name) <= LONGEST_LABEL for name in short_names(ur))
    figures = ["axial_depth_m", "radial_width_m", "feed_force_n", "side_force_n"]
    assert labels_of(figures) == ["depth", "width", "feed", "side"]


def test_the_line_of_the_program_comes_first_and_legends_fit_their_names():
    panels = made("robot", joints=["joint_1", "joint_2"])["configById"]

    assert panels["StateTransitions!program"]["paths"][0]["value"] == "/program.line"
    width = {name: panel["sidebarDimension"] for name, panel in panels.items() if name.startswith("Plot!")}
    assert width["Plot!joints"] < width["Plot!limits"] <= 160  # what leaves a chart in a window of 1400 pixels
    for name, panel in panels.items():
        if name.startswith("Plot!"):
            longest = max(len(path["label"]) for path in panel["paths"])
            given = 36 + 0.4 * panel["sidebarDimension"]  # measured there, in a panel of 225 pixels
            assert given >= 57 + 6.5 * min(longest, 6), name
