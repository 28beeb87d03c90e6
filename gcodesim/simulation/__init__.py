"""A program in a cell: read, planned, checked, run. Both the command line and the Python API call this."""

from gcodesim.jobs.job import Job, Options
from gcodesim.simulation.preparing import layout_findings, prepare, settings_in_cell, standing_findings
from gcodesim.simulation.running import RunInterrupted, check, run

__all__ = [
    "Job",
    "Options",
    "RunInterrupted",
    "check",
    "layout_findings",
    "prepare",
    "run",
    "settings_in_cell",
    "standing_findings",
]
