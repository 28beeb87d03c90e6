"""Whether a run still does what an earlier one did: comparison by quantity and tolerance, never of text."""

from gcodesim.regress.changes import Change, Comparison, FieldChange, FindingChange, MoveChange, Place, SurfaceChange
from gcodesim.regress.compare import compare_results
from gcodesim.regress.tolerance import DEFAULTS, QUANTITIES, Tolerance
from gcodesim.regress.verdicts import CaseVerdict, Found, SuiteVerdict

__all__ = [
    "DEFAULTS",
    "QUANTITIES",
    "CaseVerdict",
    "Change",
    "Comparison",
    "FieldChange",
    "FindingChange",
    "Found",
    "MoveChange",
    "Place",
    "SuiteVerdict",
    "SurfaceChange",
    "Tolerance",
    "compare_results",
]
