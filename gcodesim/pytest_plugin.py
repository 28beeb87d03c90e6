"""pytest plugin: each case of a `NAME.test.yaml` is a test item. As `gcodesim test` judges it, so does pytest.

Nothing of gcodesim is imported before a test file is met, and nothing heavy before a case runs.
"""

from __future__ import annotations

import textwrap
from collections.abc import Iterator
from datetime import date
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import pytest

if TYPE_CHECKING:
    from gcodesim.regress import CaseVerdict, Found
    from gcodesim.regress.case import Case, Collected

_SUFFIXES: Final = (".test.yaml", ".test.yml")
_FAIL_ON: Final = ("error", "warning", "note", "never")


def pytest_addoption(parser: pytest.Parser) -> None:
    group = parser.getgroup("gcodesim", "G-code programs with expectations (NAME.test.yaml)")
    group.addoption(
        "--gcodesim-fail-on",
        choices=_FAIL_ON,
        default="error",
        help="a case fails when a finding is this severe or more (default: error)",
    )
    group.addoption(
        "--gcodesim-today",
        type=date.fromisoformat,
        metavar="DAY",
        help="the day with which `until:` of suppressions is compared (default: the system's)",
    )


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> pytest.Collector | None:
    if not file_path.name.endswith(_SUFFIXES):
        return None
    node: pytest.Collector = TestFile.from_parent(parent, path=file_path)
    return node


class TestFile(pytest.File):
    """A test file: one item a program, and one for what is wrong with the file itself."""

    def collect(self) -> Iterator[pytest.Item]:
        collected = _collected(self.path, self.config.rootpath)
        if collected.found:
            yield FaultItem.from_parent(self, name="test file", found=collected.found)
        for case in collected.cases:
            yield CaseItem.from_parent(self, name=case.name.rpartition("/")[2], case=case)


def _collected(path: Path, root: Path) -> Collected:
    """The cases of one test file; a program that has a file of its own is not taken by a pattern here."""
    from gcodesim.regress.case import Collected, collect

    alone = collect([path], root)
    names = [case.program.with_name(case.program.stem + suffix) for case in alone.cases for suffix in _SUFFIXES]
    others = [name for name in dict.fromkeys(names) if name != path and name.is_file()]
    if not others:
        return alone
    cases = collect([path, *others], root).cases
    return Collected(cases=tuple(case for case in cases if case.test_file == path), found=alone.found)


class CaseFailure(Exception):  # noqa: N818 (a verdict, no error)
    """What makes a case fail; told without a traceback, because no code of the user's is in it."""


class _Item(pytest.Item):
    def reportinfo(self) -> tuple[Path, int | None, str]:
        return self.path, None, f"{self.path.name}: {self.name}"

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> Any:
        if isinstance(excinfo.value, CaseFailure):
            return str(excinfo.value)
        return super().repr_failure(excinfo, style)

    def _text(self, found: list[Found]) -> str:
        from gcodesim.formats.text import found_text
        from gcodesim.regress.sources import Sources

        sources = Sources(self.config.rootpath)
        return "\n".join(found_text(one, sources) for one in found)


class FaultItem(_Item):
    """What is wrong with a test file."""

    def __init__(self, *, found: tuple[Found, ...], **more: Any) -> None:
        super().__init__(**more)
        self._found = found

    def runtest(self) -> None:
        counting = [one for one in self._found if one.state == "counts"]
        if counting:
            raise CaseFailure(self._text(counting))


class CaseItem(_Item):
    """One program in one cell, against what was accepted and expected of it."""

    def __init__(self, *, case: Case, **more: Any) -> None:
        super().__init__(**more)
        self._case = case

    def runtest(self) -> None:
        from gcodesim.regress.judge import Judging, judge

        options = self.config.option
        how = Judging(
            root=self.config.rootpath,
            fail_on=options.gcodesim_fail_on,
            today=options.gcodesim_today or date.today(),
        )
        verdict, _ = judge(self._case, how)
        told = [one for one in verdict.found if one.state != "counts"]
        if told:
            self.add_report_section("call", "gcodesim", self._text(told))
        if verdict.status == "failed":
            raise CaseFailure(self._failure(verdict))

    def _failure(self, verdict: CaseVerdict) -> str:
        from gcodesim.formats.text import counting

        failing = counting(verdict)
        cell = f" in {verdict.cell}" if verdict.cell else ""
        more = f" (and {len(failing) - 1} more)" if len(failing) > 1 else ""
        # pytest's summary shows the first line
        head = f"{failing[0].finding.code}: {failing[0].finding.message}{more}"
        lines = [head, f"{verdict.program}{cell}", textwrap.indent(self._text(failing), "  ")]
        if verdict.quantities:
            lines.append(f"differs from what was accepted: {', '.join(verdict.quantities)}")
            lines.append(f"`gcodesim diff` shows it; `gcodesim accept {verdict.file}` takes it over")
        return "\n".join(lines)
