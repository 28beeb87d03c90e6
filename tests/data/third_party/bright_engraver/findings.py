"""What may be wrong with an engraving."""

from gcodesim.diagnostics import Code, Severity

CODES = (
    Code(
        code="ENGRAVER-101",
        severity=Severity.WARNING,
        title="The beam burns during a rapid move",
        what="A rapid move leads across the material while the beam is on, so that a line is burnt on the way.",
        why="The line is seen on the part, and its depth depends on how the machine speeds up.",
        remedy="Switch the beam off with M5 before the move, or set S0.",
    ),
)
