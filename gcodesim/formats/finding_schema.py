"""JSON Schema of a finding."""

from gcodesim.declarations.kind import Json
from gcodesim.diagnostics import PATTERN
from gcodesim.formats.json_schema import array, choice, nullable, number, record, text, whole


def finding() -> Json:
    """A finding in all of our JSON."""
    return record(
        "what is wrong, where, and what to do about it",
        code=text("stable code `GSnnn`, of other packages `NAME-nnn`; `gcodesim explain` says more")
        | {"pattern": f"^({PATTERN})$"},
        severity=choice("how bad it is in this cell", "error", "warning", "note"),
        message=text("one line, with both numbers"),
        hint=text("a way out; may be empty"),
        file=text("the file, by its name"),
        line=whole("from 1; 0: the file as a whole"),
        column=whole("from 1, in code points; 0: no column is known"),
        end_line=whole("the line of the end"),
        end_column=whole("the column behind the last"),
        callers=array(
            "the calls that led to a subprogram, outermost first",
            record("a call", file=text("where"), line=whole("where"), name=text("what was called")),
        ),
        count=whole("how often the same event occurred; the first is described", least=1),
        time_s=nullable(number("simulated time of the first event")),
        value=nullable(number("what it is, in `unit`")),
        limit=nullable(number("the greatest or least allowed value, in `unit`")),
        unit=nullable(text("unit of `value` and `limit`")),
    )
