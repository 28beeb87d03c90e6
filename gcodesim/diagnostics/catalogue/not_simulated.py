"""Findings GS9xx: words that are read, but change nothing in the simulation."""

from gcodesim.diagnostics.catalogue.code import Code
from gcodesim.diagnostics.finding import Severity

CODES: tuple[Code, ...] = (
    Code(
        code="GS901",
        severity=Severity.NOTE,
        title="coolant not simulated",
        what="Coolant is read and shown in the listing, but has no effect on the simulated process.",
        why="What depends on it on the real machine is not in the results.",
        remedy=(
            "Map the code in the cell under `m_codes` if it matters, or make it an error with `checks: {GS9xx: error}`."
        ),
    ),
    Code(
        code="GS902",
        severity=Severity.NOTE,
        title="overrides not simulated",
        what="Override switches are read, but the simulation has no operator who would turn a knob.",
        why="What depends on it on the real machine is not in the results.",
        remedy=(
            "Map the code in the cell under `m_codes` if it matters, or make it an error with `checks: {GS9xx: error}`."
        ),
    ),
    Code(
        code="GS903",
        severity=Severity.NOTE,
        title="spindle orientation not simulated",
        what="The spindle's angle is read, but does not matter to a rotating tool.",
        why="What depends on it on the real machine is not in the results.",
        remedy=(
            "Map the code in the cell under `m_codes` if it matters, or make it an error with `checks: {GS9xx: error}`."
        ),
    ),
    Code(
        code="GS904",
        severity=Severity.NOTE,
        title="output without meaning not simulated",
        what="An output is set, and the cell does not say what it does.",
        why="What depends on it on the real machine is not in the results.",
        remedy=(
            "Map the code in the cell under `m_codes` if it matters, or make it an error with `checks: {GS9xx: error}`."
        ),
    ),
    Code(
        code="GS905",
        severity=Severity.NOTE,
        title="input not simulated",
        what="Inputs read 0: nothing in the simulation sets them.",
        why="What depends on it on the real machine is not in the results.",
        remedy=(
            "Map the code in the cell under `m_codes` if it matters, or make it an error with `checks: {GS9xx: error}`."
        ),
    ),
    Code(
        code="GS906",
        severity=Severity.NOTE,
        title="pallet shuttle not simulated",
        what="Pallets are not simulated.",
        why="What depends on it on the real machine is not in the results.",
        remedy=(
            "Map the code in the cell under `m_codes` if it matters, or make it an error with `checks: {GS9xx: error}`."
        ),
    ),
    Code(
        code="GS907",
        severity=Severity.NOTE,
        title="user M code not simulated",
        what="The control would run a program of its own for this code; the cell maps nothing to it.",
        why="What depends on it on the real machine is not in the results.",
        remedy=(
            "Map the code in the cell under `m_codes` if it matters, or make it an error with `checks: {GS9xx: error}`."
        ),
    ),
    Code(
        code="GS908",
        severity=Severity.NOTE,
        title="axes U, V, W not simulated",
        what="Moves of U, V and W are read, but no simulated machine has these axes.",
        why="What depends on it on the real machine is not in the results.",
        remedy=(
            "Map the code in the cell under `m_codes` if it matters, or make it an error with `checks: {GS9xx: error}`."
        ),
    ),
)
