"""All keys of our JSON as Markdown, from the schemas; `docs/output-formats.md` carries it.

`python -m gcodesim.formats.reference docs/output-formats.md` rewrites the part of that page between its two markers.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

from gcodesim.formats.schemas import schema_of
from gcodesim.key_page import escaped, rewrite

_SECTIONS: Final = (
    ("results", "`results.json`, `run` and `check`"),
    ("setups", "`setups.json`, `run` and `check` of a job"),
    ("findings", "A finding, in `lint`, `cell validate` and everywhere"),
    ("test", "`test`"),
    ("mutants", "`test --mutate`"),
    ("baseline", "Baseline files"),
    ("info", "`info`"),
)
_ELSEWHERE: Final = ("finding", "results", "comparison")
"""Definitions that have a section of their own, or that `gcodesim schema diff` shows."""


def reference() -> str:
    """A table for each form: key, type, meaning."""
    parts: list[str] = []
    for name, title in _SECTIONS:
        schema = schema_of(name)
        root = schema["$defs"]["finding"] if name == "findings" else schema
        parts += [f"### {title}", "", "| key | type | meaning |", "|---|---|---|", *_rows(root, schema, ""), ""]
    return "\n".join(parts).rstrip()


def _rows(schema: dict[str, Any], whole: dict[str, Any], prefix: str) -> Iterator[str]:
    for name, member in schema["properties"].items():
        shown = _resolved(member, whole)
        yield f"| `{prefix}{name}` | {_kind(member, shown)} | {escaped(member.get('description') or '')} |"
        inner, suffix = shown, ""
        if "items" in shown:
            inner, suffix = _resolved(shown["items"], whole), "[]"
        elif isinstance(shown.get("additionalProperties"), dict):
            inner, suffix = _resolved(shown["additionalProperties"], whole), ".NAME"
        if "properties" in inner:
            finding = whole.get("$defs", {}).get("finding", {}).get("properties", {})
            is_one = bool(finding) and finding.keys() <= inner["properties"].keys()
            own = {key: one for key, one in inner["properties"].items() if not is_one or key not in finding}
            yield from _rows({"properties": own}, whole, f"{prefix}{name}{suffix}.")
            more = inner.get("additionalProperties")
            if isinstance(more, dict):
                yield f"| `{prefix}{name}{suffix}.NAME` | {_kind(more, more)} | {escaped(more['description'])} |"
            if is_one:
                yield f"| `{prefix}{name}{suffix}.…` | | the keys of a finding |"


def _resolved(schema: dict[str, Any], whole: dict[str, Any]) -> dict[str, Any]:
    """The target of a reference, unless it has its own section."""
    for one in (schema, *schema.get("anyOf", ())):
        target = one.get("$ref", "").rpartition("/")[2]
        if target:
            definition: dict[str, Any] = whole["$defs"][target]
            return {"type": "object"} if target in _ELSEWHERE else definition
    return schema


def _kind(member: dict[str, Any], shown: dict[str, Any]) -> str:
    values = shown.get("enum")
    if values:
        return ", ".join("null" if value is None else f"`{value}`" for value in values)
    kind = shown.get("type", "")
    kinds = [kind] if isinstance(kind, str) else list(kind)
    if "anyOf" in member:
        kinds.append("null")
    return " or ".join(kinds)


if __name__ == "__main__":
    rewrite(Path(sys.argv[1]), reference())
