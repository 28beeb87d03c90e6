"""Checks: columns of a run in, findings out. They know neither the loop nor any file format."""

from collections.abc import Callable

from gcodesim.diagnostics import Span

# the place of row `row` of the path in the program
Spans = Callable[[int], Span]
