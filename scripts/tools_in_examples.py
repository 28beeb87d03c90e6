"""Which kinds of tools, and which processes, accepted examples show: `python scripts/tools_in_examples.py`.

The tables are written between the markers of `docs/gallery.md`; a test tells of kinds that no example of a world has.
"""

from __future__ import annotations

import json
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from gcodesim.cell.loader import load_cell
from gcodesim.declarations.nodes import compose
from gcodesim.diagnostics import Findings, SourceText
from gcodesim.key_page import rewrite
from gcodesim.processes import PROCESSES
from gcodesim.tools import TOOLS
from gcodesim.tools.tool import Tool

TOP = Path(__file__).resolve().parent.parent
WORLDS = ("kinematic", "bullet")


class Use(NamedTuple):
    """A tool that a program of an accepted example has on its machine for some time, in a world."""

    example: str
    world: str
    tool: Tool


def uses() -> Iterator[Use]:
    """All uses of tools in the examples, by what their golden files say of the time of each."""
    for case in sorted((TOP / "programs").glob("*.test.yaml")):
        name = case.name.removesuffix(".test.yaml")
        said = _case(case)
        golden = json.loads(case.with_name(f"{name}.golden.json").read_text(encoding="utf-8"))["results"]
        if "cell" not in said or "tools" not in golden:
            continue  # a job of several set-ups has a cell for each
        loaded = load_cell(case.parent / said["cell"])
        assert loaded.cell is not None, said["cell"]
        world = said.get("world") or loaded.cell.simulation.world or "bullet"
        for row in golden["tools"]:
            tool = loaded.cell.tools.get(row["number"])
            if tool is not None and row["time_s"] > 0.0:
                yield Use(name, world, tool)


def _case(path: Path) -> dict[str, str]:
    """`cell` and `world` of a test file."""
    root = compose(SourceText(path.name, path.read_bytes()), Findings())
    found: dict[str, str] = {}
    for key, value in getattr(root, "entries", ()):
        if key.text == "cell":
            found["cell"] = value.text
        for inner, word in getattr(value, "entries", ()) if key.text == "options" else ():
            if inner.text == "world":
                found["world"] = word.text
    return found


def table() -> dict[str, dict[str, list[str]]]:
    """The examples by kind of tool, or process, and world; each family in its order."""
    found: dict[str, dict[str, list[str]]] = {f"tool {kind}": defaultdict(list) for kind in TOOLS}
    found |= {f"process {kind}": defaultdict(list) for kind in PROCESSES}
    for use in uses():
        acts = ["turning"] if use.tool.kind == "drill" and "turning" in use.tool.acts_by else list(use.tool.acts_by)
        for row in (f"tool {use.tool.kind}", *(f"process {kind}" for kind in acts)):
            if use.example not in found[row][use.world]:
                found[row][use.world].append(use.example)
    return found


def as_text() -> str:
    """The table as Markdown."""
    lines = ["| | in the kinematic world | in bullet |", "|---|---|---|"]
    for row, worlds in table().items():
        what, kind = row.split(" ", 1)
        cells = [", ".join(f"`{name}`" for name in worlds[world]) for world in WORLDS]
        lines.append(f"| {what} `{kind}` | {' | '.join(cells)} |")
    return "\n".join(lines)


if __name__ == "__main__":
    rewrite(TOP / "docs" / "gallery.md", as_text())
