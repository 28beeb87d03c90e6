"""What people read of a run."""

from gcodesim.report.summary import summary_rows

__all__ = ["summary_rows"]
