"""What is declared, as tables for people: the keys of a class in Markdown, the units as text."""

from __future__ import annotations

import re
from typing import Any, Final

from gcodesim.declarations.keys import Key
from gcodesim.declarations.units import DIMENSIONS, table
from gcodesim.diagnostics.plain import one_line
from gcodesim.key_page import escaped

# a sign that means something in YAML, but not the minus of a number
_NEEDS_QUOTES: Final = re.compile(r"[\[\]{}#&*!|>'\"%@`]|-(?![0-9.])")
_QUOTED: Final = re.compile(r": | #|:$|^[\s:]|\s$|##")  # what may not stand in a text without quotes


def key_table(rows: list[Key]) -> list[str]:
    """A table of keys in Markdown: name, what is expected, what it means, and the default where that is a constant."""
    head = ["| key | expects | meaning |", "|---|---|---|"]
    return head + [
        f"| `{key.name}`{' (required)' if key.required else ''} | {escaped(key.kind.expected)} | {meaning} |"
        for key in rows
        for meaning in [escaped(_meaning(key))]
    ]


def _meaning(key: Key) -> str:
    default = key.default
    if key.required or key.rule or key.quiet or default in (None, "", ()):
        return key.doc
    shown = key.kind.show(default)
    return key.doc if isinstance(shown, dict) else f"{key.doc} (default: {inline_text(shown)})"


def inline_text(value: Any) -> str:
    """What a kind shows of a value, in one line of YAML."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(inline_text(entry) for entry in value)}]"
    if isinstance(value, dict):
        return "{" + ", ".join(f"{inline_text(name)}: {inline_text(entry)}" for name, entry in value.items()) + "}"
    text = str(value)
    if text and not _NEEDS_QUOTES.match(text) and not _QUOTED.search(text) and text.isprintable():
        return text
    # only what is escaped has a meaning within these quotes; JSON's escapes are those of YAML
    quoted = text.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{one_line(quoted)}"'


def units_as_text() -> str:
    """The table of units for people, one dimension a line."""
    width = max(len(name) for name in DIMENSIONS)
    lines = []
    for name, units in table().items():
        spelled = [f"{unit} ({', '.join(aliases)})" if aliases else unit for unit, aliases in units.items()]
        without = "  or a plain number" if DIMENSIONS[name].plain else ""
        lines.append(f"{name:<{width}}  {', '.join(spelled)}{without}")
    return "\n".join(lines)
