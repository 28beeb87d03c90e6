"""RS274 programs: text in, canonical events and findings out. Does not know cells or machines."""

from gcodesim.rs274.parameters import parameter_text, read_parameters
from gcodesim.rs274.run import Run, file_of, interpret, lint
from gcodesim.rs274.settings import MappedAction, Settings, canonical_m_code
from gcodesim.rs274.tool_table import ToolEntry, ToolTable

__all__ = [
    "MappedAction",
    "Run",
    "Settings",
    "ToolEntry",
    "ToolTable",
    "canonical_m_code",
    "file_of",
    "interpret",
    "lint",
    "parameter_text",
    "read_parameters",
]
