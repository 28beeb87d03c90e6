"""Findings GS7xx."""

from gcodesim.diagnostics.catalogue.code import Code

CODES: tuple[Code, ...] = ()
