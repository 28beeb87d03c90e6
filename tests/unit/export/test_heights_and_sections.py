"""Heights of the part and sections through it, from a run with a slot."""

from __future__ import annotations

import json
import struct
import zlib
from io import BytesIO, StringIO

import numpy as np
import pytest

from gcodesim.export.exporter import NoExportError, Request
from gcodesim.export.heights import HeightNumbers, HeightPicture, heights_of
from gcodesim.export.part import part_surface
from gcodesim.export.section import SectionDrawing, area_of, loops_at
from gcodesim.playback import Recording

MM = 1e-3


def test_heights_are_those_of_the_columns(slot, slot_folder):
    out = BytesIO()
    said = HeightNumbers().write(slot, out, Request())
    with np.load(BytesIO(out.getvalue())) as found:
        x, y, z = found["x_mm"], found["y_mm"], found["z_mm"]

    assert said == f"{len(x)} x {len(y)} heights" and z.shape == (len(x), len(y))
    stock = json.loads((slot_folder / "results.json").read_text())["stocks"]["stock"]
    cell = (x[1] - x[0]) * (y[1] - y[0])
    gone = float((z.max() - z).sum() * cell)
    assert gone == pytest.approx(stock["removed_mm3"], rel=0.1)  # walls between columns are not heights
    again = BytesIO()
    HeightNumbers().write(slot, again, Request())
    assert again.getvalue() == out.getvalue()


def test_the_picture_has_the_same_heights(slot):
    out = BytesIO()
    HeightPicture().write(slot, out, Request())
    raw = out.getvalue()
    relief = heights_of(slot, None)
    width, height, depth, colour = struct.unpack(">IIBB", raw[16:26])
    assert (width, height, depth, colour) == (*relief.tops.shape, 16, 0)
    begin = raw.index(b"IDAT") + 4
    (size,) = struct.unpack(">I", raw[begin - 8 : begin - 4])
    rows = zlib.decompress(raw[begin : begin + size])
    grey = np.frombuffer(rows, np.uint8).reshape(height, 1 + 2 * width)[:, 1:].copy().view(">u2")
    low, high = np.nanmin(relief.tops), np.nanmax(relief.tops)
    back = low + (grey[::-1].T.astype(float) - 1) / 65534 * (high - low)
    assert np.allclose(back, relief.tops, atol=(high - low) / 65534)


def test_a_section_has_the_area_of_the_part_there(slot):
    surface, _ = part_surface(slot)
    low, high = surface.vertices.min(axis=0), surface.vertices.max(axis=0)
    places = np.linspace(low[2], high[2], 4001)[:-1] + 0.5 * (high[2] - low[2]) / 4000
    slices = [sum(area_of(loop) for loop in loops_at(surface, 2, float(z))) for z in places[::40]]

    assert np.mean(slices) * (high[2] - low[2]) == pytest.approx(surface.volume, rel=0.01)
    bottom = sum(area_of(loop) for loop in loops_at(surface, 2, float(low[2] + 1e-4)))
    assert bottom == pytest.approx(float(np.prod((high - low)[:2])), rel=1e-6)


@pytest.mark.parametrize("axis", "xyz")
def test_the_svg_is_a_picture_of_it(slot, axis):
    surface, _ = part_surface(slot)
    middle = float(surface.vertices.mean(axis=0)["xyz".index(axis)])
    out = StringIO()
    said = SectionDrawing().write(slot, out, Request(section=(axis, middle)))

    assert said.startswith("a section of ") and "outline" in said
    assert out.getvalue().startswith("<svg ") and out.getvalue().split(' d="')[1].count("M") == int(
        said.split(" in ")[1].split()[0]
    )


def test_where_there_is_no_section(slot):
    with pytest.raises(NoExportError, match="nowhere at Z100; it reaches from"):
        SectionDrawing().write(slot, StringIO(), Request(section=("z", 0.1)))


def test_a_section_that_nobody_placed_is_halfway_up(slot):
    placed, free = StringIO(), StringIO()
    SectionDrawing().write(slot, free, Request())
    low, high = (part_surface(slot)[0].vertices[:, 2].min(), part_surface(slot)[0].vertices[:, 2].max())
    SectionDrawing().write(slot, placed, Request(section=("z", float(0.5 * (low + high)))))
    assert free.getvalue() == placed.getvalue()


def test_without_the_stock_file_there_are_no_heights(slot_folder):
    with pytest.raises(NoExportError, match="beside its log"):
        heights_of(Recording.open(slot_folder / "run.mcap"), None)
