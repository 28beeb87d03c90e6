"""Legs of joint vectors: those that are made after the form of another are planned to the same bits."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from gcodesim.cell import load_cell
from gcodesim.cell.standing import standing_of
from gcodesim.diagnostics import Span
from gcodesim.motion.tool_path import ToolState
from gcodesim.planning import posing_of
from gcodesim.session.table_plan import LegForm, Stretched, plan_of
from gcodesim.shop import open_shop

CELLS = Path(__file__).parents[3] / "cells"


def arrays(value, name="plan"):
    """All arrays below a value of frozen classes, by their names."""
    if isinstance(value, np.ndarray):
        yield name, value
    elif dataclasses.is_dataclass(value):
        for field in dataclasses.fields(value):
            yield from arrays(getattr(value, field.name), f"{name}.{field.name}")


@pytest.mark.parametrize("cell", ["force_control.yaml", "agv.yaml", "bracket.yaml"])
def test_a_leg_after_the_form_of_another_is_the_same_to_the_bit(cell):
    shop = open_shop(load_cell(CELLS / cell).cell)
    posing, standing = posing_of(shop), standing_of(shop.cell, shop.channel)
    rng, home = np.random.default_rng(5), shop.home
    drawn = []
    for line in range(1, 9):
        steps = int(rng.integers(1, 12))
        ways = rng.uniform(-1e-3, 1e-3, (steps, len(home))) * (line != 4)  # once it stands
        q = home + np.cumsum(np.vstack([np.zeros(len(home)), ways]), axis=0)
        state = ToolState(tool=min(shop.cell.tools, default=0) if line % 2 else 0)
        drawn.append(Stretched(q=q, state=state, span=Span("script.py", line), active=line % 3 == 0))
    first = plan_of([drawn[0]], shop, posing, 0.004, standing)
    form = LegForm.of([drawn[0]], first)

    for stretch in drawn[1:]:
        anew = plan_of([stretch], shop, posing, 0.004, standing)
        after = plan_of([stretch], shop, posing, 0.004, standing, form)
        expected = dict(arrays(anew.trajectory))
        found = dict(arrays(after.trajectory))
        assert found.keys() == expected.keys()
        for name, values in expected.items():
            assert found[name].dtype == values.dtype and np.array_equal(found[name], values, equal_nan=True), name
        assert (after.path.states, after.path.spans) == (anew.path.states, anew.path.spans)
        times = np.linspace(0.0, anew.trajectory.duration, 7)
        assert np.array_equal(after.joints(after.trajectory.sample(times)), anew.joints(anew.trajectory.sample(times)))


def test_legs_of_several_stretches_have_no_form():
    shop = open_shop(load_cell(CELLS / "force_control.yaml").cell)
    q = np.vstack([shop.home, shop.home])
    one = Stretched(q=q, state=ToolState(), span=Span("a.py", 1), active=False)
    other = Stretched(q=q, state=ToolState(), span=Span("a.py", 2), active=False)
    plan = plan_of([one, other], shop, posing_of(shop), 0.004, standing_of(shop.cell, shop.channel))

    assert LegForm.of([one, other], plan) is None
