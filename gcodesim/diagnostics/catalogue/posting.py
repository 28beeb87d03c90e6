"""GS8xx: programs for other controls, and settings that come from them."""

from __future__ import annotations

from typing import Final

from gcodesim.diagnostics.catalogue.code import Code
from gcodesim.diagnostics.finding import Severity

CODES: Final = (
    Code(
        code="GS801",
        severity=Severity.ERROR,
        title="The target language cannot say this",
        what="A program was to be written for another control, and its language has no words for what happens here.",
        why="A program that leaves it out would do something else than what was checked. Nothing is written.",
        remedy="Choose another language, or change the program as the message says.",
    ),
    Code(
        code="GS802",
        severity=Severity.WARNING,
        title="Not posted: no output of the control is named",
        what=(
            "The program switches something, such as the spindle, coolant or an M-code of the cell, for which `post` "
            "knows no output of the robot's control. The robot program is written without it."
        ),
        why="The robot would move along the part with the spindle standing still.",
        remedy=(
            "Name the output: `--signal spindle=3`, `--signal M10=7 --signal M11=7:0`. Or switch it by hand, and raise "
            "or lower this finding under `checks` in the cell."
        ),
    ),
    Code(
        code="GS803",
        severity=Severity.WARNING,
        title="Faster than the control takes",
        what="A speed of the path is above the greatest that the language of the control takes; that one is posted.",
        why="The robot needs more time than the run says.",
        remedy="Limit rapids in the program, or the speeds of the joints in the cell.",
    ),
    Code(
        code="GS804",
        severity=Severity.NOTE,
        title="Said only approximately",
        what=(
            "The language of the control has a word for this, but with another meaning: Fanuc's CNT says how early the "
            "robot may turn, not how far it may cut a corner."
        ),
        why="Corners may be cut farther, or less far, than in the run.",
        remedy="Run the first corners at reduced speed, or use exact stops (G61.1) where it matters.",
    ),
    Code(
        code="GS805",
        severity=Severity.ERROR,
        title="A real joint was off the run",
        what="Joint states of an arm that followed a run were compared with it: a joint was farther off than allowed.",
        why="What was checked is not what the arm did: clearances and margins of the run do not hold.",
        remedy="Slow the program down, look at gains and limits of the controller, or allow more by `--tolerance`.",
    ),
)
