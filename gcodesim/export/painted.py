"""The finished part in colours, as PLY and 3MF; without colours where no target was given, and at other moments."""

from __future__ import annotations

import zipfile
from typing import BinaryIO, ClassVar, Final, Literal
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import applied
from gcodesim.export.exporter import Exporter, NoExportError, Option, Request
from gcodesim.export.part import frame_of, how_made, part_surface, simplified, stock_file_of
from gcodesim.files.output_folder import SKIN_SUFFIX
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.material.skin import PaintedSkin
from gcodesim.material.skin_file import SkinFileError, colours_by, read_skin
from gcodesim.playback.recording import Recording
from gcodesim.units import MM

_TAKES: Final[frozenset[Option]] = frozenset(("at", "stock", "world", "by", "simplify"))
_DATE: Final = (1980, 1, 1, 0, 0, 0)
"""Of the files in an archive: the earliest that it can have, so that the same part gives the same bytes."""

_CONTENT_TYPES: Final = (
    '<?xml version="1.0" encoding="UTF-8"?>\n'
    '<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">'
    '<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
    '<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>\n'
)
_RELATIONS: Final = (
    '<?xml version="1.0" encoding="UTF-8"?>\n'
    '<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">'
    '<Relationship Target="/3D/3dmodel.model" Id="model" '
    'Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>\n'
)


@frozen(eq=False)
class ColouredPart:
    """Vertices (v, 3) [mm], faces (f, 3) seen from outside, and colours (f, 3) if there are any; `how` is in words."""

    vertices: Array
    faces: NDArray[np.int32]
    colours: NDArray[np.uint8] | None
    how: str


def coloured_part(recording: Recording, request: Request) -> ColouredPart:
    """The part that is asked for. NoExportError if there is none, or if it has no colours that are asked for."""
    if request.simplify and request.by is not None:
        raise NoExportError("colours belong to the fine triangles, which `simplify` joins; leave one of the two out")
    skin = None if request.at_ns is not None or request.simplify else _skin_of(recording, request.stock)
    if skin is None:
        if request.by is not None:
            raise NoExportError(
                "there are no colours: only the end of a run with a `target` in its cell has them, beside its log"
            )
        surface, exact = part_surface(recording, t_ns=request.at_ns, stock=request.stock, world=request.world)
        surface, how = simplified(surface, request.simplify), how_made(exact, request)
        return ColouredPart(vertices=surface.vertices / MM, faces=surface.faces, colours=None, how=how)
    by = request.by or "deviation"
    vertices = applied(skin.turn, skin.vertices)
    if request.world:
        X = recording.frames().at(frame_of(recording, request.stock), recording.end_ns)
        vertices = applied(X[:3, :3], skin.vertices) + X[:3, 3]
    return ColouredPart(vertices=vertices / MM, faces=skin.faces, colours=colours_by(skin, by), how=f"coloured by {by}")


def _skin_of(recording: Recording, stock: str | None) -> PaintedSkin | None:
    """The skin beside the log, if it is there and whole."""
    frame_of(recording, stock)  # refuses a name that there is not
    file = stock_file_of(recording, stock, SKIN_SUFFIX)
    if file is None:
        return None
    try:
        return read_skin(file.read_bytes(), file.name)
    except SkinFileError as fault:
        raise NoExportError(str(fault)) from None


class Ply(Exporter):
    """`--to ply`."""

    kind: ClassVar[str] = "ply"
    says: ClassVar[str] = "the part in mm, coloured by its distance from the target, by tool or by line"
    suffix: ClassVar[str] = ".ply"
    writes: ClassVar[Literal["text", "bytes", "folder"]] = "bytes"
    takes: ClassVar[frozenset[Option]] = _TAKES

    def write(self, recording: Recording, out: BinaryIO, request: Request) -> str:
        part = coloured_part(recording, request)
        colour = "property uchar red\nproperty uchar green\nproperty uchar blue\n" if part.colours is not None else ""
        head = (
            "ply\nformat binary_little_endian 1.0\ncomment gcodesim part, unit mm\n"
            f"element vertex {len(part.vertices)}\nproperty float x\nproperty float y\nproperty float z\n"
            f"element face {len(part.faces)}\nproperty list uchar int vertex_indices\n{colour}end_header\n"
        )
        out.write(head.encode())
        out.write(part.vertices.astype("<f4").tobytes())
        fields = [("corners", "u1"), ("corner", "<i4", 3), *([("colour", "u1", 3)] if colour else [])]
        faces = np.zeros(len(part.faces), dtype=np.dtype(fields))
        faces["corners"], faces["corner"] = 3, part.faces
        if part.colours is not None:
            faces["colour"] = part.colours
        out.write(faces.tobytes())
        return f"the part, {part.how}, {len(part.faces)} triangles,"


class ThreeMf(Exporter):
    """`--to 3mf`: 3MF Consortium, Core Specification 1.3; colours by the Materials and Properties Extension 1.2."""

    kind: ClassVar[str] = "3mf"
    says: ClassVar[str] = "the part as PLY has it, in the form of programs that print"
    suffix: ClassVar[str] = ".3mf"
    writes: ClassVar[Literal["text", "bytes", "folder"]] = "bytes"
    takes: ClassVar[frozenset[Option]] = _TAKES

    def write(self, recording: Recording, out: BinaryIO, request: Request) -> str:
        part = coloured_part(recording, request)
        files = {
            "[Content_Types].xml": _CONTENT_TYPES,
            "_rels/.rels": _RELATIONS,
            "3D/3dmodel.model": _model(part, recording.name),
        }
        with zipfile.ZipFile(out, "w") as archive:
            for name, text in files.items():
                entry = zipfile.ZipInfo(name, _DATE)
                entry.compress_type, entry.external_attr, entry.create_system = zipfile.ZIP_DEFLATED, 0o644 << 16, 3
                archive.writestr(entry, text.encode(), compresslevel=6)
        return f"the part, {part.how}, {len(part.faces)} triangles,"


def _model(part: ColouredPart, title: str) -> str:
    vertices = [f'<vertex x="{x:.6g}" y="{y:.6g}" z="{z:.6g}"/>' for x, y, z in part.vertices.tolist()]
    colours = ""
    marks = [""] * len(part.faces)
    if part.colours is not None:
        inks, which = np.unique(part.colours, axis=0, return_inverse=True)
        listed = "".join(f'<m:color color="#{r:02X}{g:02X}{b:02X}"/>' for r, g, b in inks.tolist())
        colours = f'<m:colorgroup id="2">{listed}</m:colorgroup>\n'
        marks = [f' pid="2" p1="{ink}"' for ink in which.reshape(-1).tolist()]
    triangles = [
        f'<triangle v1="{a}" v2="{b}" v3="{c}"{mark}/>'
        for (a, b, c), mark in zip(part.faces.tolist(), marks, strict=True)
    ]
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n<model unit="millimeter" xml:lang="en-US" '
        'xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02" '
        'xmlns:m="http://schemas.microsoft.com/3dmanufacturing/material/2015/02">\n<resources>\n'
        f'{colours}<object id="1" type="model" name={quoteattr(title)}><mesh><vertices>\n'
        + "\n".join(vertices)
        + "\n</vertices><triangles>\n"
        + "\n".join(triangles)
        + '\n</triangles></mesh></object>\n</resources>\n<build><item objectid="1"/></build>\n</model>\n'
    )
