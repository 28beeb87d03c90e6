"""All commands and options as Markdown, from the parser: `python -m gcodesim.cli.reference docs/commands.md`."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

from gcodesim.cli.outline import Command, Option, Value, outline
from gcodesim.cli.parser import build_parser
from gcodesim.key_page import escaped, rewrite


def reference() -> str:
    """A section for each command: how it is called, what it does, a table of its options."""
    return "\n".join(line for command in outline(build_parser()).leaves() for line in _section(command)).rstrip()


def _section(command: Command) -> Iterator[str]:
    yield f"### `{command.name}`"
    yield ""
    yield f"    gcodesim {command.name} {' '.join(_usage(command))}".rstrip()
    yield ""
    yield _sentence(command.description)
    yield ""
    options = [option for option in command.options if "--help" not in option.names]
    rows = [*(_place(place) for place in command.places), *(_option(option) for option in options)]
    if not rows:
        return
    yield "| | meaning |"
    yield "|---|---|"
    yield from rows
    yield ""


def _usage(command: Command) -> Iterator[str]:
    """What has to be there; the rest is `…`."""
    for place in command.places:
        yield {"?": f"[{place.name}]", "*": f"[{place.name}…]", "+": f"{place.name}…"}.get(place.counts, place.name)
    for option in command.options:
        if option.required and option.value is not None:
            yield f"{option.names[-1]} {option.value.name}"
    yield "[OPTIONS]"


def _place(place: Value) -> str:
    return f"| `{place.name}` | {escaped(place.says)} |"


def _option(option: Option) -> str:
    value = "" if option.value is None else _value(option.value)
    names = ", ".join(f"`{name}{value}`" for name in option.names)
    return f"| {escaped(names)} | {escaped(option.says)} |"


def _value(value: Value) -> str:
    name = value.name.replace("|", "/")  # a bar would end the column of the table
    if value.words and not value.files and name == "/".join(value.words):
        name = f"{{{','.join(value.words)}}}"
    return f" [{name}]" if value.counts == "?" else f" {name}"


def _sentence(text: str) -> str:
    text = text[:1].upper() + text[1:]
    return text if text.endswith((".", "…")) else f"{text}."


if __name__ == "__main__":
    rewrite(Path(sys.argv[1]), reference())
