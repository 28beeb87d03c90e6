"""What every process promises, whoever adds it."""

import numpy as np
import pytest

from gcodesim.declarations.keys import all_keys
from gcodesim.material.stock import Stock
from gcodesim.processes import PROCESSES
from gcodesim.processes.materials import LIBRARY
from gcodesim.processes.window import Window
from gcodesim.tools import TOOLS

VALUES = {"diameter": 10e-3, "bead_width": 4e-3, "bead_height": 2e-3, "corner_radius": 2e-3}


def tools():
    for kind in TOOLS:
        required = {p.name: VALUES[p.name] for p in all_keys(TOOLS[kind]).values() if p.required}
        yield pytest.param(TOOLS[kind](number=1, **required), id=kind)


def window(z, n=50):
    x = np.linspace(-10e-3, 30e-3, n + 1)
    points = np.column_stack([x, np.full(n + 1, 20e-3), np.full(n + 1, z)])
    return Window(
        piece_start=points[:-1],
        piece_end=points[1:],
        piece_step=np.arange(n),
        axis=np.tile([0.0, 0.0, 1.0], (n, 1)),
        velocity=np.diff(points, axis=0) / 0.02,
        spindle=np.full(n, 300.0),
        rapid=np.zeros(n, dtype=bool),
        active=np.ones(n, dtype=bool),
        dt=0.02,
    )


def room():
    """Material below z = 0, room above."""
    return Stock.box((0.0, 0.0, -20e-3), (60e-3, 40e-3, 0.0), 1e-3)


def process_of(tool):
    return PROCESSES[tool.process].of(tool, LIBRARY["42crmo4"])


@pytest.mark.parametrize("name", PROCESSES)
def test_is_named_as_in_the_table(name):
    assert PROCESSES[name].kind == name


@pytest.mark.parametrize("tool", list(tools()))
def test_volume_removed_is_what_the_stock_lost(tool):
    process, stock = process_of(tool), room()
    before = stock.volume
    z = -2e-3 if process.takes else 2e-3

    found = process.run(stock, window(z), process.begin())

    assert found.removed.any()
    assert found.removed.sum() == pytest.approx(before - stock.volume, rel=1e-6)
    assert found.engaged[found.removed != 0.0].all()


@pytest.mark.parametrize("tool", list(tools()))
def test_columns_are_finite_and_as_long_as_the_window(tool):
    process = process_of(tool)
    found = process.run(room(), window(-2e-3), process.begin())

    for name in found.__slots__:
        column = getattr(found, name)
        assert len(column) == 50, name
        assert np.isfinite(column.astype(float)).all(), name


@pytest.mark.parametrize("tool", list(tools()))
def test_without_stock_there_is_no_wrench(tool):
    process = process_of(tool)
    found = process.run(None, window(-2e-3), process.begin())

    assert not found.wrench.any()
    assert not found.removed.any()


@pytest.mark.parametrize("tool", list(tools()))
def test_the_same_input_gives_the_same_bits(tool):
    results = []
    for _ in range(2):
        process = process_of(tool)
        results.append(process.run(room(), window(-2e-3), process.begin()))

    for name in results[0].__slots__:
        assert np.array_equal(getattr(results[0], name), getattr(results[1], name)), name


@pytest.mark.parametrize("tool", list(tools()))
def test_inputs_are_not_changed(tool):
    process, given, kept = process_of(tool), window(-2e-3), window(-2e-3)
    process.run(room(), given, process.begin())

    for name in ("piece_start", "piece_end", "velocity", "spindle"):
        assert np.array_equal(getattr(given, name), getattr(kept, name))
