"""Findings: what is wrong with a user's program or cell, where, and what to do about it."""

from gcodesim.diagnostics.catalogue import Code, code_of, codes, subject_of
from gcodesim.diagnostics.finding import Caller, Diagnostic, Findings, Severity, Span
from gcodesim.diagnostics.text import SourceText

__all__ = [
    "Caller",
    "Code",
    "Diagnostic",
    "Findings",
    "Severity",
    "SourceText",
    "Span",
    "code_of",
    "codes",
    "subject_of",
]
