"""Findings GS9xx."""

from gcodesim.diagnostics.catalogue.code import Code

CODES: tuple[Code, ...] = ()
