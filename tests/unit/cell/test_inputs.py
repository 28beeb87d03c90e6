"""Inputs of the cell: how they are written, and what M66 reads of them."""

from __future__ import annotations

from pathlib import Path

import pytest

from gcodesim.cell.inputs import InputSource, Wait
from gcodesim.cell.loader import read_cell
from gcodesim.cell.show import cell_as_text
from gcodesim.diagnostics import SourceText
from gcodesim.simulation import check, prepare, run

CELL = "gcodesim: 1\nmachine: gantry_xyz\nsimulation: {world: kinematic}\n"
PULSE = InputSource(times=(1.0, 3.0), values=(0.0, 1.0, 0.0))


def loaded(inputs: str):  # type: ignore[no-untyped-def]
    return read_cell(SourceText("cell.yaml", (CELL + f"inputs: {inputs}\n").encode()), Path("cell.yaml"))


@pytest.mark.parametrize(
    ("wait", "begin", "timeout", "answer"),
    [
        ("immediate", 0.5, 0.0, (0.0, 0.0)),
        ("immediate", 1.0, 0.0, (1.0, 0.0)),
        ("rise", 0.5, 2.0, (1.0, 0.5)),
        ("rise", 1.5, 2.0, (None, 2.0)),
        ("fall", 0.5, 5.0, (0.0, 2.5)),
        ("fall", 0.5, 2.0, (None, 2.0)),
        ("high", 2.0, 1.0, (1.0, 0.0)),
        ("high", 0.0, 1.0, (1.0, 1.0)),
        ("low", 0.0, 1.0, (0.0, 0.0)),
        ("low", 2.0, 3.0, (0.0, 1.0)),
    ],
)
def test_what_is_read_and_how_long_it_takes(
    wait: Wait, begin: float, timeout: float, answer: tuple[float | None, float]
) -> None:
    assert PULSE.read(wait, begin, timeout, {}) == answer


def test_a_wired_input_has_the_output_of_the_moment() -> None:
    wired = InputSource(output="P1")
    assert wired.read("immediate", 0.0, 0.0, {"P1": 1.0}) == (1.0, 0.0)
    assert wired.read("high", 0.0, 2.0, {}) == (None, 2.0)


def test_the_three_forms_are_read_and_shown() -> None:
    text = "{p0: 1, E01: 2.5, P2: [[1 s, 1], [3 s, 0]], P3: {output: p1}}"
    cell = loaded(text).cell
    assert cell is not None
    inputs = cell.channels["main"].inputs
    assert inputs["P0"].values == (1.0,) and inputs["E1"].values == (2.5,)
    assert inputs["P2"] == PULSE and inputs["P3"].output == "P1"
    again = read_cell(SourceText("cell.yaml", cell_as_text(cell).encode()), Path("cell.yaml"))
    assert again.cell is not None and again.cell.channels["main"].inputs == inputs


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("{X1: 1}", "GS711"),
        ("{P1: yes}", "GS707"),
        ("{P1: [1, 2]}", "GS706"),
        ("{P1: [[2 s, 1], [1 s, 0]]}", "GS711"),
        ("{P1: {sensor: a}}", "GS712"),
        ("{P1: {output: Q3}}", "GS711"),
    ],
)
def test_what_is_no_input(text: str, code: str) -> None:
    found = loaded(text)
    assert found.cell is None and code in {f.code for f in found.findings}


PROGRAM = """G21 G90
G0 X10
M66 P2 L3 Q5
#31=#5399
G0 X20
M66 P2 L2 Q0.5
#32=#5399
M62 P1
M64 P4
M66 P3 L0
#33=#5399
M66 P5 L0
#34=#5399
G0 X30
M66 P3 L0
#35=#5399
M66 E1 L0
#36=#5399
M66 P9 L0
G4 P0.25
M2
"""


def test_a_program_reads_its_inputs_and_waits_for_them() -> None:
    cell = loaded("{P2: [[2 s, 1]], P3: {output: P1}, P5: {output: P4}, E1: 2.5}")
    job = prepare(SourceText("program.nc", PROGRAM.encode()), cell)
    results, execution = run(job)
    assert job.reading is not None and execution is not None
    got = [job.reading.parameters.get(number, 0.0) for number in range(31, 37)]
    assert got == [1.0, -1.0, 0.0, 1.0, 1.0, 2.5], "M62 waits for the next move, M64 does not"
    moves = results.times.rapid
    assert results.times.total == pytest.approx(2.0 + 0.5 + 0.25 + moves - first_move(job), abs=0.02)
    assert [(f.code, f.span.line) for f in results.findings if f.code == "GS905"] == [("GS905", 19)]
    assert {"word": "M66 P9", "count": 1, "first_line": 19} in results.not_simulated
    assert results.status == "ok"


def first_move(job) -> float:  # type: ignore[no-untyped-def]
    """Seconds of the first move, which go by before the wait begins."""
    return float(job.plan.trajectory.row_time[0])


def test_a_check_waits_as_long() -> None:
    cell = loaded("{P2: [[2 s, 1]]}")
    program = SourceText("program.nc", b"G21 G90\nG0 X10\nM66 P2 L3 Q5\nG0 X0\nM2\n")
    ran, _ = run(prepare(program, cell))
    assert check(prepare(program, cell)).times.total == pytest.approx(ran.times.total, abs=1e-9)
    assert ran.times.dwell > 1.0
