"""Whether a run still does what an earlier one did: comparison by quantity and tolerance, never as text."""

from gcodesim.regress.changes import (
    Change,
    ChangedLine,
    Comparison,
    FieldChange,
    FindingChange,
    MoveChange,
    SurfaceChange,
)
from gcodesim.regress.compare import compare_results
from gcodesim.regress.tolerance import DEFAULTS, QUANTITIES, Tolerance
from gcodesim.regress.verdicts import CaseVerdict, JudgedFinding, SuiteVerdict

__all__ = [
    "DEFAULTS",
    "QUANTITIES",
    "CaseVerdict",
    "Change",
    "ChangedLine",
    "Comparison",
    "FieldChange",
    "FindingChange",
    "JudgedFinding",
    "MoveChange",
    "SuiteVerdict",
    "SurfaceChange",
    "Tolerance",
    "compare_results",
]
