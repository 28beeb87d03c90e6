"""Findings GS4xx."""

from gcodesim.diagnostics.catalogue.code import Code

CODES: tuple[Code, ...] = ()
