"""Reports of a run for people."""

from gcodesim.report.summary import summary_rows

__all__ = ["summary_rows"]
