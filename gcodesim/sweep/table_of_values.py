"""Values of factors from a table (CSV): a column a factor, a line a run."""

from __future__ import annotations

import csv
import io
from dataclasses import replace

from gcodesim.declarations.nodes import Scalar
from gcodesim.declarations.reading import Reading, Unread, suggestion
from gcodesim.declarations.record import FREE
from gcodesim.diagnostics import Span
from gcodesim.diagnostics.plain import text_of_table
from gcodesim.sweep.factor import Factor, FactorKeys, factor_of, with_levels
from gcodesim.sweep.study_file import VARY, Study


def values_of_table(study: Study, to: Reading) -> Study | None:
    """The study with the columns of its table as values of its factors; None after a fault.

    A factor takes the column that it names, else the one of its own name. A column that no factor takes is a factor by
    itself, whose heading is the path of a key or a parameter; one whose heading begins with `x-` is left out.
    """
    assert study.table is not None
    source = to.shelf.sources[study.table.name]
    rows = [row for row in csv.reader(io.StringIO(source.text, newline="")) if any(cell.strip() for cell in row)]
    if len(rows) < 2:
        to.fault("GS705", to.span(("table",)), f"`{study.table.name}` has no line of values below its headings")
        return None
    heads = [text_of_table(cell).strip() for cell in rows[0]]
    faulty = False
    for number, row in enumerate(rows[1:], 2):
        if len(row) != len(heads):
            span = Span(source.name, number, 1, number, 2)
            to.fault("GS706", span, f"the line has {len(row)} values; there are {len(heads)} headings")
            faulty = True
    if len(set(heads)) != len(heads):
        twice = next(head for head in heads if heads.count(head) > 1)
        to.fault("GS702", Span(source.name, 1, 1, 1, 2), f"the column `{twice}` stands a second time")
        faulty = True
    if faulty:
        return None
    columns = {
        head: tuple(
            Scalar(span=Span(source.name, number, 1, number, 2), text=text_of_table(row[index]).strip())
            for number, row in enumerate(rows[1:], 2)
        )
        for index, head in enumerate(heads)
    }
    vary = dict(study.vary)
    for name, factor in study.vary.items():
        if factor.column is None:
            continue
        values = columns.pop(factor.column, None)
        if values is None:
            message = f"`{study.table.name}` has no column `{factor.column}`"
            to.fault("GS705", to.span((VARY, name)), message, suggestion(factor.column, heads))
            return None
        if not _put(vary, name, factor, values, to):
            return None
    for head, values in columns.items():
        if head.startswith(FREE):
            continue
        own = factor_of(head, FactorKeys(), to, (VARY, head))
        if isinstance(own, Unread) or not _put(vary, head, own, values, to):
            return None
    return replace(study, vary=vary)


def _put(vary: dict[str, Factor], name: str, factor: Factor, values: tuple[Scalar, ...], to: Reading) -> bool:
    """Give a factor its values in `vary`; false after a fault."""
    read = with_levels(factor, values, to, (VARY, name))
    if isinstance(read, Unread):
        return False
    vary[name] = replace(read, column=factor.column)
    return True
