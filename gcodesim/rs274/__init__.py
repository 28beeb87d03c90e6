"""RS274 programs: text in, canonical events and findings out. Does not know cells or machines."""

from gcodesim.rs274.parameters import parameter_text, read_parameters
from gcodesim.rs274.program_source import as_text, is_binary, read_program
from gcodesim.rs274.run import Run, file_of, interpret, lint
from gcodesim.rs274.settings import MappedAction, Settings, canonical_m_code
from gcodesim.rs274.tool_table import ToolEntry, ToolTable

__all__ = [
    "MappedAction",
    "Run",
    "Settings",
    "ToolEntry",
    "ToolTable",
    "as_text",
    "canonical_m_code",
    "file_of",
    "interpret",
    "is_binary",
    "lint",
    "parameter_text",
    "read_parameters",
    "read_program",
]
