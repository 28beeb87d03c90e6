"""Another place for a frame or a robot, written into the text of a cell; all else stays as it is written."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Final

from gcodesim.arithmetic.matrices import applied
from gcodesim.cell.cell import Cell
from gcodesim.cell.placing import Place
from gcodesim.declarations.nodes import Mapping, Node, compose
from gcodesim.diagnostics import Findings, SourceText, Span
from gcodesim.frames import WORLD, Array
from gcodesim.frozen import frozen
from gcodesim.units import MM

_TENTH: Final = 1  # decimals of a mm that are written


class NotMovableError(Exception):
    """What is to be moved cannot be; the text says why."""


@frozen
class Shifted:
    """A place of the cell file, `keys` leading to it, with its new position `xyz` [m] in the frame that it names."""

    keys: tuple[str, ...]
    xyz: tuple[float, float, float]

    @property
    def text(self) -> str:
        """The position as it is written."""
        x, y, z = (f"{round(v / MM, _TENTH) + 0.0:g}" for v in self.xyz)
        return f"[{x}, {y}, {z} mm]"


def shifted_work(cell: Cell, channel: str, system: str, shift: Array) -> Shifted:
    """The outermost frame that carries work system `system` (such as `G54`), moved by `shift` (3,) [m] in the world.

    What stands on a positioner is moved on it, the shift as it is seen with its axes at zero.
    """
    own = cell.channels[channel]
    if system not in own.work_offsets:
        raise NotMovableError(f"the cell gives no place of {system}")
    in_channels = len(cell.channels) > 1
    keys: tuple[str, ...] = ("work_offsets", system)
    if in_channels:
        keys = ("channels", channel, *keys)
    place = own.work_offsets[system]
    while place.frame in cell.placed_frames:
        keys, place = ("frames", str(place.frame)), cell.placed_frames[str(place.frame)]
    return _moved(cell, keys, place, shift)


def standing_on(cell: Cell, channel: str, moved: Sequence[Shifted]) -> frozenset[str]:
    """The names of fixtures and stocks that stand on one of the places and go along when that is moved."""
    own = cell.channels[channel]
    keys = [shifted.keys for shifted in moved]
    systems = {key[-1] for key in keys if "work_offsets" in key}
    frames = {key[-1] for key in keys if key[0] == "frames"}

    def goes_along(frame: str | None) -> bool:
        while frame is not None:
            if frame in systems or frame in frames:
                return True
            place = cell.placed_frames.get(frame) or own.work_offsets.get(frame)
            frame = None if place is None else place.frame
        return False

    stocks = {name: stock.place.frame or "G54" for name, stock in cell.stocks.items()}
    fixtures = {name: fixture.place.frame for name, fixture in cell.fixtures.items()}
    return frozenset(name for name, frame in {**fixtures, **stocks}.items() if goes_along(frame))


def shifted_robot(cell: Cell, robot: str, shift: Array) -> Shifted:
    """The base of a robot, moved by `shift` (3,) [m] in the world."""
    return _moved(cell, ("robots", robot, "base"), cell.robots[robot].base, shift)


def _moved(cell: Cell, keys: tuple[str, ...], place: Place, shift: Array) -> Shifted:
    parent = place.frame or WORLD
    platforms = cell.platforms
    platforms |= {link.rpartition("/")[2]: X for link, X in platforms.items()}
    X_WA = cell.frames.get(parent) or platforms.get(parent)
    if X_WA is None:
        raise NotMovableError(f"`{'.'.join(keys)}` stands on {parent}, which moves")
    x, y, z = (place.xyz + applied(X_WA.inverse().R, shift)).tolist()
    return Shifted(keys=keys, xyz=(x, y, z))


def rewritten(source: SourceText, moved: Shifted) -> SourceText:
    """The cell with that position; NotMovableError where it is not written in a way that can be changed."""
    old = source.text.encode(source.encoding)
    mark = source.raw[: len(source.raw) - len(old)]  # of the order of bytes, if there is one
    return SourceText(source.name, mark + _text(source, moved).encode(source.encoding))


def _text(source: SourceText, moved: Shifted) -> str:
    root = compose(source, Findings())
    node: Node | None = root
    for number, key in enumerate(moved.keys):
        if not isinstance(node, Mapping):
            break
        below = node.get(key)
        if below is None and number == len(moved.keys) - 1 and moved.keys[0] == "robots":
            return _with_entry(source, node, f"base: {{xyz: {moved.text}}}")
        node = below
    if not isinstance(node, Mapping):
        raise NotMovableError(f"`{'.'.join(moved.keys)}` is not written as a mapping with `xyz`")
    old = node.get("xyz")
    if old is None:
        return _with_entry(source, node, f"xyz: {moved.text}")
    start, end = _range(source, old.span)
    return source.text[:start] + moved.text + source.text[end:]


def _with_entry(source: SourceText, node: Mapping, entry: str) -> str:
    text = source.text
    start, end = _range(source, node.span)
    if text[start] == "{":
        close = text.rindex("}", start, end)
        comma = ", " if node.entries else ""
        return f"{text[:close].rstrip()}{comma}{entry}{text[close:]}"
    first, _ = _range(source, node.entries[0][0].span)
    indent = " " * (node.entries[0][0].span.column - 1)
    return f"{text[:first]}{entry}\n{indent}{text[first:]}"


def _range(source: SourceText, span: Span) -> tuple[int, int]:
    """Where a span begins and ends in the text."""
    starts = [0, *(m.end() for m in re.finditer(r"\r\n|\n|\r", source.text))]
    return starts[span.line - 1] + span.column - 1, starts[span.end_line - 1] + span.end_column - 1
