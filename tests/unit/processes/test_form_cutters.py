"""Every named cutter, upright: the groove that it leaves is its silhouette, and undercuts stay open below a ledge."""

import math

import numpy as np
import pytest

from gcodesim.material.stock import Stock
from gcodesim.processes.laws import Kienzle
from gcodesim.processes.milling import Milling
from gcodesim.solids.turned import OutlineArc, steps_of
from gcodesim.tools import TOOLS
from tests.unit.processes.test_milling import line, window

STEEL = Kienzle.from_table(2500.0, 0.26)
ARC = OutlineArc(to=(2e-3, 2e-3), centre=(0.0, 2e-3), ccw=True)
KINDS = {
    "boring_bar": {"diameter": 8e-3, "flute_length": 2e-3},
    "chamfer_mill": {"diameter": 8e-3, "tip_diameter": 2e-3, "flute_length": 6e-3},
    "corner_rounding_mill": {"corner_radius": 2e-3, "tip_diameter": 4e-3, "flute_length": 6e-3},
    "countersink": {"diameter": 8e-3, "flute_length": 6e-3},
    "dovetail_mill": {"diameter": 9e-3, "flute_length": 3e-3},
    "engraver": {"diameter": 4e-3, "flute_length": 9e-3},
    "face_mill": {"diameter": 12e-3, "flute_length": 2e-3},
    "key_cutter": {"diameter": 9e-3, "flute_length": 2e-3},
    "lollipop_mill": {"diameter": 6e-3},
    "profile_mill": {"form_outline": ((0.0, 0.0), ARC, (3e-3, 5e-3), (1.5e-3, 6e-3))},
    "reamer": {"diameter": 8e-3, "flute_length": 6e-3},
    "saw": {"diameter": 9e-3, "flute_length": 1e-3, "neck_diameter": 3e-3},
    "step_drill": {"diameter": 8e-3, "tip_diameter": 4e-3, "step_length": 3e-3, "flute_length": 8e-3},
    "t_slot_mill": {"diameter": 9e-3, "flute_length": 3e-3},
    "tap": {"diameter": 8e-3, "pitch": 1.25e-3, "flute_length": 6e-3},
    "taper_ball_end_mill": {"diameter": 8e-3, "tip_diameter": 3e-3, "taper": math.radians(25.0), "flute_length": 8e-3},
    "thread_mill": {"diameter": 8e-3, "rows": 2, "pitch": 2e-3, "crest": 0.2e-3},
    "v_bit": {"diameter": 8e-3, "angle": math.radians(60.0), "flute_length": 9e-3},
}
WITHOUT_EDGES_ASIDE = {"tap"}


def cutter(kind):
    return TOOLS[kind](number=1, length=40e-3, **KINDS[kind])


def silhouette(tool, height):
    """Area [m²] of the half section below `height` on both sides, by fine slices."""
    total, slices = 0.0, 4000
    for start, piece in steps_of(tool.outline):
        if isinstance(piece, OutlineArc):
            begin, turn = piece.angles(start)
            angle = begin + turn * np.linspace(0.0, 1.0, slices)
            r = piece.centre[0] + piece.radius * np.cos(angle)
            h = piece.centre[1] + piece.radius * np.sin(angle)
        else:
            r, h = np.linspace(start[0], piece[0], slices), np.linspace(start[1], piece[1], slices)
        total += float(np.sum(0.5 * (r[1:] + r[:-1]) * np.diff(np.minimum(h, height))))
    return 2.0 * total


def groove(kind, depth, resolution=0.4e-3):
    """A pass all through a block 12 mm long, its tip `depth` below the top; what was removed, and the stock."""
    stock = Stock.box((0.0, 0.0, -12e-3), (12e-3, 16e-3, 0.0), resolution)
    process = Milling(cutter=cutter(kind), law=STEEL)
    path = line((-8e-3, 8.03e-3, -depth), (20e-3, 8.03e-3, -depth), 28)
    return process.run(stock, window(path), process.begin()), stock


@pytest.mark.parametrize("kind", KINDS)
def test_a_groove_has_the_silhouette_of_its_cutter(kind):
    tool = cutter(kind)
    depth = min(tool.flute_length, 7e-3)
    found, stock = groove(kind, depth)
    true = silhouette(tool, depth) * 12e-3

    assert found["removed"].sum() == pytest.approx(true, rel=0.015)
    assert 12e-3 * 16e-3 * 12e-3 - stock.volume == pytest.approx(true, rel=0.015)
    assert not found["inside"].any()


@pytest.mark.parametrize("kind", ["key_cutter", "dovetail_mill"])
def test_steps_of_a_quarter_of_a_cell_lose_no_volume(kind):
    """Columns along the tool are cut when it comes to their middles, those across as it goes: each step by itself."""
    stock = Stock.box((0.0, 0.0, -12e-3), (12e-3, 16e-3, 0.0), 0.4e-3)
    before, process = stock.volume, Milling(cutter=cutter(kind), law=STEEL)
    path, state = line((-5e-3, 8.03e-3, -6e-3), (2e-3, 8.03e-3, -6e-3), 70), process.begin()
    found = [process.run(stock, window(path[k : k + 2]), state)["removed"][0] for k in range(len(path) - 1)]

    assert sum(found) == pytest.approx(before - stock.volume, rel=1e-9)
    assert sum(1 for each in found if each > 0.0) >= 60


@pytest.mark.parametrize("kind", sorted(set(KINDS) - WITHOUT_EDGES_ASIDE))
def test_edges_feel_force(kind):
    tool = cutter(kind)
    found, _ = groove(kind, min(tool.flute_length, 7e-3))
    middle = slice(12, 16)

    assert (found["torque"][middle] > 0.0).all()
    assert (found["feed_force"][middle] < 0.0).all() or (found["peak_force"][middle] > 0.0).all()


def test_a_ledge_stays_above_an_undercut():
    """A T-slot cutter 5 mm below the top takes its disc and leaves what is above."""
    _, stock = groove("t_slot_mill", 8e-3)

    assert np.array(stock.intervals_at(6e-3, 8e-3)) == pytest.approx(np.array([(-12e-3, -8e-3), (-5e-3, 0.0)]))
    assert np.array(stock.intervals_at(6e-3, 15e-3)) == pytest.approx(np.array([(-12e-3, 0.0)]))


def test_an_outline_like_a_named_mill_is_that_mill():
    """The same shapes for the same kernels, so the same bits."""
    flat = TOOLS["flat_end_mill"](diameter=8e-3, length=40e-3)
    drawn = TOOLS["profile_mill"](form_outline=((0.0, 0.0), (4e-3, 0.0), (4e-3, 40e-3)), length=40e-3)
    assert drawn.form is None
    assert drawn.cutting_shape == flat.cutting_shape
    assert np.array_equal(drawn.edge, flat.edge)
    ball = TOOLS["ball_end_mill"](diameter=4e-3, length=40e-3)
    drawn = TOOLS["profile_mill"](form_outline=((0.0, 0.0), ARC, (2e-3, 40e-3)), length=40e-3)
    assert drawn.form is None
    assert drawn.cutting_shape == ball.cutting_shape
    assert drawn.edge == pytest.approx(ball.edge)


def test_a_disc_is_as_heavy_as_an_end_mill_of_its_height():
    """Bottom and top of a disc do not advance in a level cut: torque is that of a flat end mill in as deep a slot."""
    disc, _ = groove("t_slot_mill", 3e-3)
    stock = Stock.box((0.0, 0.0, -12e-3), (12e-3, 16e-3, 0.0), 0.4e-3)
    process = Milling(cutter=TOOLS["flat_end_mill"](number=1, diameter=9e-3, flutes=4, helix=0.0), law=STEEL)
    path = line((-8e-3, 8.03e-3, -3e-3), (20e-3, 8.03e-3, -3e-3), 28)
    flat = process.run(stock, window(path), process.begin())

    assert disc["torque"][12:16] == pytest.approx(flat["torque"][12:16], rel=0.01)
    assert disc["peak_force"][12:16] == pytest.approx(flat["peak_force"][12:16], rel=0.01)
