"""INI files as LinuxCNC and Klipper have them, with files that they include."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Final

from gcodesim.importers.importer import FoundSetting, NoSettingsError, read_text

_MOST_FILES: Final = 50
_SECTION: Final = re.compile(r"\[([^\]]*)\]")


def read_linuxcnc_ini(path: Path) -> list[FoundSetting]:
    """Settings `[SECTION]NAME`, lines that go on after a backslash joined, `#INCLUDE` followed."""
    found: list[FoundSetting] = []
    _linuxcnc(path, "", found, [])
    return found


def _linuxcnc(path: Path, section: str, found: list[FoundSetting], opened: list[Path]) -> str:
    _open(path, opened)
    held, held_line = "", 0
    for number, raw in enumerate(read_text(path).splitlines(), start=1):
        line = held + raw.strip() if held else raw.strip()
        first, held, held_line = (held_line if held else number), "", held_line
        if line.endswith("\\"):
            held, held_line = line[:-1], first
            continue
        if line.upper().startswith("#INCLUDE"):
            name = line[len("#INCLUDE") :].strip().strip('"')
            if name and (path.parent / name).is_file():
                section = _linuxcnc(path.parent / name, section, found, opened)
            else:
                found.append(FoundSetting("#INCLUDE", name, path.name, first))
            continue
        if not line or line[0] in "#;":
            continue
        head = _SECTION.fullmatch(line.partition("#")[0].strip())
        if head is not None:
            section = head[1].strip()
            continue
        name, equals, value = line.partition("=")
        value = re.sub(r"\s+[#;].*$", "", value)
        if equals:
            found.append(FoundSetting(f"[{section}]{name.strip()}", value.strip(), path.name, first))
        else:
            found.append(FoundSetting(f"[{section}]{line}", "", path.name, first))
    return section


def read_klipper_config(path: Path) -> list[FoundSetting]:
    """Settings `[section]name`; values over several indented lines are one; `[include file]` followed, as far as the
    file is there."""
    found: list[FoundSetting] = []
    _klipper(path, found, [])
    return found


def _klipper(path: Path, found: list[FoundSetting], opened: list[Path]) -> None:
    _open(path, opened)
    section = ""
    for number, raw in enumerate(read_text(path).splitlines(), start=1):
        line = re.sub(r"(^|\s)[#;].*$", "", raw).rstrip()
        if not line.strip():
            continue
        if line[0] in " \t" and found and found[-1].file == path.name and section:
            last = found[-1]
            found[-1] = FoundSetting(last.name, f"{last.value} {line.strip()}".strip(), last.file, last.line)
            continue
        head = _SECTION.match(line)
        if head is not None:
            section = head[1].strip()
            if section.startswith("include "):
                _include(path, section[len("include ") :].strip(), number, found, opened)
            elif section.startswith(("gcode_macro", "homing_override", "delayed_gcode")):
                found.append(FoundSetting(f"[{section}]", "", path.name, number))
            continue
        name, sign, value = re.match(r"([^:=]*)([:=]?)(.*)", line, re.DOTALL).groups()  # type: ignore[union-attr]
        found.append(FoundSetting(f"[{section}]{name.strip()}", value.strip() if sign else "", path.name, number))


def _include(path: Path, pattern: str, number: int, found: list[FoundSetting], opened: list[Path]) -> None:
    files = [] if ".." in pattern or pattern.startswith("/") else sorted(path.parent.glob(pattern))
    if not files:
        found.append(FoundSetting("[include]", pattern, path.name, number))
    for file in files:
        if file.is_file():
            _klipper(file, found, opened)


def _open(path: Path, opened: list[Path]) -> None:
    """Note a file; NoSettingsError where files include each other without end."""
    if path.resolve() in opened or len(opened) >= _MOST_FILES:
        raise NoSettingsError(f"{path.name} is included in a circle, or there are more than {_MOST_FILES} files")
    opened.append(path.resolve())
