"""A run as an OpenUSD stage, opened by its own library."""

from __future__ import annotations

import io

import numpy as np
import pytest
from pxr import Usd, UsdGeom

from gcodesim.export.exporter import Request
from gcodesim.export.select import TimeRange
from gcodesim.export.usd import PackedUsd
from gcodesim.export.usd import Usd as UsdExporter
from gcodesim.playback import Recording


@pytest.fixture(scope="module")
def stage(slot_folder):
    out = io.BytesIO()
    UsdExporter().write(Recording.open(slot_folder), out, Request(part=TimeRange(period_ns=100_000_000)))
    stage = Usd.Stage.CreateInMemory()
    assert stage.GetRootLayer().ImportFromString(out.getvalue().decode())
    return stage


def test_stage_says_units_axis_and_times(stage, slot):
    assert UsdGeom.GetStageUpAxis(stage) == UsdGeom.Tokens.z
    assert UsdGeom.GetStageMetersPerUnit(stage) == 1.0
    assert stage.GetDefaultPrim().GetName() == "World"
    assert stage.GetEndTimeCode() / stage.GetTimeCodesPerSecond() == pytest.approx(slot.end_ns * 1e-9, abs=1e-6)


def test_the_tool_moves_as_in_the_log(stage, slot):
    """Each body is where its frame is at that moment."""
    prims = {prim.GetName(): prim for prim in stage.GetDefaultPrim().GetChildren()}
    drawing = next(content for _, content in slot.tools() if content)[0]
    prim = next(prim for name, prim in prims.items() if name.startswith(drawing.id.replace("/", "_")))
    frames = slot.frames()
    moved = set()
    for t_ns in range(0, slot.end_ns, 500_000_000):
        cache = UsdGeom.XformCache(t_ns * 1e-9 * stage.GetTimeCodesPerSecond())
        X = np.array(cache.GetLocalToWorldTransform(prim)).T
        np.testing.assert_allclose(X, frames.at(drawing.frame, t_ns), atol=1e-9)
        moved.add(tuple(X[:3, 3].round(6)))
    assert len(moved) > 5


def test_stock_is_seen_before_and_after(stage, slot):
    prims = {prim.GetName(): prim for prim in stage.GetDefaultPrim().GetChildren()}
    before = [prim for name, prim in prims.items() if name.endswith("_before")]
    after = [prim for name, prim in prims.items() if name.endswith("_after")]
    assert before and len(before) == len(after)

    def seen(prim, code):
        return UsdGeom.Imageable(prim).ComputeVisibility(code) != UsdGeom.Tokens.invisible

    middle, end = 0.5 * stage.GetEndTimeCode(), stage.GetEndTimeCode()
    assert all(seen(prim, middle) for prim in before) and not any(seen(prim, end) for prim in before)
    assert not any(seen(prim, middle) for prim in after) and all(seen(prim, end) for prim in after)
    meshes = [UsdGeom.Mesh(child) for prim in before for child in prim.GetChildren() if child.IsA(UsdGeom.Mesh)]
    points = np.concatenate([np.array(mesh.GetPointsAttr().Get()) for mesh in meshes])
    drawn = [shape for drawing in slot.stock_at(0) for shape in drawing.shapes]
    assert len(drawn) == len(meshes)
    assert np.ptp(points, axis=0).max() > 0.01  # in metres, not in mm
    assert np.ptp(points, axis=0).max() < 1.0


def test_tools_are_seen_while_they_are_in_the_spindle(stage, slot):
    changes = [(t_ns, content) for t_ns, content in slot.tools() if content]
    assert len(changes) > 1
    shown = []
    for t_ns, _ in changes:
        code = (t_ns + 1_000_000) * 1e-9 * stage.GetTimeCodesPerSecond()
        shown.append(
            {
                prim.GetName()
                for prim in stage.GetDefaultPrim().GetChildren()
                if "tool" in prim.GetName().lower() or prim.GetName().startswith("T")
                if UsdGeom.Imageable(prim).ComputeVisibility(code) != UsdGeom.Tokens.invisible
            }
        )
    assert len({frozenset(names) for names in shown}) == len(shown)


def test_the_binary_form_is_the_same_stage(stage, slot_folder, tmp_path):
    def packed():
        out = io.BytesIO()
        PackedUsd().write(Recording.open(slot_folder), out, Request(part=TimeRange(period_ns=100_000_000)))
        return out.getvalue()

    first = packed()
    assert first.startswith(b"PXR-USDC") and packed() == first
    (tmp_path / "slot.usdc").write_bytes(first)
    again = Usd.Stage.Open(str(tmp_path / "slot.usdc"))
    assert again.GetRootLayer().ExportToString() == stage.GetRootLayer().ExportToString()
