"""pytest plugin: each case of a `NAME.test.yaml` is a test item, with the same verdict as in `gcodesim test`.

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
    from gcodesim.regress import CaseVerdict, JudgedFinding
    from gcodesim.regress.baseline import Baseline
    from gcodesim.regress.cache import Cache
    from gcodesim.regress.case import Case, Collected

_SUFFIXES: Final = (".test.yaml", ".test.yml")
_FAIL_ON: Final = ("error", "warning", "note", "never")
_BASELINE: Final[pytest.StashKey[Baseline]] = pytest.StashKey()
_CACHE: Final[pytest.StashKey[Cache]] = pytest.StashKey()


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
    group.addoption(
        "--gcodesim-baseline",
        type=Path,
        metavar="FILE",
        help="findings in this file, which `gcodesim test --write-baseline` wrote, are known and do not fail",
    )
    group.addoption(
        "--gcodesim-changed",
        action="store_true",
        help="run only cases that have not passed before with the same inputs, here or in `gcodesim test`",
    )


def pytest_configure(config: pytest.Config) -> None:
    path = config.option.gcodesim_baseline
    if path is None:
        return
    from gcodesim.diagnostics import SourceText
    from gcodesim.regress.baseline import Baseline, BaselineError

    try:
        config.stash[_BASELINE] = Baseline.read(SourceText.read(config.invocation_params.dir / path))
    except FileNotFoundError:
        raise pytest.UsageError(f"baseline {path} is not there") from None
    except (OSError, BaselineError) as error:
        raise pytest.UsageError(f"baseline {path} cannot be read: {error}") from None


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> pytest.Collector | None:
    if not file_path.name.endswith(_SUFFIXES):
        return None
    node: pytest.Collector = TestFile.from_parent(parent, path=file_path)
    return node


class TestFile(pytest.File):
    """A test file: one item for each program, and one for what is wrong with the file itself."""

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
    """What makes a case fail; shown without a traceback, because it contains no code of the user."""


class _Item(pytest.Item):
    def reportinfo(self) -> tuple[Path, int | None, str]:
        return self.path, None, f"{self.path.name}: {self.name}"

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> Any:
        if isinstance(excinfo.value, CaseFailure):
            return str(excinfo.value)
        return super().repr_failure(excinfo, style)

    def _text(self, found: list[JudgedFinding]) -> str:
        from gcodesim.formats.text import found_text
        from gcodesim.regress.sources import Sources

        sources = Sources(self.config.rootpath)
        return "\n".join(found_text(one, sources) for one in found)


class FaultItem(_Item):
    """What is wrong with a test file."""

    def __init__(self, *, found: tuple[JudgedFinding, ...], **more: Any) -> None:
        super().__init__(**more)
        self._found = found

    def runtest(self) -> None:
        counting = [one for one in self._found if one.state == "counts"]
        if counting:
            raise CaseFailure(self._text(counting))


class CaseItem(_Item):
    """One program in one cell, compared with its accepted results and expectations."""

    def __init__(self, *, case: Case, **more: Any) -> None:
        super().__init__(**more)
        self._case = case

    def runtest(self) -> None:
        verdict = self._verdict()
        told = [one for one in verdict.found if one.state != "counts"]
        if told:
            self.add_report_section("call", "gcodesim", self._text(told))
        if verdict.status == "failed":
            raise CaseFailure(self._failure(verdict))

    def _verdict(self) -> CaseVerdict:
        """The verdict, as in `gcodesim test`, and kept in the same memory."""
        from gcodesim.regress.cache import Cache, default_folder
        from gcodesim.regress.judge import judge
        from gcodesim.regress.outcome import Judging
        from gcodesim.regress.sources import Sources
        from gcodesim.regress.suite import with_baseline

        options, root = self.config.option, self.config.rootpath
        today = options.gcodesim_today or date.today()
        how = Judging(root=root, fail_on=options.gcodesim_fail_on, today=today)
        stash = self.config.stash
        if _CACHE not in stash:
            stash[_CACHE] = Cache(default_folder(), root, how.settings)
        cache = stash[_CACHE]
        verdict = cache.find(self._case, today) if options.gcodesim_changed else None
        if verdict is None:
            verdict, outcome = judge(self._case, how)
            cache.keep(self._case, verdict, outcome.files, outcome.until, today)
        baseline = stash.get(_BASELINE, None)
        return verdict if baseline is None else with_baseline(verdict, baseline, Sources(root))

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
