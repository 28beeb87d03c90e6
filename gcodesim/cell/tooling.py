"""Tools of the cell by number; their keys are those that the kinds of tools declare."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from gcodesim.declarations.keys import all_keys
from gcodesim.declarations.map_of import NameRule
from gcodesim.declarations.nodes import Node, Scalar
from gcodesim.declarations.reading import UNREAD, Path, Reading, Unread
from gcodesim.declarations.record import Record
from gcodesim.declarations.scalars import integer
from gcodesim.declarations.variant import Variant
from gcodesim.frozen import frozen
from gcodesim.tools import TOOLS

if TYPE_CHECKING:
    from gcodesim.tools.tool import Tool


def tool_number(text: str) -> int | None:
    """`7`, `07` or `"7"` → 7. 0 is the first extruder of a printer; for other controls it is the empty spindle."""
    number = integer(text)
    return number if number is not None and 0 <= number <= 99_999 else None


TOOL_NUMBERS: Final = NameRule(
    what="tool number (1 to 99999; 0 for the first extruder of a printer)",
    pattern=r"0*[0-9]{1,5}",
    canonical=tool_number,
)


@frozen
class _ToolKind(Variant):
    """A tool of the family; its number is the name of its entry."""

    def member(
        self, record: Record, entries: tuple[tuple[Scalar, Node], ...], to: Reading, path: Path
    ) -> Tool | Unread:
        tool = record.read_entries(entries, to, path, number=int(path[-1]))
        return UNREAD if isinstance(tool, Unread) else _possible(tool, to, path)


TOOL: Final = _ToolKind(family=TOOLS, what="tool", example="{type: flat_end_mill, diameter: 10 mm}")


def _possible(tool: Any, to: Reading, path: Path) -> Tool | Unread:
    """`tool`, or UNREAD with a finding for each reason why it cannot exist."""
    problems = tool.problems()
    if tool.number == 0 and "extrusion" not in tool.processes:
        problems = [*problems, ("type", "T0 is the empty spindle; only an extruder may be tool 0")]
    written = [problem for problem in problems if (*path, *_keys(problem[0])) in to.spans]
    cls: type = type(tool)
    known = all_keys(cls)
    for name, message in written or problems:  # a default that follows from a wrong value is not a separate fault
        key = name.split(".")[0]
        hint = f"the default of `{name}` does not fit the other keys; write it"
        if written and key in known:
            hint = f"`{key}`: {known[key].doc}"
        to.fault("GS720", to.span((*path, *_keys(name))), f"tool {tool.number} is impossible: {message}", hint)
    return UNREAD if problems else tool


def _keys(name: str) -> Path:
    """The path of a key such as `holder.above.0.length` below its tool."""
    return tuple(int(part) if part.isdigit() else part for part in name.split("."))
