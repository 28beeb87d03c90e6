"""Test cases, and how they are found: test files, the programs they name, programs with expectations in comments."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import field, replace
from fnmatch import fnmatch
from pathlib import Path, PurePosixPath
from typing import Final

from gcodesim.declarations.reading import Path as At
from gcodesim.declarations.reading import suggestion
from gcodesim.diagnostics import Diagnostic, SourceText, Span
from gcodesim.frozen import frozen
from gcodesim.regress.case_file import SUFFIXES, CaseFile, CaseOptions, Expected, read_case_file
from gcodesim.regress.expectation import expectations
from gcodesim.regress.golden import SUFFIX as GOLDEN_SUFFIX
from gcodesim.regress.programs import PROGRAMS, programs_in
from gcodesim.regress.readable import Readable
from gcodesim.regress.tolerance import DEFAULTS, Tolerance
from gcodesim.regress.verdicts import JudgedFinding
from gcodesim.rs274 import read_program
from gcodesim.setups.naming import SUFFIXES as JOBS
from gcodesim.setups.naming import is_job_file

_GOLDENS: Final = ".golden"


@frozen
class Case:
    """One program in one cell. Paths can be opened; `name` and `file` are for people, from the root, with `/`.

    `spans` are places in the test file by path, such as ``("expect", "status")`` or ``("options", "dialect")``.
    `channels` are the programs of further channels.
    `edits` are texts that are read in place of the files at some paths, to ask what the case would see.
    """

    name: str
    file: str
    program: Path
    cell: Path | None
    golden: Path
    options: CaseOptions = field(default_factory=CaseOptions)
    tolerances: Mapping[str, Tolerance] = field(default_factory=lambda: dict(DEFAULTS))
    expect: Expected = field(default_factory=Expected)
    allow_path: tuple[Path, ...] = ()
    channels: Mapping[str, Path] = field(default_factory=dict)
    spans: Mapping[At, Span] = field(default_factory=dict)
    test_file: Path | None = None
    edits: Mapping[Path, bytes] = field(default_factory=dict)

    def read(self, path: Path) -> SourceText:
        """The text at `path` as this case has it. OSError when it cannot be read."""
        source = read_program(path)
        return replace(source, raw=self.edits[path]) if path in self.edits else source


@frozen
class Collected:
    """All cases by name, and what is wrong with test files."""

    cases: tuple[Case, ...]
    found: tuple[JudgedFinding, ...]


def shown_path(path: Path, root: Path) -> str:
    """`path` relative to `root`, with `/`: the same on every machine with the same folders."""
    return PurePosixPath(*Path(os.path.relpath(path, root)).parts).as_posix()


def collect(
    paths: Iterable[Path],
    root: Path,
    *,
    cell: Path | None = None,
    names: Sequence[str] = (),
    allow_paths: Sequence[Path] = (),
) -> Collected:
    """The cases at `paths` (test files, programs, folders), ordered by name.

    A program is a case by its own test file, by one that names it, or, without either, if it is named itself, has
    expectations in comments, or `cell` is given. `names` keeps cases whose name contains one of them or matches it
    as a pattern. Test files, programs and cells may lie in `root`, in or beside `paths`, and in `allow_paths`; links
    lead nowhere else. OSError when a path cannot be read.
    """
    paths = list(paths)
    readable = Readable.of(root, paths, allow_paths)
    files: dict[Path, None] = {}
    programs: dict[Path, bool] = {}
    for path in paths:
        if path.is_dir():
            files |= dict.fromkeys(sorted(p for p in path.rglob("*") if is_test_file(p) and not _is_hidden(p, path)))
            programs |= {p: programs.get(p, False) for p in programs_in(path) if not _is_hidden(p, path)}
        elif is_test_file(path):
            files[path] = None
        else:
            program = _program_of_golden(path)
            own = program if is_test_file(program) else _own_test_file(program)
            if own is not None:
                files[own] = None
            else:
                programs[program] = True
    cases: dict[str, Case] = {}
    found: list[JudgedFinding] = []
    goldens: dict[Path, Case] = {}
    taken: set[Path] = set()
    # a program's own file overrides one that names it by a pattern
    own_first = sorted(files, key=lambda file: (_own_program(file) is None, file))
    for file in own_first:
        if not readable.has(file):
            found.append(JudgedFinding(finding=readable.link_fault(shown_path(file, root)), state="counts"))
            continue
        source = SourceText.read(file, shown_path(file, root))
        read = read_case_file(source, file.parent)
        found += [JudgedFinding(finding=finding, state="counts") for finding in read.findings]
        if read.content is None:
            continue
        made, faults = _cases_of(file, source.name, read.content, read.spans, root, cell, taken, readable)
        for case in made:
            if goldens.setdefault(case.golden, case) is case:
                cases[case.name] = case
            else:
                faults.append(_second(case, goldens[case.golden]))
        found += [JudgedFinding(finding=fault, state="counts") for fault in faults]
        taken |= {case.program.resolve() for case in made}
    for program, is_named in programs.items():
        if program.resolve() in taken:
            continue
        if not readable.has(program):
            found.append(JudgedFinding(finding=readable.link_fault(shown_path(program, root)), state="counts"))
            continue
        if is_named or cell is not None or expectations(read_program(program))[0]:
            case = _case_of_program(program, root, cell)
            cases[case.name] = case
    kept = [cases[name] for name in sorted(cases) if _is_wanted(name, names)]
    return Collected(cases=tuple(kept), found=tuple(sorted(found, key=lambda one: one.finding.order)))


def _second(case: Case, first: Case) -> Diagnostic:
    """Two cases would have the same name, and overwrite each other's accepted results."""
    others = f"`{Path(first.file).name}`" if first.file != case.file else f"`{first.program.name}` of the same file"
    return Diagnostic(
        code="GS615",
        span=Span(case.file, 1, 1, 1, 2),
        message=f"the case {case.name} keeps its accepted results in `{case.golden.name}`, as that of {others} does",
        hint="rename one of them; only the other one runs",
    )


def is_test_file(path: Path) -> bool:
    return path.name.endswith(SUFFIXES) and path.is_file()


def _is_hidden(path: Path, under: Path) -> bool:
    return any(part.startswith(".") for part in path.relative_to(under).parts)


def _is_wanted(name: str, names: Sequence[str]) -> bool:
    return not names or any(part in name or fnmatch(name, part) for part in names)


def _stem(file: Path) -> str:
    return next(file.name.removesuffix(suffix) for suffix in SUFFIXES if file.name.endswith(suffix))


def _own_program(file: Path) -> Path | None:
    """The program beside a test file: NAME.nc for NAME.test.yaml, or the job NAME.yaml."""
    beside = (file.with_name(_stem(file) + suffix) for suffix in (*PROGRAMS, *JOBS))
    return next((path for path in beside if path.is_file()), None)


def _own_test_file(program: Path) -> Path | None:
    beside = (program.with_name(program.stem + suffix) for suffix in SUFFIXES)
    return next((path for path in beside if path.is_file()), None)


def _program_of_golden(path: Path) -> Path:
    """Named files of accepted results, as by `part*` in a shell, mean their program; any other path means itself."""
    if not path.name.endswith(GOLDEN_SUFFIX):
        return path
    whole = path.with_name(path.name.removesuffix(GOLDEN_SUFFIX))
    beside = [whole, *(whole.with_name(whole.name + suffix) for suffix in (*PROGRAMS, *SUFFIXES))]
    return next((one for one in beside if one.is_file()), path)


def _case_of_program(program: Path, root: Path, cell: Path | None) -> Case:
    name = shown_path(program, root)
    return Case(
        name=name,
        file=name,
        program=program,
        cell=cell,
        golden=program.with_name(program.name + GOLDEN_SUFFIX),
        options=CaseOptions(mode="run" if cell is not None or is_job_file(program) else "lint"),
    )


def _cases_of(
    file: Path,
    name: str,
    content: CaseFile,
    spans: Mapping[At, Span],
    root: Path,
    default_cell: Path | None,
    taken: set[Path],
    readable: Readable,
) -> tuple[list[Case], list[Diagnostic]]:
    """The cases of one test file: one, or one for each program if it names several."""
    stem = _stem(file)
    base = name.removesuffix(file.name) + stem
    span = Span(name, 1, 1, 1, 2)
    faults = []
    programs: list[Path] = []
    several = len(content.program) > 1 or any(_is_pattern(text) for text in content.program)
    for i, text in enumerate(content.program):
        if not readable.has(file.parent / _plain_part(text)):
            faults.append(
                readable.fault(f"the program `{text}`", spans.get(("program", i), spans.get(("program",), span)))
            )
            continue
        matches = (
            sorted(p for p in file.parent.glob(text) if p.is_file()) if _is_pattern(text) else [file.parent / text]
        )
        if not matches or not matches[0].is_file():
            at = spans.get(("program", i), spans.get(("program",), span))
            message = f"the program `{text}` is not there"
            faults.append(Diagnostic(code="GS610", span=at, message=message, hint=_near(file.parent / text)))
            continue
        faults += [readable.link_fault(shown_path(p, root)) for p in matches if not readable.has(p)]
        matches = [p for p in matches if readable.has(p)]
        programs += [p for p in matches if p not in programs and not (_is_pattern(text) and p.resolve() in taken)]
    if not content.program:
        own = _own_program(file)
        if own is None:
            message = f"there is no program `{stem}{PROGRAMS[0]}` beside it"
            faults.append(Diagnostic(code="GS610", span=span, message=message, hint="name it: `program: part.nc`"))
        elif not readable.has(own):
            faults.append(readable.link_fault(shown_path(own, root)))
        else:
            programs.append(own)
    if content.cell is not None and not readable.has(file.parent / content.cell):
        return [], [*faults, readable.fault(f"the cell `{content.cell}`", spans.get(("cell",), span))]
    channels = {channel: file.parent / text for channel, text in content.channels.items()}
    for channel, path in channels.items():
        at = spans.get(("channels", channel), span)
        if not readable.has(path):
            return [], [*faults, readable.fault(f"the program `{content.channels[channel]}`", at)]
        if not path.is_file():
            message = f"the program `{content.channels[channel]}` is not there"
            return [], [*faults, Diagnostic(code="GS610", span=at, message=message, hint=_near(path))]
    cell = default_cell if content.cell is None else file.parent / content.cell
    alone = content.options.mode == "lint" or (programs and all(map(is_job_file, programs)))
    if not alone and (cell is None or not cell.is_file()):
        at = spans.get(("cell",), span)
        missing = "no cell is named" if cell is None else f"the cell `{content.cell or cell}` is not there"
        near = "" if content.cell is None else _near(file.parent / content.cell)
        hint = near or "write `cell: cell.yaml`, or `options: {mode: lint}` for the program alone"
        return [], [*faults, Diagnostic(code="GS610", span=at, message=missing, hint=hint)]
    cases = []
    for program in programs:
        within = program.name if program.parent == file.parent else shown_path(program, file.parent)
        golden = file.with_name(stem + GOLDEN_SUFFIX)
        if several:
            if not readable.has(file.with_name(stem + _GOLDENS)):
                return [], [*faults, readable.link_fault(shown_path(file.with_name(stem + _GOLDENS), root))]
            golden = file.with_name(stem + _GOLDENS) / (within.replace("/", "_").replace("..", "_") + ".json")
        cases.append(
            Case(
                name=f"{base}/{within}" if several else base,
                file=name,
                program=program,
                cell=cell,
                golden=golden,
                options=content.options,
                tolerances={**DEFAULTS, **content.tolerances},
                expect=content.expect,
                channels=channels,
                allow_path=tuple(file.parent / folder for folder in content.allow_path),
                spans={at: place for at, place in spans.items() if at[:1] in (("expect",), ("options",))},
                test_file=file,
            )
        )
    return cases, faults


def _near(path: Path) -> str:
    """A hint at a file of a similar name."""
    if not path.parent.is_dir():
        return f"there is no folder `{path.parent.name}`"
    others = (other for other in path.parent.iterdir() if other.suffix == path.suffix and not is_test_file(other))
    names = sorted(other.name for other in others)
    return suggestion(path.name, names)


def _plain_part(text: str) -> str:
    """A name, or the folders before the first pattern in it."""
    if not _is_pattern(text):
        return text
    parts = PurePosixPath(text).parts
    first = next(i for i, part in enumerate(parts) if _is_pattern(part))
    return str(PurePosixPath(*parts[:first]))


def _is_pattern(text: str) -> bool:
    return any(c in text for c in "*?[")
