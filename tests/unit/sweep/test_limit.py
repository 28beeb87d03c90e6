"""Figures of runs, and limits of them."""

from __future__ import annotations

import pytest

from gcodesim.declarations.files import Shelf
from gcodesim.declarations.nodes import Scalar
from gcodesim.declarations.reading import Reading
from gcodesim.diagnostics import Findings, Span
from gcodesim.sweep.limit import LimitKind, StudyLimit
from gcodesim.sweep.measure import figure

FIGURES = {
    "tools.1.max_force_N": 90.0,
    "tools.2.max_force_N": 120.0,
    "setups.top.tools.1.max_force_N": 300.0,
    "stocks.a.removed_mm3": 5.0,
    "stocks.b.c.removed_mm3": 7.0,
    "joints.arm/a1.margin": 4.0,
    "joints.arm/a1.unit": "deg",
    "joints.machine/X.margin": 2.0,
    "joints.machine/X.unit": "mm",
    "time.total_s": 60.0,
}


def limit(text: str, tmp_path) -> StudyLimit:
    node = Scalar(span=Span("s", 1, 1, 1, 2), text=text)
    to = Reading(file="s", findings=Findings(), shelf=Shelf(folder=tmp_path))
    read = LimitKind().read(node, to, ("fail", 0))
    assert isinstance(read, StudyLimit)
    return read


def test_figures_join_tools_stocks_and_set_ups():
    assert figure("force", FIGURES) == 300.0
    assert figure("removed", FIGURES) == 12.0
    assert (figure("angle_margin", FIGURES), figure("margin", FIGURES)) == (4.0, 2.0)
    assert figure("tools.2.max_force_N", FIGURES) == 120.0
    assert figure("power", FIGURES) is figure("tools.9.x", FIGURES) is None


def test_what_is_left_is_left_by_the_last_set_up():
    names = (
        "setups.top.stocks.a.remaining_mm3",
        "setups.end.stocks.a.remaining_mm3",
        "setups.end.stocks.b.remaining_mm3",
    )
    figures = dict(zip(names, (9.0, 5.0, 2.0), strict=True))

    assert figure("remaining", figures) == 7.0


@pytest.mark.parametrize(
    ("text", "broken"),
    [
        ("force > 0.2 kN", True),
        ("force > 300 N", False),
        ("force >= 300 N", True),
        ("time < 2 min", True),
        ("time<=59 s", False),
        ("margin < 3", True),
        ("tools.2.max_force_N > 119.5", True),
        ("power > 1 W", False),
    ],
)
def test_limits_have_units_and_signs(text: str, broken: bool, tmp_path):
    assert limit(text, tmp_path).is_broken(FIGURES) is broken


def test_what_is_told_has_both_numbers(tmp_path):
    assert limit("force > 0.2 kN", tmp_path).broken_text(FIGURES) == "force is 300 N, above 200 N"
