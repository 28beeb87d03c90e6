"""Set-ups of one part: each a program in a cell, one after the other, with the stock handed on."""

from gcodesim.setups.results import setups_as_json
from gcodesim.setups.running import How, SetupRun, run_setups
from gcodesim.setups.setup_file import JobFile, Setup, is_job_file, read_job_file

__all__ = ["How", "JobFile", "Setup", "SetupRun", "is_job_file", "read_job_file", "run_setups", "setups_as_json"]
