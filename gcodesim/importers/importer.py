"""What an importer is, whoever adds one: it reads the settings of a control as a cell, and says what it leaves out."""

from __future__ import annotations

from codecs import BOM_UTF16_BE, BOM_UTF16_LE
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import ClassVar

from gcodesim.frozen import frozen

LARGEST = 4_000_000
"""Bytes of a file of settings; what is larger is something else."""


class NoSettingsError(ValueError):
    """There is no cell in this file; the text says why."""


@frozen(kw_only=False)
class FoundSetting:
    """`name` = `value` in line `line` of `file`; names have their section in front, as `[TRAJ]LINEAR_UNITS`."""

    name: str
    value: str
    file: str
    line: int


@frozen(kw_only=False)
class LeftOut:
    """A setting that is not in the cell, and why. `matters`: the machine moves by it."""

    setting: FoundSetting
    why: str
    matters: bool = False


@frozen
class Imported:
    """The lines of a cell file, how many settings went into them, and those that did not."""

    what: str
    lines: tuple[str, ...]
    taken: int
    left: tuple[LeftOut, ...]

    @property
    def text(self) -> str:
        return "".join(f"{line}\n" for line in self.lines)


@dataclass(slots=True)
class FoundSettings:
    """All settings of a file; who asks for one has taken it."""

    all: list[FoundSetting]
    _taken: set[FoundSetting] = field(default_factory=set)
    _reasons: dict[FoundSetting, LeftOut] = field(default_factory=dict)

    def values(self, name: str) -> list[FoundSetting]:
        """All settings of this name, in the order of the file; they count as taken."""
        found = [setting for setting in self.all if setting.name.upper() == name.upper()]
        self._taken.update(found)
        return found

    def take(self, setting: FoundSetting) -> None:
        """Say that a setting is in the cell."""
        self._taken.add(setting)

    def last(self, name: str) -> FoundSetting | None:
        """The last setting of this name, which is the one that holds."""
        found = self.values(name)
        return found[-1] if found else None

    def text(self, name: str, default: str = "") -> str:
        """Its value."""
        found = self.last(name)
        return default if found is None else found.value.strip()

    def number(self, name: str) -> float | None:
        """Its value as a number; what is none is left out."""
        found = self.last(name)
        if found is None:
            return None
        value = number_in(found.value)
        if value is None:
            self.leave(found, "no number", matters=True)
        return value

    def leave(self, setting: FoundSetting, why: str, *, matters: bool = False) -> None:
        """Say why a setting is not in the cell, although it was looked at."""
        self._reasons[setting] = LeftOut(setting, why, matters)

    def finished(self, reasons: Iterable[tuple[str, str, bool]] = ()) -> tuple[int, tuple[LeftOut, ...]]:
        """How many were taken, and the others with the first of the `reasons` (beginning of the name, why, whether it
        matters) that fits, in the order of the file."""
        left = []
        for setting in self.all:
            if setting in self._reasons:
                left.append(self._reasons[setting])
            elif setting not in self._taken:
                left.append(LeftOut(setting, *_reason(setting.name, reasons)))
        return len(self.all) - len(left), tuple(left)


def _reason(name: str, reasons: Iterable[tuple[str, str, bool]]) -> tuple[str, bool]:
    for begin, why, matters in reasons:
        if name.upper().startswith(begin.upper()):
            return why, matters
    return "a cell has no such key", False


class Importer:
    """The base of all importers. `kind` is the name in the table `IMPORTERS` and on the command line.

    `says` tells in a line what is read; `reads` what the file is, for the help.
    """

    kind: ClassVar[str] = ""
    says: ClassVar[str] = ""

    def read(self, path: Path, folder: Path) -> Imported:
        """The settings in the file (or folder) `path` for a cell in `folder`, which names files relative to that.

        OSError where it cannot be read, `NoSettingsError` where it holds no such settings.
        """
        raise NotImplementedError


def number_in(text: str) -> float | None:
    """A finite decimal number; None for anything else."""
    text = text.strip()
    if not text.isascii() or "_" in text:
        return None
    try:
        value = float(text)
    except ValueError:
        return None
    return value if value == value and abs(value) != float("inf") else None


def written(value: float) -> str:
    """A number as a cell file has it: short, without noise of units."""
    return f"{round(value, 9) + 0.0:.10g}"


def relative(file: Path, folder: Path) -> str | None:
    """The name of a file seen from the folder of the cell, where it lies below that; else None."""
    try:
        return file.resolve().relative_to(folder.resolve()).as_posix()
    except ValueError:
        return None


def read_text(path: Path) -> str:
    """The text of a file of settings; `NoSettingsError` if it is too large for one."""
    data = path.read_bytes()
    if len(data) > LARGEST:
        raise NoSettingsError(f"{path} is larger than a file of settings")
    return data.decode("utf-16" if data.startswith((BOM_UTF16_LE, BOM_UTF16_BE)) else "utf-8", "replace")


def quoted(text: str) -> str:
    """A text in YAML, in quotation marks."""
    escaped = "".join(c if c.isprintable() else "?" for c in text).replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'


def heading(path: Path, what: str) -> Iterator[str]:
    """How each imported cell begins."""
    name = "".join(c if c.isprintable() else "?" for c in path.name)
    yield f"# A cell from {name}, {what}: look at every line."
    yield "gcodesim: 1"
