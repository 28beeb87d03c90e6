"""The two sides of `gcodesim diff`: a program, results, accepted results, the folder of a run, or a log."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from gcodesim.cell import load_cell
from gcodesim.cell.language import settings_of_cell
from gcodesim.diagnostics import SourceText
from gcodesim.diagnostics.show import as_json
from gcodesim.files.output_folder import LOG_NAME, RESULTS_NAME
from gcodesim.jobs.outcome import INTERRUPTED
from gcodesim.jobs.results import SCHEMA as RESULTS
from gcodesim.numbers import read_json
from gcodesim.regress.changes import Comparison
from gcodesim.regress.compare import INCOMPLETE
from gcodesim.regress.facts import Facts, compare, facts_of_run
from gcodesim.regress.golden import SCHEMA as GOLDEN
from gcodesim.regress.golden import GoldenError, read_golden
from gcodesim.regress.motion import steps_of
from gcodesim.regress.programs import programs_in
from gcodesim.regress.tolerance import Tolerances
from gcodesim.rs274 import Settings, interpret, read_program
from gcodesim.rs274.assumed import assumed_tools
from gcodesim.simulation import prepare, run

if TYPE_CHECKING:
    from gcodesim.material.stock import Stock

LOG_SUFFIX: Final = ".mcap"
_STOCK: Final = ".stock"
_PROGRAM: Final = "program.nc"  # their names in a log
_CELL: Final = "cell.yaml"


class SideError(Exception):
    """There is nothing to compare at a path; the text says why."""


def is_output(path: Path) -> bool:
    """Whether a folder holds what `gcodesim run` wrote."""
    return (path / RESULTS_NAME).is_file() or (path / LOG_NAME).is_file()


def members_of(folder: Path) -> dict[str, Path]:
    """What there is to compare in a folder that is not an output itself, by path: outputs of runs, and programs."""
    outputs = [path for path in sorted(folder.rglob("*")) if path.is_dir() and is_output(path)]
    programs = [path for path in programs_in(folder) if not any(path.is_relative_to(output) for output in outputs)]
    return {path.relative_to(folder).as_posix(): path for path in (*outputs, *programs)}


def facts_at(
    path: Path,
    cell: Path | None = None,
    allow_paths: Sequence[Path] = (),
    *,
    out: Path | None = None,
    allow_code: bool = False,
) -> Facts:
    """The facts of one side; a program runs in `cell` when that is given, and leaves its files in `out`.

    SideError when there is nothing at `path`.
    """
    try:
        if path.is_dir():
            return _folder(path)
        if path.suffix.lower() == LOG_SUFFIX or path.name.endswith(f"{LOG_SUFFIX}.part"):
            return _log(path)
        source = read_program(path)
    except FileNotFoundError:
        raise SideError(f"{path} is not there") from None
    except OSError as error:
        raise SideError(f"{path} cannot be read: {error.strerror or error}") from None
    if path.suffix.lower() == ".json":
        return _json(source, path)
    if cell is not None:
        job = prepare(source, load_cell(cell, allow_paths, allow_code=allow_code))
        results, _ = run(job, out)
        return facts_of_run(job, results)
    settings = Settings(tool_table=assumed_tools(source))
    return replace(_read(source, settings, source.name), is_alone=True)


def compare_sides(old: Facts, new: Facts, tolerances: Tolerances) -> Comparison:
    """`compare`, after checking whether the two can be compared; SideError if not."""
    for one, other in ((old, new), (new, old)):
        if one.is_alone and not other.is_alone:
            raise SideError(f"{one.name} is a program alone and {other.name} comes of a cell: name that with --cell")
    statuses = {facts.results.get("status") for facts in (old, new)}
    if (old.steps is None or new.steps is None) and statuses in ({INCOMPLETE}, {None}):
        raise SideError(f"{old.name} and {new.name} have nothing in common that could be compared")
    return compare(old, new, tolerances)


def log_of(path: Path, out: Path) -> Path | None:
    """The log of a side: of an existing run, or of the run into `out`; None without one."""
    if path.is_dir():
        path = path / LOG_NAME
    elif path.suffix.lower() != LOG_SUFFIX:
        path = out / LOG_NAME
    return path if path.is_file() else None


def _read(source: SourceText, settings: Settings, name: str) -> Facts:
    """Motion and findings of a program alone."""
    reading = interpret(source, settings)
    steps = tuple(steps_of(reading))
    return Facts(
        name=name,
        steps=steps,
        results={"findings": [as_json(finding) for finding in reading.findings]},
        sources=reading.sources,
    )


def _json(source: SourceText, path: Path) -> Facts:
    try:
        value = read_json(source.raw)
    except ValueError as error:
        raise SideError(f"{path} cannot be read: {error}") from None
    schema = value.get("schema") if isinstance(value, dict) else None
    if schema == GOLDEN:
        try:
            return read_golden(source, source.name)
        except GoldenError as error:
            raise SideError(f"{path} cannot be read: {error}") from None
    if schema != RESULTS:
        raise SideError(f"{path} holds no results of gcodesim")
    results = _whole(value, path)
    if any(finding.get("code") == INTERRUPTED for finding in results["findings"]):
        raise SideError(f"{path} is of a run that was interrupted: run it again, there is nothing to compare")
    return Facts(name=str(path), results=results)


_PARTS: Final[Mapping[str, type]] = {
    "status": str,
    "findings": list,
    "time": dict,
    "distance": dict,
    "stocks": dict,
    "tools": list,
    "joints": list,
    "not_simulated": list,
}
"""Parts that results have; otherwise a missing part would differ from nothing."""


def _whole(results: Mapping[str, Any], path: Path) -> dict[str, Any]:
    """`results` with all of its parts; SideError names the first one that is missing or of the wrong kind."""
    for key, kind in _PARTS.items():
        if not isinstance(results.get(key), kind):
            raise SideError(f"{path} holds no results of gcodesim: there is no proper `{key}`")
    for key, inner in (
        ("stocks", results["stocks"].values()),
        *((key, results[key]) for key in ("tools", "joints", "findings", "not_simulated")),
    ):
        if not all(isinstance(one, dict) for one in inner):
            raise SideError(f"{path} holds no results of gcodesim: an entry of `{key}` is none")
    return dict(results)


def _folder(path: Path) -> Facts:
    if not is_output(path):
        raise SideError(f"there are no results in {path}")
    log = path / LOG_NAME
    facts = _log(log) if log.is_file() else Facts(name=str(path))
    results = path / RESULTS_NAME
    if results.is_file():
        facts = replace(facts, results=_json(SourceText.read(results), results).results)
    return replace(facts, name=str(path), surfaces=_stocks(path), is_alone=False)


def _stocks(folder: Path) -> Mapping[str, Stock]:
    from gcodesim.material.stock_file import StockFileError, load_stock

    stocks = {}
    for path in sorted(folder.glob(f"*{_STOCK}")):
        try:
            stocks[path.stem] = load_stock(path)
        except StockFileError as error:
            raise SideError(str(error)) from None
    return stocks


def _log(path: Path) -> Facts:
    """Results and programs that a log carries; the motion is read from the programs again, as the log's cell says."""
    from gcodesim.log.logfile import LogFile, LogReadError

    try:
        log = LogFile.open(path)
        held = {name: log.attachment(name) for name in log.attachments}
    except LogReadError as error:
        raise SideError(f"{path} cannot be read: {error}") from None
    if not {RESULTS_NAME, _PROGRAM} & set(held):
        raise SideError(f"{path} holds neither a program nor results: there is nothing to compare")
    results: Mapping[str, Any] = {"status": INCOMPLETE}
    if RESULTS_NAME in held:
        results = _json(SourceText(RESULTS_NAME, held[RESULTS_NAME]), path / RESULTS_NAME).results
    if _PROGRAM not in held:
        return Facts(name=str(path), results=results, remarks=(f"{path} holds no program",))
    ended = () if RESULTS_NAME in held else (f"{path} has no results: only its program is compared",)
    name = log.metadata.get("gcodesim.run", {}).get("program", _PROGRAM)
    with tempfile.TemporaryDirectory() as folder:
        for attached, raw in held.items():
            file = Path(folder) / attached.removeprefix("subprogram/")
            if file.resolve().is_relative_to(Path(folder).resolve()):
                file.parent.mkdir(parents=True, exist_ok=True)
                file.write_bytes(raw)
        program = SourceText(name, held[_PROGRAM], Path(folder))
        settings, remarks = _settings(Path(folder), program)
        facts = _read(program, settings, str(path))
    return replace(facts, results=results, remarks=(*ended, *remarks))


def _settings(folder: Path, program: SourceText) -> tuple[Settings, tuple[str, ...]]:
    """How a log's program is read: as its cell says, if all files that the cell names are in the log."""
    cell = load_cell(folder / _CELL).cell if (folder / _CELL).exists() else None
    if cell is None:
        remark = "the cell's files are not in the log: moves are compared without its tools and work offsets"
        return Settings(tool_table=assumed_tools(program)), (remark,)
    return settings_of_cell(cell)[0], ()
