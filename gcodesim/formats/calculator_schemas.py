"""JSON Schemas of what `gcodesim process` and `gcodesim optimise` print."""

from __future__ import annotations

from gcodesim.declarations.kind import Json, document
from gcodesim.formats.json_schema import array, choice, number, record, table, text, whole


def process() -> Json:
    """`gcodesim process --format json`."""
    value: Json = {
        "anyOf": [number("in the unit at the end of the name"), array("several", number("such as those of each tooth")),
                  {"type": ["boolean", "string"]}],
        "description": "in the unit at the end of its name",
    }  # fmt: skip
    root = record(
        "a model of the calculator",
        schema=choice("name of this form", "gcodesim-process/1"),
        model=text("its name"),
        inputs=table("each input by its name with its unit, defaults included", {}),
        results=table("each quantity by its name with its unit", value),
        source=text("where the formula comes from"),
        remarks=array("what was assumed, source of the material", text("a sentence")),
    )
    return document("gcodesim process --format json", root)


def optimise() -> Json:
    """`gcodesim optimise --format json`."""
    lines = array("lines of the program", whole("the line", least=1))
    root = record(
        "a program with other feeds",
        schema=choice("name of this form", "gcodesim-optimise/1"),
        loads=table(
            "each limit by its name",
            record("a load", limit=text("with its unit"), before=text("the greatest"), after=text("the greatest")),
        ),
        time_s=record("of the program", before=number("with its own feeds"), after=number("with the new ones")),
        changed_lines=lines,
        lines_above=array("lines that stay above a limit", whole("the line", least=1)),
        lines_out_of_reach=array(
            "of these, lines that no feed keeps below; theirs is as it was", whole("the line", least=1)
        ),
        lines_kept=array("lines whose feed cannot be written", whole("the line", least=1)),
    )
    return document("gcodesim optimise --format json", root)
