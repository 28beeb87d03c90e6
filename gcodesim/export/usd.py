"""A run as an OpenUSD stage: links, tool, fixtures and path, moving over time, and the stock before and after."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any, BinaryIO, ClassVar, Final, Literal

import numpy as np

from gcodesim.export.exporter import Exporter, NoExportError, Option, Request, counted
from gcodesim.extras import require_extra
from gcodesim.playback.frames import Array, RecordedFrames
from gcodesim.playback.recording import Recording
from gcodesim.playback.scenes import Drawing, Lines
from gcodesim.playback.skins import skin_of
from gcodesim.units import NS_PER_SECOND

_RATE: Final = 50.0
"""Time codes a second where the log does not say its period."""
_PIXEL: Final = 2e-4  # [m] of a line for each pixel that it is wide on a screen


class Usd(Exporter):
    """`--to usd`: text (`.usda`), which `usdview` and the viewers of that world open."""

    kind: ClassVar[str] = "usd"
    says: ClassVar[str] = "an OpenUSD stage with animation: links, tool, path, stock before and after; in m, Z up"
    suffix: ClassVar[str] = ".usda"
    writes: ClassVar[Literal["text", "bytes", "folder"]] = "bytes"
    takes: ClassVar[frozenset[Option]] = frozenset(("period",))
    extra: ClassVar[str] = "usd"

    def write(self, recording: Recording, out: BinaryIO, request: Request) -> str:
        require_extra("usd", "an OpenUSD stage")
        stage = _Stage(recording, request.part.period_ns)
        stage.fill()
        out.write(self._packed(stage))
        return counted(stage.bodies, "body") if stage.bodies == 1 else f"{stage.bodies} bodies"

    def _packed(self, stage: _Stage) -> bytes:
        return stage.text().encode()


class PackedUsd(Usd):
    """`--to usdc`: the same stage in OpenUSD's binary form, which is smaller and opens sooner."""

    kind: ClassVar[str] = "usdc"
    says: ClassVar[str] = "the same as `usd`, in OpenUSD's binary form (.usdc)"
    suffix: ClassVar[str] = ".usdc"

    def _packed(self, stage: _Stage) -> bytes:
        return stage.crate()


class _Stage:
    """A stage that is being filled. Each entity of the log is a transform of its own below `/World`."""

    def __init__(self, recording: Recording, period_ns: int) -> None:
        from pxr import Sdf, Usd, UsdGeom

        self.recording = recording
        self.bodies = 0
        self.names: set[str] = set()
        self.stage = Usd.Stage.CreateInMemory()
        UsdGeom.SetStageUpAxis(self.stage, UsdGeom.Tokens.z)
        UsdGeom.SetStageMetersPerUnit(self.stage, 1.0)
        period = max(period_ns, recording.period_ns)
        self.rate = NS_PER_SECOND / period if period else _RATE
        self.stage.SetTimeCodesPerSecond(self.rate)
        self.stage.SetFramesPerSecond(self.rate)
        self.stage.SetStartTimeCode(0.0)
        self.stage.SetEndTimeCode(self.code(recording.end_ns))
        self.stage.SetDefaultPrim(UsdGeom.Xform.Define(self.stage, "/World").GetPrim())
        self.stage.GetRootLayer().comment = f"{recording.name}, by gcodesim"
        self.frames: RecordedFrames = recording.frames(period_ns)
        self._path = Sdf.Path("/World")

    def code(self, t_ns: int) -> float:
        """The time code of a moment."""
        return round(t_ns / NS_PER_SECOND * self.rate, 6)

    def text(self) -> str:
        found: str = self.stage.GetRootLayer().ExportToString()
        return found

    def crate(self) -> bytes:
        """In the binary form, which the library writes into files alone."""
        with tempfile.TemporaryDirectory(prefix="gcodesim-") as folder:
            path = Path(folder) / "stage.usdc"
            if not self.stage.GetRootLayer().Export(str(path)):
                raise NoExportError("OpenUSD could not write its binary form")
            return path.read_bytes()

    def fill(self) -> None:
        """Everything that the log draws."""
        recording = self.recording
        end = recording.end_ns
        for topic in ("/scene/cell", "/scene/path"):
            for _, content in recording.drawings(topic)[-1:]:
                for drawing in content:
                    self.body(drawing.id, drawing)
        tools = recording.tools()
        for number, (t_ns, content) in enumerate(tools):
            until = tools[number + 1][0] if number + 1 < len(tools) else None
            for drawing in content:
                prim = self.body(f"{drawing.id}_{number}" if number else drawing.id, drawing)
                self.seen(prim, t_ns, until)
        for name, t_ns in (("before", 0), ("after", end)):
            for drawing in recording.stock_at(t_ns):
                prim = self.body(f"{drawing.id}_{name}", drawing)
                self.seen(prim, 0 if name == "before" else end, end if name == "before" else None)

    def seen(self, prim: Any, since_ns: int, until_ns: int | None) -> None:
        """Show a body from one moment until another."""
        from pxr import UsdGeom

        visibility = UsdGeom.Imageable(prim).CreateVisibilityAttr()
        if since_ns > 0:
            visibility.Set(UsdGeom.Tokens.invisible, 0.0)
        visibility.Set(UsdGeom.Tokens.inherited, self.code(since_ns))
        if until_ns is not None:
            visibility.Set(UsdGeom.Tokens.invisible, self.code(until_ns))

    def body(self, name: str, drawing: Drawing) -> Any:
        """An entity, where its frame is at each instant."""
        from pxr import UsdGeom

        path = self._path.AppendChild(self._name(name))
        prim = UsdGeom.Xform.Define(self.stage, path)
        self._move(prim, drawing.frame)
        for number, shape in enumerate(drawing.shapes):
            solid = skin_of(shape)
            if len(solid.triangles):
                mesh = UsdGeom.Mesh.Define(self.stage, path.AppendChild(f"mesh_{number}"))
                mesh.CreatePointsAttr(_vectors(solid.points))
                mesh.CreateFaceVertexIndicesAttr(_integers(solid.triangles))
                mesh.CreateFaceVertexCountsAttr(_integers(np.full(len(solid.triangles), 3)))
                mesh.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
                mesh.CreateDoubleSidedAttr(True)
                mesh.CreateExtentAttr(_vectors(_bounds(solid.points)))
                _colour(mesh, solid.color)
        for number, lines in enumerate(drawing.lines):
            if len(lines.segments):
                self._curves(path.AppendChild(f"lines_{number}"), lines)
        self.bodies += 1
        return prim.GetPrim()

    def _name(self, text: str) -> Any:
        from pxr import Tf

        name = Tf.MakeValidIdentifier(text)
        number = 1
        while name in self.names:
            number += 1
            name = f"{Tf.MakeValidIdentifier(text)}_{number}"
        self.names.add(name)
        return name

    def _move(self, prim: Any, frame: str) -> None:
        """The pose of a frame in the world as time samples, or as it is if it never moves."""
        from pxr import Gf

        X = self.frames.in_world(frame)
        op = prim.AddTransformOp()
        if len(X) == 1 or bool((X[:1] == X).all()):
            op.Set(Gf.Matrix4d(*_rows(X[0])))
            return
        for t_ns, pose in zip(self.frames.t_ns.tolist(), X, strict=True):
            op.Set(Gf.Matrix4d(*_rows(pose)), self.code(t_ns))

    def _curves(self, path: Any, lines: Lines) -> None:
        from pxr import UsdGeom

        curves = UsdGeom.BasisCurves.Define(self.stage, path)
        points = lines.points[lines.segments.reshape(-1)]
        curves.CreateTypeAttr(UsdGeom.Tokens.linear)
        curves.CreatePointsAttr(_vectors(points))
        curves.CreateCurveVertexCountsAttr(_integers(np.full(len(lines.segments), 2)))
        curves.CreateWidthsAttr([_PIXEL * max(lines.pixels, 1.0)])
        curves.SetWidthsInterpolation(UsdGeom.Tokens.constant)
        curves.CreateExtentAttr(_vectors(_bounds(points)))
        _colour(curves, lines.color)


def _rows(X: Array) -> list[float]:
    """A pose (4, 4) as USD has it: vectors are rows, so it is transposed."""
    return [float(v) + 0.0 for v in X.T.reshape(-1)]


def _bounds(points: Array) -> Array:
    return np.array([points.min(axis=0), points.max(axis=0)])


def _vectors(points: Array) -> Any:
    from pxr import Vt

    return Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(points, dtype=np.float32) + np.float32(0.0))


def _integers(values: Any) -> Any:
    from pxr import Vt

    return Vt.IntArray.FromNumpy(np.ascontiguousarray(np.asarray(values).reshape(-1), dtype=np.int32))


def _colour(prim: Any, color: Sequence[float]) -> None:
    from pxr import Gf

    prim.CreateDisplayColorAttr([Gf.Vec3f(*(float(c) for c in color[:3]))])
    if color[3] < 1.0:
        prim.CreateDisplayOpacityAttr([float(color[3])])
