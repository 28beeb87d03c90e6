"""GS176 and GS177: the spindle off in a cut, and on after the end."""

from __future__ import annotations

from itertools import pairwise
from math import pi

import numpy as np
import pytest

from gcodesim.canon.batch import MoveBatch
from gcodesim.canon.events import ArcFeed, LinearFeed, PathMode, Rapid, Spindle
from gcodesim.diagnostics import Span
from gcodesim.rs274.watch.spindle import FeedWithoutSpindle

CUT = "G0 X0 Y0 Z5\nG1 Z-2 F200\nG1 X30\nG0 Z20\n"


def test_a_forgotten_start_after_a_tool_change(warned) -> None:
    assert warned("T1 M6\nS8000 M3\n" + CUT + "T2 M6\n" + CUT) == [("GS176", 9, 1)]


def test_the_first_tool_too(warned) -> None:
    assert warned("T1 M6\n" + CUT + "T2 M6\nS8000 M3\n" + CUT) == [("GS176", 3, 1)]


def test_a_stop_of_the_spindle_in_the_cut(warned) -> None:
    assert warned("S8000 M3\n" + CUT + "M5\nG0 Z5\nG1 Z-1\nX10") == [("GS176", 8, 1)]


def test_one_finding_for_each_time_off(warned) -> None:
    assert warned("S8000 M3\n" + CUT + "M5\n" + CUT + CUT + "M3\n" + CUT + "M5\n" + CUT) == [
        ("GS176", 8, 1),
        ("GS176", 22, 1),
    ]


def test_holes(warned) -> None:
    holes = "G0 X0 Y0 Z20\nG81 X5 Y5 Z-5 R2 F100\nX10\nG80\n"

    assert warned("S1000 M3\n" + holes + "M5\n" + holes) == [("GS176", 8, 1)]


def test_a_spindle_of_no_speed_is_off(warned) -> None:
    assert warned("S8000 M3\n" + CUT + "S0\n" + CUT) == [("GS176", 8, 1)]


@pytest.mark.parametrize(
    "text",
    [
        CUT,  # a plotter: no spindle anywhere
        "M7\n" + CUT + "M9",  # a jet
        "S8000 M3\n" + CUT,
        # the spindle starts after an approach at feed
        "S8000 M3\n" + CUT + "M5\nG0 X0 Y0 Z50\nG1 Z5 F2000\nM3\nG1 Z-2",
        # travel at feed above the work
        "S8000 M3\n" + CUT + "M5\nG1 X50 Y50 F5000\nG0 Z5\nG1 X10",
        # a laser switched by M3 and M5 at one height, which travels at feed
        "G0 X0 Y0\nM3 S500\nG1 X10 F1000\nM5\nG1 Y10\nM3\nG1 X0\nM5",
        # a probe comes down without
        "T1 M6\nS8000 M3\n" + CUT + "T2 M6\nG0 Z5\nG38.2 Z-10 F50\nG0 Z20",
        # retracting at feed
        "S8000 M3\nG0 X0 Y0 Z5\nG1 Z-2 F200\nG1 X30\nM5\nG1 Z5",
        # part zero is below: a slanted approach ends above all cuts
        "G10 L2 P1 Z-20\nS8000 M3\nG0 X0 Y0 Z30\nG1 Z8 F200\nG1 X9\nM5\nG0 Z30\nG1 X0 Z12\nM3\nG1 Z7",
    ],
)
def test_no_alarm(warned, text: str) -> None:
    assert warned(text) == []


def test_levels_are_those_of_the_part(warned) -> None:
    """The machine heights are compared, so another work system does not matter; the message counts from part zero."""
    assert warned("G10 L2 P2 Z-50\nS8000 M3\n" + CUT + "M5\nG55\nG0 Z55\nG1 Z48\nG1 X9 Y9") == [("GS176", 10, 1)]


def test_the_closing_percent_stops_nothing(warned) -> None:
    assert warned("%\nS8000 M3\n" + CUT, end="%\n") == [("GS177", 7, 1)]
    assert warned("%\nS8000 M3\n" + CUT + "M5\n", end="%\n") == []
    assert warned("%\nS8000 M3\n" + CUT + "M2\n", end="%\n") == []


def _random_moves(seed: int) -> list[tuple[int, tuple[float, ...]]]:
    rng = np.random.default_rng(seed)
    out, at = [], [0.0, 0.0, 0.01]
    for _ in range(30):
        kind = int(rng.choice([0, 1, 1, 1, 2]))
        for axis in range(3):
            if rng.random() < 0.5:
                at[axis] = float(rng.integers(-3, 4)) * 1e-3
        out.append((kind, (*at, 0.0, 0.0, 0.0)))
    return out


def _batch(moves: list[tuple[int, tuple[float, ...]]]) -> MoveBatch:
    n, arcs = len(moves), sum(kind > 1 for kind, _ in moves)
    return MoveBatch(
        origins=(("p.ngc", ()),),
        kind=np.array([kind for kind, _ in moves], dtype=np.int32),
        word=np.array([kind for kind, _ in moves], dtype=np.int32),
        end=np.array([end for _, end in moves]),
        feed=np.ones(n),
        rotary=np.zeros(n, dtype=bool),
        per_revolution=False,
        place=np.array([(k + 1, 1, 9) for k in range(n)], dtype=np.int32),
        origin=np.zeros(n, dtype=np.int32),
        block=np.arange(n, dtype=np.int32),
        shapes=np.tile([0.0, 0.0, 0.0, 0.0, 0.0, 1.0, -pi, 1.0], (arcs, 1)),
        acts=np.zeros((0, 2), dtype=np.int32),
        path=PathMode(span=Span("p.ngc"), mode="exact_path"),
        dwell=0.0,
    )


@pytest.mark.parametrize("seed", range(25))
def test_columns_and_events_tell_the_same(seed: int) -> None:
    """Moves seen one by one and in batches, cut anywhere: the same findings."""
    moves = _random_moves(seed)
    off = _random_moves(seed + 1000)
    rng = np.random.default_rng(seed)

    def told(in_batches: bool) -> list[object]:
        rule = FeedWithoutSpindle()
        rule.event(Rapid(span=Span("p.ngc"), end=(0.0, 0.0, 0.02, 0.0, 0.0, 0.0)))
        for turning, run in ((True, moves), (False, off), (True, moves[::-1])):
            rule.event(
                Spindle(span=Span("p.ngc"), direction="cw" if turning else "off", speed=100.0 if turning else 0.0)
            )
            cuts = sorted({0, len(run), *rng.integers(0, len(run), 3).tolist()})
            for a, b in pairwise(cuts):
                batch = _batch(run[a:b])
                if in_batches:
                    rule.moves(batch)
                else:
                    for event in batch.events():
                        assert isinstance(event, Rapid | LinearFeed | ArcFeed)
                        rule.event(event)
        return [(f.code, f.span.line, f.value, f.limit) for f in rule.findings(finished=True)]

    one = told(False)
    rng = np.random.default_rng(seed)
    assert told(True) == one
