"""All keys of the cell file as Markdown, from the classes that read them; `docs/cell.md` carries it.

`python -m gcodesim.cell.reference docs/cell.md` rewrites the part of that page between its two markers.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Final

from gcodesim.cell.cell import Cell
from gcodesim.cell.channel import Channel, Orientation
from gcodesim.cell.machine import LinearAxis, MachineForm, RotaryAxis
from gcodesim.cell.material import MaterialForm
from gcodesim.cell.placing import Place
from gcodesim.cell.robot import RobotForm
from gcodesim.cell.schema import units_as_text
from gcodesim.cell.settings import Limits, LogSettings, Magazine, Simulation, Suppression
from gcodesim.cell.stock import Body, StockSpec, Target
from gcodesim.declarations.keys import Key, all_keys, keys
from gcodesim.key_page import escaped, rewrite
from gcodesim.tools import TOOLS

_SECTIONS: Final[tuple[tuple[str, type], ...]] = (
    ("A place (`frames`, `base`, and among the keys of whatever stands somewhere)", Place),
    ("`machine`", MachineForm),
    ("Axes X, Y, Z", LinearAxis),
    ("Axes A, B, C", RotaryAxis),
    ("`robots`", RobotForm),
    ("`channels`; with one robot or machine these keys stand at top level", Channel),
    ("`orientation`", Orientation),
    ("Shapes of stock and fixtures", Body),
    ("`stock`, besides its shape and place", StockSpec),
    ("`materials`", MaterialForm),
    ("`target`, besides its place", Target),
    ("`magazine`, besides its place", Magazine),
    ("`limits`", Limits),
    ("`suppress`", Suppression),
    ("`simulation`", Simulation),
    ("`log`", LogSettings),
)


def reference() -> str:
    """The reference: a table for each class, one for each tool type, and the units."""
    parts = ["### Top level", "", *_table(list(keys(Cell).values()))]
    shared = set(all_keys(Body))
    for title, cls in _SECTIONS:
        own = [key for key in keys(cls).values() if cls is Body or key.name not in shared]
        parts += ["", f"### {title}", "", *_table(own)]
    for name in TOOLS:
        parts += ["", f"### Tool type `{name}`", "", *_table(list(all_keys(TOOLS[name]).values()))]
    return "\n".join([*parts, "", "### Units", "", "```text", units_as_text(), "```"])


def _table(rows: list[Key]) -> list[str]:
    head = ["| key | expects | meaning |", "|---|---|---|"]
    return head + [
        f"| `{key.name}`{' (required)' if key.required else ''} | {escaped(key.kind.expected)} | {escaped(key.doc)} |"
        for key in rows
    ]


if __name__ == "__main__":
    rewrite(Path(sys.argv[1]), reference())
