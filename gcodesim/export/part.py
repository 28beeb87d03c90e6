"""The part at a moment, as STL."""

from __future__ import annotations

from pathlib import Path
from typing import BinaryIO, ClassVar, Literal, NamedTuple

import numpy as np

from gcodesim.arithmetic.matrices import applied
from gcodesim.export.exporter import Exporter, NoExportError, Option, Request
from gcodesim.material.stl import write_stl
from gcodesim.material.surface import Surface
from gcodesim.playback.recording import Recording
from gcodesim.playback.scenes import Drawing
from gcodesim.playback.skins import merged, skin_of
from gcodesim.units import MM


class NoPartError(NoExportError):
    """There is no such part to write; the text says why."""


class Written(NamedTuple):
    """The content of an STL; `exact`: it is the stock as computed, not as drawn in the log."""

    triangles: int
    exact: bool


def stock_names(recording: Recording) -> tuple[str, ...]:
    """The stocks of the run: the first one's frame is `stock`, another one's `stock/<name>`."""
    named = tuple(recording.results.get("stocks", {}))
    return named or ("stock",)


def frame_of(recording: Recording, stock: str | None) -> str:
    """The frame of a stock by its name; without a name, of the only stock. NoPartError if that is not unique."""
    names = stock_names(recording)
    if stock is None:
        if len(names) > 1:
            raise NoPartError(f"the run has several stocks; choose one of {', '.join(names)}")
        return "stock"
    if stock not in names:
        raise NoPartError(f"the run has no stock {stock}; it has {', '.join(names)}")
    return "stock" if names.index(stock) == 0 else f"stock/{stock}"


def write_part(
    recording: Recording,
    out: BinaryIO,
    *,
    t_ns: int | None = None,
    stock: str | None = None,
    world: bool = False,
    simplify: float = 0.0,
) -> Written:
    """Write the surface of a stock in mm, in its own frame or in the world; `part_surface` says which it is."""
    own = _written(recording, stock) if t_ns is None and not world and not simplify else None
    if own is not None:  # the file of the run knows which walls were cut; a stock that is loaded does not
        data = own.read_bytes()
        out.write(data)
        return Written(int.from_bytes(data[80:84], "little"), exact=True)
    surface, exact = part_surface(recording, t_ns=t_ns, stock=stock, world=world)
    surface = simplified(surface, simplify)
    write_stl(surface, out)
    return Written(len(surface.faces), exact=exact)


def part_surface(
    recording: Recording, *, t_ns: int | None = None, stock: str | None = None, world: bool = False
) -> tuple[Surface, bool]:
    """The surface of a stock [m], in its own frame or in the world, and whether it is the one that was computed.

    `t_ns` None is the end: there the stock file beside the log gives the
    surface as it was computed. At any other moment, and without that file, the
    log gives it as drawn, which may be coarser. NoPartError if there is none.
    """
    frame = frame_of(recording, stock)
    exact = _computed(recording, stock) if t_ns is None and not world else None
    if exact is not None:
        return exact, True
    moment = recording.end_ns if t_ns is None else t_ns
    all_drawn = [drawing for drawing in recording.stock_at(moment) if drawing.frame == frame]
    drawn = [drawing for drawing in all_drawn if not drawing.id.startswith("film/")]
    surface = _drawn(drawn)
    if not len(surface.faces):
        raise NoPartError("the log draws no stock at that moment")
    if world:
        X = recording.frames().at(frame, moment)
        surface = _surface(applied(X[:3, :3], surface.vertices) + X[:3, 3], surface.faces)
    return surface, False


def simplified(surface: Surface, tolerance: float) -> Surface:
    """The surface with fewer triangles, none of its points more than `tolerance` [m] off; 0 leaves it as it is."""
    if not tolerance:
        return surface
    from gcodesim.material.decimation import decimated

    return decimated(surface, tolerance)


def how_made(exact: bool, request: Request) -> str:
    """In words: where a surface comes from and how far it may be off."""
    how = "as computed" if exact else "as the log draws it"
    return f"{how} within {request.simplify / MM:g} mm" if request.simplify else how


class Stl(Exporter):
    """`--to stl`."""

    kind: ClassVar[str] = "stl"
    says: ClassVar[str] = "the part at a moment, in mm, in its own frame"
    suffix: ClassVar[str] = ".stl"
    writes: ClassVar[Literal["text", "bytes", "folder"]] = "bytes"
    takes: ClassVar[frozenset[Option]] = frozenset(("at", "stock", "world", "simplify"))

    def write(self, recording: Recording, out: BinaryIO, request: Request) -> str:
        written = write_part(
            recording,
            out,
            t_ns=request.at_ns,
            stock=request.stock,
            world=request.world,
            simplify=request.simplify,
        )
        how = how_made(written.exact, request)
        return f"the part at {request.moment(recording) * 1e-9:g} s, {how}, {written.triangles} triangles,"


def stock_file_of(recording: Recording, stock: str | None, suffix: str) -> Path | None:
    """The file in the output folder with what a stock is named and this suffix, if it is there."""
    if recording.folder is None:
        return None
    file = recording.folder / f"{Path(stock or stock_names(recording)[0]).name}{suffix}"
    return file if file.is_file() else None


def _written(recording: Recording, stock: str | None) -> Path | None:
    """The STL file that the run has written with the stock file, if both are there."""
    from gcodesim.material.stock_file import SUFFIX

    return None if stock_file_of(recording, stock, SUFFIX) is None else stock_file_of(recording, stock, ".stl")


def _computed(recording: Recording, stock: str | None) -> Surface | None:
    """The surface of the stock file in the output folder, if it is there."""
    from gcodesim.material.stock_file import SUFFIX, load_stock
    from gcodesim.material.true_volume import surface_for_files

    file = stock_file_of(recording, stock, SUFFIX)
    return None if file is None else surface_for_files(load_stock(file))


def _drawn(drawings: list[Drawing]) -> Surface:
    """All tiles as one: points that neighbours share become one, so that the surface is closed where the tiles are."""
    points, triangles = merged([skin_of(shape) for drawing in drawings for shape in drawing.shapes])
    if not len(points):
        return _surface(points, triangles)
    unique, number = np.unique(points, axis=0, return_inverse=True)
    triangles = number.reshape(-1)[triangles]
    a, b, c = triangles.T
    return _surface(unique, triangles[(a != b) & (b != c) & (c != a)])


def _surface(vertices: np.ndarray, faces: np.ndarray) -> Surface:
    return Surface(vertices=vertices, faces=faces.astype(np.int32), cut=np.zeros(len(faces), dtype=bool))
