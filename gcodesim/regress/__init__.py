"""Whether a run still does what an earlier one did: comparison by quantity and tolerance, never of text."""

from gcodesim.regress.compare import TOLERANCES, Change, Tolerance, compare_results

__all__ = ["TOLERANCES", "Change", "Tolerance", "compare_results"]
