"""Faces of Wavefront OBJ files, checked and put into the form that every reader takes in the same way.

Corners count from 1 over the whole file; −1 is the last one before the face (Wavefront, Advanced Visualizer manual,
appendix B1). Readers differ in what they make of 0, of a corner that is not there and of corners counted backwards.
"""

from __future__ import annotations

import re
from typing import Final

import numpy as np

from gcodesim.frames import Array

NUMBER: Final = rb"([-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?)"
"""As text files of meshes have it."""
_VERTEX = re.compile(rb"^v\s+" + NUMBER + rb"\s+" + NUMBER + rb"\s+" + NUMBER, re.MULTILINE)
_VERTICES = re.compile(rb"^v\s", re.MULTILINE)
_FACE = re.compile(rb"^f((?:[ \t]+[0-9]{1,9}(?:/[0-9]*){0,2}){3,})[ \t]*\r?$", re.MULTILINE)
_FACES = re.compile(rb"^f\s", re.MULTILINE)
_CORNER = re.compile(rb"[ \t]([0-9]+)")
_CONTINUED = re.compile(rb"\\\r?\n")
_LINE = re.compile(rb"\r\n|\r|\n")
_INTEGER = re.compile(rb"[-+]?[0-9]{1,9}")


class ObjError(ValueError):
    """What is wrong with a face, and on which line."""


def plain_points(raw: bytes) -> Array | None:
    """Corners (n, 3) of a file that is as most programs write it, with no face whose corner is not there; else None."""
    points = np.array(_VERTEX.findall(raw), dtype=np.float64).reshape(-1, 3)
    faces = _FACE.findall(raw)
    if not faces or len(points) != len(_VERTICES.findall(raw)) or len(faces) != len(_FACES.findall(raw)):
        return None
    corners = [int(corner) for face in faces for corner in _CORNER.findall(face)]
    return points if min(corners) >= 1 and max(corners) <= len(points) else None


def counted_from_one(raw: bytes) -> bytes:
    """The same file with corners of faces counted from 1 only; ObjError for a face that names none or too few."""
    if plain_points(raw) is not None:
        return raw
    lines = _LINE.split(_CONTINUED.sub(b" ", raw))
    total, before = sum(_is(line, b"v") for line in lines), 0
    for number, line in enumerate(lines):
        before += _is(line, b"v")
        if _is(line, b"f"):
            corners = [word.split(b"/")[0] for word in line.split(b"#")[0].split()[1:]]
            if len(corners) < 3:
                raise ObjError(f"a face on line {number + 1} has {len(corners)} corners; 3 are the least")
            which = [str(_place(corner, before, total, number + 1)).encode() for corner in corners]
            lines[number] = b" ".join((b"f", *which))
    return b"\n".join(lines)


def _is(line: bytes, word: bytes) -> bool:
    """Whether this is the first word of a line."""
    return line.split(maxsplit=1)[:1] == [word]


def _place(corner: bytes, before: int, total: int, line: int) -> int:
    """Where a corner is, from 1; `before` of `total` corners stand above the line."""
    text = corner.decode("ascii", "replace")
    if not _INTEGER.fullmatch(corner):
        raise ObjError(f"a face on line {line} names the corner `{text[:20]}`, which is no number of one")
    place = int(corner)
    if place == 0:
        raise ObjError(f"a face on line {line} names corner 0, but corners count from 1")
    place = before + 1 + place if place < 0 else place
    if not 1 <= place <= total:
        raise ObjError(
            f"a face on line {line} names corner {text}, but there are {before if text[0] == '-' else total}"
        )
    return place
