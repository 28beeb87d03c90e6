"""What all ways to run a case need: settings that cases share, and what comes of one."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, replace
from datetime import date
from pathlib import Path

from gcodesim.declarations.files import folders_of_the_user
from gcodesim.diagnostics import Diagnostic, Severity, SourceText
from gcodesim.frozen import frozen
from gcodesim.jobs.job import Options
from gcodesim.regress.case import Case, shown_path
from gcodesim.regress.facts import Facts
from gcodesim.rs274 import Settings


@frozen
class Judging:
    """Settings that all cases of a test run share. `root` is the folder from which files are named."""

    root: Path
    fail_on: str = "error"
    today: date | None = None
    allow_paths: tuple[Path, ...] = ()
    allow_code: bool = False

    def allowed(self, case: Case) -> tuple[Path, ...]:
        """Folders from which the case's cell may take files: those that its test file names below `root`, and ours."""
        root = os.path.realpath(self.root)
        named = (folder for folder in case.allow_path if Path(os.path.realpath(folder)).is_relative_to(root))
        return (*named, *self.allow_paths)

    @property
    def settings(self) -> str:
        """What a verdict depends on besides its case and the day; used by the cache."""
        folders = (shown_path(folder, self.root) for folder in (*self.allow_paths, *folders_of_the_user()))
        code = ("code",) if self.allow_code else ()
        return " ".join((f"fail on {self.fail_on}", *folders, *code))


@dataclass(slots=True, kw_only=True)
class Outcome:
    """The result of running a case.

    `programs` are the program and its subprograms, `files` the paths of all that was read, `until` the days on which
    suppressions of the cell end.
    """

    facts: Facts
    findings: list[Diagnostic]
    suppressed: list[tuple[Diagnostic, str]]
    programs: Mapping[str, SourceText]
    files: dict[str, Path]
    until: tuple[date, ...] = ()
    faults: list[Diagnostic]


def settings_of(case: Case, settings: Settings) -> Settings:
    """The reader's settings with the options of the test file."""
    given = {
        name: value
        for name in ("dialect", "block_delete", "max_blocks", "time_limit")
        if (value := getattr(case.options, name)) is not None
    }
    return replace(settings, **given)


def options_of(case: Case, how: Judging) -> Options:
    """The options of a run of the case, without programs of channels."""
    return Options(
        world=case.options.world,
        settings=lambda settings: settings_of(case, settings),
        today=how.today,
        fail_on=None if how.fail_on == "never" else Severity[how.fail_on.upper()],
    )


def nothing_ran(case: Case, program: SourceText, fault: Diagnostic) -> Outcome:
    """The outcome of a case that could not even begin, because of `fault`."""
    return Outcome(
        facts=Facts(name=program.name),
        findings=[],
        suppressed=[],
        programs={program.name: program},
        files={program.name: case.program},
        faults=[fault],
    )
