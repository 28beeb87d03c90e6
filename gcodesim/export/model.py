"""The whole cell at a moment, as GLB: robot or machine, tool, stock and path."""

from __future__ import annotations

import json
import math
import struct
from collections.abc import Sequence
from typing import Any, BinaryIO, ClassVar, Final, Literal

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.elementary import power
from gcodesim.export.exporter import Exporter, Option, Request
from gcodesim.log.shapes import Color
from gcodesim.log.topics import LOOSE
from gcodesim.playback.frames import RecordedFrames
from gcodesim.playback.recording import Recording
from gcodesim.playback.scenes import Drawing
from gcodesim.playback.skins import skin_of

_Z_UP: Final = [-math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5)]  # in glTF Y is up: a quarter turn about X
_FLOAT, _UINT = 5126, 5125
_VERTICES, _INDICES = 34962, 34963
_TRIANGLES, _LINES = 4, 1


def scene_glb(recording: Recording, t_ns: int) -> bytes:
    """A GLB file in metres: a node for each entity, named as in the log, under one node that turns Z to glTF's Y."""
    frames = recording.frames()
    drawings: list[Drawing] = []
    for topic in ("/scene/cell", "/scene/path", "/scene/tool", LOOSE.name):
        past = [content for time, content in recording.drawings(topic) if time <= t_ns]
        drawings += past[-1] if past else ()
    drawings += recording.stock_at(t_ns)
    return glb_of(drawings, frames, t_ns)


class Glb(Exporter):
    """`--to glb`."""

    kind: ClassVar[str] = "glb"
    says: ClassVar[str] = "the whole cell at a moment: robot or machine, tool, stock, path; in m"
    suffix: ClassVar[str] = ".glb"
    writes: ClassVar[Literal["text", "bytes", "folder"]] = "bytes"
    takes: ClassVar[frozenset[Option]] = frozenset(("at",))

    def write(self, recording: Recording, out: BinaryIO, request: Request) -> str:
        moment = request.moment(recording)
        out.write(scene_glb(recording, moment))
        return f"the cell at {moment * 1e-9:g} s"


def glb_of(drawings: Sequence[Drawing], frames: RecordedFrames, t_ns: int) -> bytes:
    """The GLB of some entities, each where its frame is at `t_ns`.

    Khronos Group, glTF 2.0 (2021): chapter 3 and, for the container, 4.4.
    Written here, because trimesh writes lines without their colour. The same
    drawings give the same bytes.
    """
    file = _File()
    for drawing in drawings:
        primitives = []
        for shape in drawing.shapes:
            solid = skin_of(shape)
            if len(solid.triangles):
                primitives.append(file.primitive(_TRIANGLES, solid.points, solid.triangles, solid.color))
        for lines in drawing.lines:
            if len(lines.segments):
                primitives.append(file.primitive(_LINES, lines.points, lines.segments, lines.color))
        if primitives:
            file.node(drawing.id, frames.at(drawing.frame, t_ns), primitives)
    return file.bytes()


class _File:
    """Collects the parts of a glTF asset."""

    def __init__(self) -> None:
        self._data = bytearray()
        self._views: list[dict[str, Any]] = []
        self._accessors: list[dict[str, Any]] = []
        self._materials: dict[Color, int] = {}
        self._meshes: list[dict[str, Any]] = []
        self._nodes: list[dict[str, Any]] = [{"name": "gcodesim", "rotation": _Z_UP, "children": []}]

    def primitive(
        self,
        mode: int,
        points: NDArray[np.float64],
        indices: NDArray[np.int64],
        color: Color,
    ) -> dict[str, Any]:
        """Without normals: every face is then drawn flat, which keeps the edges of a part sharp."""
        attributes = {"POSITION": self._accessor(points.astype("<f4"), _FLOAT, "VEC3", _VERTICES, bounds=True)}
        index = self._accessor(indices.reshape(-1).astype("<u4"), _UINT, "SCALAR", _INDICES)
        return {"attributes": attributes, "indices": index, "mode": mode, "material": self._material(color)}

    def node(self, name: str, X: NDArray[np.float64], primitives: list[dict[str, Any]]) -> None:
        self._meshes.append({"name": name, "primitives": primitives})
        matrix = [float(value) for value in X.T.reshape(-1)]  # by columns
        self._nodes[0]["children"].append(len(self._nodes))
        self._nodes.append({"name": name, "mesh": len(self._meshes) - 1, "matrix": matrix})

    def bytes(self) -> bytes:
        materials = [_material(color) for color in self._materials]
        asset: dict[str, Any] = {
            "asset": {"version": "2.0", "generator": "gcodesim"},
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": self._nodes if self._nodes[0]["children"] else [{"name": "gcodesim"}],
        }
        if self._meshes:
            asset |= {"meshes": self._meshes, "materials": materials, "accessors": self._accessors}
            asset |= {"bufferViews": self._views, "buffers": [{"byteLength": len(self._data)}]}
        text = json.dumps(asset, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        chunks = struct.pack("<I4s", len(text), b"JSON") + text
        if self._data:
            chunks += struct.pack("<I4s", len(self._data), b"BIN\0") + bytes(self._data)
        return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks

    def _accessor(self, array: NDArray[Any], kind: int, shape: str, target: int, *, bounds: bool = False) -> int:
        data = array.tobytes()
        view = {"buffer": 0, "byteOffset": len(self._data), "byteLength": len(data), "target": target}
        self._data += data + b"\0" * (-len(data) % 4)
        self._views.append(view)
        accessor: dict[str, Any] = {"bufferView": len(self._views) - 1, "componentType": kind, "type": shape}
        accessor["count"] = len(array)
        if bounds:
            accessor["min"] = [float(value) for value in array.min(axis=0)]
            accessor["max"] = [float(value) for value in array.max(axis=0)]
        self._accessors.append(accessor)
        return len(self._accessors) - 1

    def _material(self, color: Color) -> int:
        return self._materials.setdefault(color, len(self._materials))


def _material(color: Color) -> dict[str, Any]:
    """glTF takes colours in linear light; those of a scene are as a screen takes them (IEC 61966-2-1)."""
    linear = [c / 12.92 if c <= 0.04045 else power((c + 0.055) / 1.055, 2.4) for c in color[:3]]
    look: dict[str, Any] = {
        "pbrMetallicRoughness": {
            "baseColorFactor": [*linear, color[3]],
            "metallicFactor": 0.2,
            "roughnessFactor": 0.7,
        },
        "doubleSided": True,
    }
    if color[3] < 1.0:
        look["alphaMode"] = "BLEND"
    return look
