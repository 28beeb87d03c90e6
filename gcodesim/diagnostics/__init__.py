"""Findings: what is wrong with a user's program or cell, where it is, and what to do about it."""

from gcodesim.diagnostics.catalogue import PATTERN, Code, code_of, codes, is_code, own_codes, subject_of
from gcodesim.diagnostics.finding import Caller, Diagnostic, Findings, Severity, Span
from gcodesim.diagnostics.text import SourceText

__all__ = [
    "PATTERN",
    "Caller",
    "Code",
    "Diagnostic",
    "Findings",
    "Severity",
    "SourceText",
    "Span",
    "code_of",
    "codes",
    "is_code",
    "own_codes",
    "subject_of",
]
