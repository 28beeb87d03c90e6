"""The painted skin of a finished part in a file: a binary PLY in mm that viewers show in colours, with all figures."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import BinaryIO, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import applied
from gcodesim.material.skin import Maker, PaintedSkin
from gcodesim.units import MM

HEAD: Final = b"ply\nformat binary_little_endian 1.0\ncomment gcodesim skin"

RAMP: Final = ((178, 24, 43), (239, 138, 98), (247, 247, 247), (103, 169, 207), (33, 102, 172))
"""Colours from a gouge over the right place to excess: five of RdBu (Brewer 1994), told apart by the colour-blind."""

WITHIN: Final = (171, 196, 161)
"""The colour of what is within tolerance."""

UNTOUCHED: Final = (188, 188, 188)
"""The colour of what no tool made."""

PALETTE: Final = (
    *((31, 119, 180), (255, 127, 14), (44, 160, 44), (148, 103, 189), (140, 86, 75)),
    *((227, 119, 194), (188, 189, 34), (23, 190, 207), (214, 39, 40), (127, 127, 127)),
)
"""Ten colours for tools and lines, each told apart from its neighbours."""

_CORNER: Final = np.dtype([("place", "<f4", 3)])
_FACE: Final = np.dtype(
    [("corners", "u1"), ("corner", "<i4", 3), ("colour", "u1", 3), ("deviation", "<f4"), ("maker", "<i4")]
)

Colours = NDArray[np.uint8]


class SkinFileError(ValueError):
    """The file is no painted skin, or is damaged; the text says which."""


def colours_by(skin: PaintedSkin, what: str) -> Colours:
    """Red, green, blue (f, 3) by `deviation`, `tool` or `line`."""
    if what == "deviation":
        return _by_deviation(skin)
    values = [maker.tool if what == "tool" else (maker.file, maker.line) for maker in skin.makers]
    known = {value: number for number, value in enumerate(sorted(set(values)))}
    inks = np.array([UNTOUCHED, *(PALETTE[known[value] % len(PALETTE)] for value in values)], dtype=np.uint8)
    found: Colours = inks[skin.maker + 1]
    return found


def _by_deviation(skin: PaintedSkin) -> Colours:
    """From the first colour of the ramp at four tolerances below the target to the last at four above it."""
    steps = np.array(RAMP, dtype=float)
    at = np.clip(0.5 + skin.deviation / (8.0 * skin.tolerance), 0.0, 1.0) * (len(steps) - 1)
    low = np.minimum(at.astype(np.int64), len(steps) - 2)
    mixed = steps[low] + (at - low)[:, None] * (steps[low + 1] - steps[low])
    mixed[np.abs(skin.deviation) <= skin.tolerance] = WITHIN
    found: Colours = np.rint(mixed).astype(np.uint8)
    return found


def write_skin(skin: PaintedSkin, file: BinaryIO, what: str = "deviation") -> None:
    """Write the skin in the part's own frame [mm], each face in its colour by `what`, with its figures."""
    told = {
        "tolerance_mm": skin.tolerance / MM,
        "turn": skin.turn.astype(float).tolist(),
        "spots_mm": (skin.spots / MM).tolist(),
        "makers": [[maker.file, maker.line, maker.tool] for maker in skin.makers],
    }
    head = HEAD.decode() + (
        f", unit mm, colours by {what}\ncomment {json.dumps(told, ensure_ascii=True)}\n"
        f"element vertex {len(skin.vertices)}\nproperty float x\nproperty float y\nproperty float z\n"
        f"element face {len(skin.faces)}\nproperty list uchar int vertex_indices\n"
        "property uchar red\nproperty uchar green\nproperty uchar blue\n"
        "property float deviation_mm\nproperty int maker\nend_header\n"
    )
    file.write(head.encode())
    corners = np.zeros(len(skin.vertices), dtype=_CORNER)
    corners["place"] = applied(skin.turn, skin.vertices) / MM
    file.write(corners.tobytes())
    faces = np.zeros(len(skin.faces), dtype=_FACE)
    faces["corners"], faces["corner"], faces["colour"] = 3, skin.faces, colours_by(skin, what)
    faces["deviation"], faces["maker"] = skin.deviation / MM, skin.maker
    file.write(faces.tobytes())


def read_skin(raw: bytes, name: str) -> PaintedSkin:
    """The skin in the bytes of a file called `name`; SkinFileError if they are none that `write_skin` wrote."""
    if not raw.startswith(HEAD):
        raise SkinFileError(f"{name} is no painted skin that gcodesim wrote")
    try:
        end = raw.index(b"end_header\n") + len(b"end_header\n")
        lines = raw[:end].decode().splitlines()
        told = json.loads(lines[3].removeprefix("comment "))
        corners, faces = (int(_number(lines, what)) for what in ("element vertex", "element face"))
        split = end + corners * _CORNER.itemsize
        if len(raw) != split + faces * _FACE.itemsize:
            raise ValueError("its length does not fit")
        places = np.frombuffer(raw[end:split], _CORNER)["place"].astype(float) * MM
        body = np.frombuffer(raw[split:], _FACE)
        turn = np.array(told["turn"], dtype=float).reshape(3, 3)
        makers = [Maker(file=str(file), line=int(line), tool=int(tool)) for file, line, tool in told["makers"]]
        skin = PaintedSkin(
            vertices=applied(turn.T, places),
            faces=body["corner"].astype(np.int32),
            deviation=body["deviation"].astype(float) * MM,
            maker=body["maker"].astype(np.int32),
            makers=makers,
            turn=turn,
            tolerance=float(told["tolerance_mm"]) * MM,
            spots=np.array(told["spots_mm"], dtype=float).reshape(-1, 2, 3) * MM,
        )
    except (ValueError, LookupError, TypeError, AttributeError) as fault:
        raise SkinFileError(f"{name} is damaged: {fault}") from fault
    if len(skin.faces) and (
        skin.faces.min() < 0 or skin.faces.max() >= corners or skin.maker.min() < -1 or skin.maker.max() >= len(makers)
    ):
        raise SkinFileError(f"{name} is damaged: its parts do not fit together")
    return skin


def _number(lines: Sequence[str], what: str) -> str:
    return next(line for line in lines if line.startswith(what)).rpartition(" ")[2]
