"""Where joints are computed: dense enough in geometry and in joints."""

from __future__ import annotations

import numpy as np
import pytest

from gcodesim.canon import LinearFeed, PathMode, Rapid
from gcodesim.diagnostics import Span
from gcodesim.motion import build_tool_path
from gcodesim.motion.blend import blend
from gcodesim.motion.pieces import AxisLimits, Pieces
from gcodesim.planning.nodes import SPACING, Nodes

AT = Span("t", 1, 1, 1, 2)


def pieces() -> Pieces:
    """A joint move, then 30 mm and 5 mm with a corner arc between."""
    events = [
        PathMode(span=AT, mode="blend", tolerance=1e-4), Rapid(span=AT, end=(0.1, 0, 0, 0, 0, 0)),
        LinearFeed(span=AT, end=(0.13, 0, 0, 0, 0, 0), feed=0.1),
        LinearFeed(span=AT, end=(0.13, 0.005, 0, 0, 0, 0), feed=0.1),
    ]  # fmt: skip
    limits = AxisLimits(speed=np.full(6, 1.0), acceleration=np.full(6, 3.0))
    return blend(build_tool_path(events), limits, own_time=np.array([1.0, np.nan, np.nan]))


def test_nodes_stand_at_ends_and_not_too_far_apart() -> None:
    p = pieces()

    nodes = Nodes.of(p, np.zeros(len(p), dtype=bool))

    assert nodes.head.tolist()[0] and nodes.head.sum() == 1
    assert nodes.chains == [(0, len(nodes))]
    lengths = nodes.s[nodes.segments] - nodes.begin
    assert lengths.max() <= SPACING + 1e-12 and lengths.min() > 0
    for piece in range(1, len(p)):
        assert lengths[nodes.piece[nodes.segments] == piece].sum() == pytest.approx(p.length[piece])


def test_no_node_at_home() -> None:
    p = pieces()

    assert not Nodes.of(p, np.arange(len(p)) == 0).head.any()


def test_refining_halves_what_moves_far() -> None:
    p = pieces()
    nodes = Nodes.of(p, np.zeros(len(p), dtype=bool))
    q = np.zeros((len(nodes), 2))
    q[3:, 1] = 0.25  # a leap from node 2 to node 3

    finer = nodes.refined(q)

    assert finer is not None
    assert len(finer) == len(nodes) + 2
    assert np.all(np.isin(nodes.s, finer.s))
    assert nodes.refined(np.zeros((len(nodes), 2))) is None


def test_the_node_that_ends_the_segment_of_a_place() -> None:
    p = pieces()
    nodes = Nodes.of(p, np.zeros(len(p), dtype=bool))

    s = np.array([0.0, float(nodes.s[1]), float(nodes.s[1]) + 1e-6, 0.0])
    found = nodes.at_or_after(nodes.keys(p.length), np.array([1, 1, 1, 2]), s, p.length)

    assert found[:3].tolist() == [0, 1, 2]
    assert nodes.piece[found[3]] == 1 and nodes.s[found[3]] == pytest.approx(p.length[1])
