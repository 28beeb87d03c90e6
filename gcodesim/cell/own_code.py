"""`code:` of a cell: Python files that add members to families, run only where the user allows it.

The door is `Shelf.runs_code`, which the command line (`--allow-code`) or the calling program opens, and no file.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from types import ModuleType
from typing import Any, Final

from gcodesim.declarations.file_kind import File, FileValue
from gcodesim.declarations.kind import short
from gcodesim.declarations.nodes import Node
from gcodesim.declarations.reading import UNREAD, Path, Reading, Unread
from gcodesim.diagnostics import SourceText
from gcodesim.family import ExtensionError, Family, object_at
from gcodesim.frozen import frozen

CODE: Final = "code"
"""The key of the cell."""

_FAMILIES: Final = (
    ("gcodesim.tools:TOOLS", "gcodesim.tools.tool:Tool"),
    ("gcodesim.processes:PROCESSES", "gcodesim.processes.protocol:Process"),
    ("gcodesim.sensors:SENSORS", "gcodesim.sensors.sensor:Sensor"),
    ("gcodesim.controllers:CONTROLLERS", "gcodesim.controllers.controller:Controller"),
    ("gcodesim.actions:ACTIONS", "gcodesim.actions.action:WordAction"),
)
"""Families by place, and what their members are."""

ADDS: Final = "tools, processes, sensors, controllers, actions and materials"


@frozen(kw_only=False)
class CodeFile(File):
    """The name of a Python file; reading it runs it, where that is allowed."""

    def read(self, node: Node, to: Reading, path: Path) -> FileValue | Unread:
        found = File.read(self, node, to, path)
        if isinstance(found, Unread):
            return UNREAD
        if not to.shelf.runs_code:
            return to.fault(
                "GS736",
                node.span,
                f"`{short(found.name)}` is Python, which this cell cannot start by itself",
                "read the file; if you trust it, add `--allow-code` to the command, "
                "or `allow_code=True` in a program of your own",
            )
        try:
            run_code(to.shelf.sources[found.name], _FAMILIES, to.shelf.modules)
        except ExtensionError as error:
            return to.fault("GS737", node.span, f"`{short(found.name)}` cannot be used: {error}")
        return found


def run_code(source: SourceText, families: tuple[tuple[str, str], ...], modules: list[str]) -> None:
    """Run the text of a file, and add what it has to `families`, which are given by place and by that of their base.

    `modules` are those of the files beside it; its own comes to them. The text of a file is run once in a process.
    ExtensionError when it fails, has nothing that could be added, or only what others have added.
    """
    name = f"gcodesim_own_{source.sha256[:16]}"
    module = sys.modules.get(name) or _run(source, name)
    added = list(_members(module, families))
    if not added:
        raise ExtensionError(f"it adds none of {ADDS}: classes that have a `kind`, and objects `Material`")
    for family, key, variant in added:
        family.lend(key, variant, name, source.name, modules)
    modules.append(name)


def _run(source: SourceText, name: str) -> ModuleType:
    module = ModuleType(name)
    module.__file__ = source.name
    sys.modules[name] = module  # dataclasses look there
    try:
        exec(compile(source.text, source.name, "exec"), module.__dict__)
    except (Exception, SystemExit) as error:  # whatever the file of a user does when it is run
        del sys.modules[name]
        reason = " ".join(str(error).split())
        raise ExtensionError(f"{type(error).__name__}{_line_of(error, source.name)}: {reason}") from error
    return module


def _line_of(error: BaseException, file: str) -> str:
    """` in line 7`, the innermost line of the file."""
    line = error.lineno if isinstance(error, SyntaxError) else None
    trace = error.__traceback__
    while trace is not None:
        if trace.tb_frame.f_code.co_filename == file:
            line = trace.tb_lineno
        trace = trace.tb_next
    return "" if line is None else f" in line {line}"


def _members(module: ModuleType, families: tuple[tuple[str, str], ...]) -> Iterator[tuple[Family, str, Any]]:
    """What a module itself defines for a family, by name."""
    from gcodesim.processes.materials import MATERIALS, Material, plain

    bases = [(object_at(family), object_at(base)) for family, base in families]
    for value in list(vars(module).values()):
        if isinstance(value, Material):
            yield MATERIALS, plain(value.id), value
        if not isinstance(value, type) or value.__module__ != module.__name__:
            continue
        kind = vars(value).get("kind", "")
        for family, base in bases:
            if kind and issubclass(value, base):
                yield family, kind, value
