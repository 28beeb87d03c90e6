"""What every process promises, whoever adds it."""

from dataclasses import replace

import numpy as np
import pytest

from gcodesim.declarations.keys import all_keys
from gcodesim.material.stock import Stock
from gcodesim.processes import PROCESSES
from gcodesim.processes.materials import LIBRARY
from gcodesim.processes.window import Window
from gcodesim.tools import TOOLS

VALUES = {
    "diameter": 10e-3,
    "bead_width": 4e-3,
    "bead_height": 2e-3,
    "corner_radius": 2e-3,
    "tip_diameter": 1e-3,
    "flute_length": 4e-3,
    "step_length": 4e-3,
    "pitch": 1e-3,
    "efficiency": 0.65,
    "taper": 0.3,
    "angle": 1.5,
    "power": 500.0,
    "removal_rate": 8e-9,
    "wire_speed": 0.12,
    "form_outline": ((0.0, 0.0), (3e-3, 1e-3), (5e-3, 20e-3)),
}
BEAMS = {"beam": 1.0, "power": 400.0, "gas": 1.0, "feed": np.inf, "laser_mode": 0.0, "abrasive": 1.0}


def makers():
    """Each process of each tool, as (tool, kind)."""
    for name in TOOLS:
        if all(PROCESSES[kind].acts_on != "stock" for kind in TOOLS[name].processes):
            continue
        required = {p.field: VALUES[p.field] for p in all_keys(TOOLS[name]).values() if p.required}
        tool = TOOLS[name](number=1, **required)
        for kind in tool.processes:
            if PROCESSES[kind].acts_on == "stock":
                yield pytest.param((tool, kind), id=f"{name}-{kind}")


def window(z, n=50):
    x = np.linspace(-10e-3, 30e-3, n + 1)
    points = np.column_stack([x, np.full(n + 1, 20e-3), np.full(n + 1, z)])
    return Window(
        piece_start=points[:-1],
        piece_end=points[1:],
        piece_step=np.arange(n),
        axis=np.tile([0.0, 0.0, 1.0], (n, 1)),
        velocity=np.diff(points, axis=0) / 0.02,
        rapid=np.zeros(n, dtype=bool),
        signals={
            "spindle": np.full(n, 300.0),
            "active": np.ones(n, dtype=bool),
            "bead_width": np.zeros(n),
            "flow": np.full(n, np.nan),
            "wire_speed": np.full(n, np.nan),
            "bead_height": np.zeros(n),
            **{name: np.full(n, value) for name, value in BEAMS.items()},
        },
        dt=0.02,
    )


def room():
    """Material below z = 0, room above."""
    return Stock.box((0.0, 0.0, -20e-3), (60e-3, 40e-3, 0.0), 1e-3)


def process_of(maker):
    tool, kind = maker
    return PROCESSES[kind].of(tool, LIBRARY["42crmo4"])


@pytest.mark.parametrize("name", PROCESSES)
def test_is_named_as_in_the_table(name):
    assert PROCESSES[name].kind == name


@pytest.mark.parametrize("name", PROCESSES)
def test_columns_have_one_meaning_and_are_told(name):
    writes = PROCESSES[name].writes

    assert len({column.name for column in writes}) == len(writes)
    assert all(column.says and column.of in ("sum", "greatest", "any", "last") for column in writes)
    assert PROCESSES[name].acts_on in ("stock", "revolved", "surface", "bodies", "parts", "nothing")


@pytest.mark.parametrize("maker", list(makers()))
def test_volumes_are_what_the_stock_lost_and_gained(maker):
    process, stock = process_of(maker), room()
    before = stock.volume
    z = -2e-3 if process.takes else 2e-3

    found = process.run(stock, window(z), process.begin())

    change = found["removed"] - found["added"]
    assert change.any() or not {"removed", "added"} & {column.name for column in process.writes}
    assert change.sum() == pytest.approx(before - stock.volume, rel=1e-6)
    assert found["engaged"][change != 0.0].all()
    assert process.takes == found["removed"].any()


@pytest.mark.parametrize("maker", list(makers()))
def test_columns_are_declared_finite_and_as_long_as_the_window(maker):
    process = process_of(maker)
    found = process.run(room(), window(-2e-3), process.begin())

    assert found.wrench.shape == (50, 6) and found.deflection.shape == (50, 3)
    tool, kind = maker
    declared = {column.name: column for column in PROCESSES[kind].columns_of(tool)}
    assert set(found.columns) <= set(declared)
    for name, column in found.columns.items():
        assert column.shape == (50,), name
        assert (column.dtype == bool) == (declared[name].of == "any"), name
        assert np.isfinite(column.astype(float)).all(), name
    assert process.pushes or not found.wrench.any()


@pytest.mark.parametrize("maker", list(makers()))
def test_without_stock_there_is_no_wrench(maker):
    process = process_of(maker)
    found = process.run(None, window(-2e-3), process.begin())

    assert not found.wrench.any()
    assert not found["removed"].any() and not found["added"].any()


@pytest.mark.parametrize("maker", list(makers()))
def test_the_same_input_gives_the_same_bits(maker):
    results = []
    for _ in range(2):
        process = process_of(maker)
        results.append(process.run(room(), window(-2e-3), process.begin()))

    first, second = results
    assert np.array_equal(first.wrench, second.wrench) and np.array_equal(first.deflection, second.deflection)
    for name in first.columns:
        assert np.array_equal(first[name], second[name]), name


@pytest.mark.parametrize("maker", list(makers()))
def test_inputs_are_not_changed(maker):
    process, given, kept = process_of(maker), window(-2e-3), window(-2e-3)
    process.run(room(), given, process.begin())

    for name in ("piece_start", "piece_end", "velocity"):
        assert np.array_equal(getattr(given, name), getattr(kept, name))
    for name, values in kept.signals.items():
        assert np.array_equal(given.signals[name], values, equal_nan=values.dtype.kind == "f")


@pytest.mark.parametrize("maker", list(makers()))
def test_a_process_reads_no_signal_that_it_does_not_declare(maker):
    process = process_of(maker)
    full = window(-2e-3)
    less = replace(full, signals={signal.name: full.signals[signal.name] for signal in process.reads})

    assert np.array_equal(
        process.run(room(), full, process.begin()).wrench, process.run(room(), less, process.begin()).wrench
    )


@pytest.mark.parametrize("maker", list(makers()))
def test_what_is_outside_the_zone_is_left_alone(maker):
    process = process_of(maker)
    zone = process.zone
    if zone.everywhere:
        return
    stock = room()
    z = zone.below + 1e-3  # the tip, above material that ends at 0
    found = process.run(stock, window(z), process.begin())

    axis = np.array([[0.0, 0.0, 1.0]])
    low, high = np.array([0.0, 0.0, -20e-3]), np.array([60e-3, 40e-3, 0.0])
    assert not zone.meets(window(z).piece_start, window(z).piece_end, axis, low, high)
    assert not found.wrench.any()
    assert all(not column.any() for column in found.columns.values())
