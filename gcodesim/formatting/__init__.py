"""Programs in one style: spacing, case, numbers and line numbers; what they do stays, and is proven to."""

from gcodesim.formatting.program import CannotFormatError, Formatted, formatted
from gcodesim.formatting.style import Style

__all__ = ["CannotFormatError", "Formatted", "Style", "formatted"]
