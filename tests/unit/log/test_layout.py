"""The layout shows every topic that a log may have: the viewer hides scenes that it does not name."""

import json

from gcodesim.log.layout import default_layout
from gcodesim.log.topics import MOST_TILES, topic_table


def leaves(node):
    return [node] if isinstance(node, str) else leaves(node["first"]) + leaves(node["second"])


def test_every_scene_topic_is_named_and_visible():
    shown = json.loads(default_layout(["arm/joint_1"]))["configById"]["3D!cell"]["topics"]
    for topic in topic_table(MOST_TILES, MOST_TILES):
        if topic.schema == "foxglove.SceneUpdate":
            assert shown[topic.name]["visible"], topic.name


def test_every_panel_has_its_settings():
    layout = json.loads(default_layout(["arm/joint_1"]))
    assert sorted(leaves(layout["layout"])) == sorted(layout["configById"])


def test_plots_name_topics_and_fields_that_exist():
    from gcodesim.log.schema import message_class

    schemas = {topic.name: topic.schema for topic in topic_table(1, 0)}
    layout = json.loads(default_layout(["mill/x", "mill/y"]))
    for panel in layout["configById"].values():
        for path in panel.get("paths", []):
            topic, _, field = path["value"].partition(".")
            names = [f.name for f in message_class(schemas[topic]).DESCRIPTOR.fields]
            assert field.split("[")[0] in names, path["value"]


def test_the_joint_plot_names_the_joints_of_the_cell():
    plot = json.loads(default_layout(["mill/x", "mill/y"]))["configById"]["Plot!joints"]
    assert [path["value"] for path in plot["paths"]] == [
        '/joint_states.joints[:]{name=="mill/x"}.position',
        '/joint_states.joints[:]{name=="mill/y"}.position',
    ]
    assert [path["label"] for path in plot["paths"]] == ["x", "y"]
