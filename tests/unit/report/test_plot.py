"""Charts as pictures, the same every time."""

import re

import pytest

from gcodesim.playback.quantities import charts_of
from gcodesim.report.plot import NoPlotError, draw


def test_svg_is_the_same_again_and_has_no_date(slot):
    charts = charts_of(slot, ["force", "feed"])
    picture = draw(slot, charts, "svg")

    assert picture == draw(slot, charts, "svg")
    assert b"<svg" in picture and not re.search(rb"20\d\d-\d\d-\d\d", picture)


def test_png_has_the_height_of_its_charts(slot):
    one, two = (draw(slot, charts_of(slot, what), "png") for what in (["force"], ["force", "joints"]))

    def height(data):
        assert data.startswith(b"\x89PNG")
        return int.from_bytes(data[20:24], "big")

    assert height(two) > height(one) + 100
    assert one == draw(slot, charts_of(slot, ["force"]), "png")


def test_another_time_is_another_picture(slot):
    charts = charts_of(slot, ["force"])

    assert draw(slot, charts, "png") != draw(slot, charts, "png", first_ns=5_000_000_000, last_ns=8_000_000_000)


def test_nothing_to_draw_is_said(slot):
    with pytest.raises(NoPlotError):
        draw(slot, [], "png")
