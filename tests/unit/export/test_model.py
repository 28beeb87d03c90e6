"""The cell at a moment, as GLB."""

import json
import struct
from io import BytesIO

import numpy as np
import trimesh

from gcodesim.export.model import scene_glb


def index_of(data):
    length, kind = struct.unpack_from("<I4s", data, 12)
    assert data[:4] == b"glTF" and kind == b"JSON" and struct.unpack_from("<II", data, 4) == (2, len(data))
    return json.loads(data[20 : 20 + length])


def test_machine_tool_stock_and_path_are_there(slot):
    names = [node["name"] for node in index_of(scene_glb(slot, 6_000_000_000))["nodes"]]

    assert {"gcodesim", "machine/base", "tool", "feed", "rapid", "stock/00"} <= set(names)


def test_another_reader_finds_the_tool_at_the_tip(slot):
    t_ns = 6_000_000_000
    scene = trimesh.load_scene(BytesIO(scene_glb(slot, t_ns)), file_type="glb")
    # Y is up in the file: turned back, the lowest point of the tool is the tip
    back = np.array([[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]], dtype=float)
    points = []
    for node in scene.graph.nodes_geometry:
        X, name = scene.graph[node]
        if node.startswith("tool"):
            points.append(trimesh.transform_points(scene.geometry[name].vertices, back @ X))
    tip = slot.frames().at("tcp", t_ns)[:3, 3]
    lowest = np.concatenate(points)[:, 2].min()

    assert abs(lowest - tip[2]) < 1e-5
    assert np.allclose(np.concatenate(points)[:, :2].mean(axis=0), tip[:2], atol=1e-4)


def test_moments_differ_and_each_is_the_same_again(slot):
    early, late = scene_glb(slot, 0), scene_glb(slot, slot.end_ns)

    assert early != late and early == scene_glb(slot, 0)


def test_lines_have_the_colour_of_the_log(slot):
    index = index_of(scene_glb(slot, 0))
    mesh = next(mesh for mesh in index["meshes"] if mesh["name"] == "rapid")
    red, green, blue, _ = index["materials"][mesh["primitives"][0]["material"]]["pbrMetallicRoughness"][
        "baseColorFactor"
    ]

    assert mesh["primitives"][0]["mode"] == 1 and red > green > blue  # orange
