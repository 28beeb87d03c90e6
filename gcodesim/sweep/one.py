"""One run of a study, as a worker does it: JSON and files in, JSON and files out."""

from __future__ import annotations

import hashlib
import json
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from datetime import date
from pathlib import Path
from typing import Any, Final

from gcodesim.cell import load_cell
from gcodesim.cell.loader import CellChange
from gcodesim.diagnostics import Diagnostic, Severity, SourceText
from gcodesim.diagnostics.stored import as_stored
from gcodesim.jobs.job import Options
from gcodesim.numbers import clean
from gcodesim.regress.compare import paths_of, value_at
from gcodesim.rs274 import Settings, read_program
from gcodesim.scale.bundle import FileBundle
from gcodesim.setups.results import setups_as_json
from gcodesim.setups.running import How, run_setups
from gcodesim.setups.setup_file import read_job_file
from gcodesim.simulation import check, prepare, run
from gcodesim.sweep.values import deep_values

SOURCE: Final = "study"
"""The name of whatever gives values to a cell, in its results."""

_OF_READER: Final = ("dialect", "block_delete", "max_blocks", "time_limit")
_NOT_SUMMED: Final = ("time", "distance")  # of a job: each set-up has its own
_LISTS: Final = ("probings", "regions")  # of any length, and no figures


def run_one(said: Mapping[str, Any], folder: Path) -> FileBundle:
    """Do a run: `folder` has the files by the names that `said` has for them.

    Back come figures, findings, a hash of the results and, if asked for, all files of the run.
    """
    with tempfile.TemporaryDirectory(prefix="gcodesim-") as spare:
        out = Path(spare) / "out" if said["keep"] else None
        text, findings = _job(said, folder, out) if said.get("job") else _program(said, folder, out)
        files = {}
        if out is not None and out.is_dir():
            files = {path.relative_to(out).as_posix(): path.read_bytes() for path in _files(out)}
    results = json.loads(text)
    row = {
        "status": results["status"],
        "figures": figures_of(results),
        "findings": [as_stored(finding) for finding in findings],
        "results_sha256": hashlib.sha256(text.encode()).hexdigest(),
    }
    return FileBundle(files=files, said=clean(row))


def figures_of(results: Mapping[str, Any]) -> dict[str, float | str | None]:
    """Numbers and words of the results by their paths."""
    kept = {name: value for name, value in results.items() if "setups" not in results or name not in _NOT_SUMMED}
    found = {}
    for path in paths_of(kept):
        if not any(f".{name}." in f".{path}" for name in _LISTS):
            value = value_at(kept, path)
            if value is None or isinstance(value, (int, float, str)):
                found[path] = value
    return found


def _program(said: Mapping[str, Any], folder: Path, out: Path | None) -> tuple[str, Sequence[Diagnostic]]:
    """The text of `results.json`, and the findings."""
    cell = folder / said["cell"]
    change = _changed(said, folder)(
        "", CellChange(source=SourceText(SOURCE, b""), part="vary", folder=folder / said["home"])
    )
    loaded = load_cell(cell, (folder,), allow_code=said["allow_code"], change=change)
    job = prepare(read_program(folder / said["program"]), loaded, _options(said))
    results = check(job) if said["options"].get("mode") == "check" else run(job, out)[0]
    return results.text(), results.findings


def _job(said: Mapping[str, Any], folder: Path, out: Path | None) -> tuple[str, Sequence[Diagnostic]]:
    """The text of `setups.json`, and the findings of all set-ups."""
    path = folder / said["job"]
    job = read_job_file(SourceText.read(path), path, (folder,))
    how = How(
        options=_options(said),
        out=out,
        only_check=said["options"].get("mode") == "check",
        allow_paths=(folder,),
        allow_code=said["allow_code"],
        change=_changed(said, folder),
    )
    done = list(run_setups(job, how))
    text = json.dumps(clean(setups_as_json(done)), indent=1, ensure_ascii=False)
    return f"{text}\n", [finding for one in done for finding in one.findings]


def _changed(said: Mapping[str, Any], folder: Path) -> Callable[[str, CellChange], CellChange]:
    """What the values change in a cell. In a job, a path that begins with a set-up's name is for that one alone."""
    values, setups = list(deep_values(said["values"])), set(said.get("setups", ()))

    def change(setup: str, before: CellChange) -> CellChange:
        own = []
        for value in values:
            if value.path[0] not in setups:
                own.append(value)
            elif value.path[0] == setup:
                own.append(replace(value, path=value.path[1:]))
        return replace(before, values=tuple(own), home=folder / said["home"])

    return change


def _options(said: Mapping[str, Any]) -> Options:
    options = said["options"]
    given = {name: options[name] for name in _OF_READER if name in options}
    presets = {parameter: float(value) for parameter, value in said["parameters"]}

    def settings(known: Settings) -> Settings:
        return replace(known, presets={**known.presets, **presets}, **given)

    return Options(
        world=options.get("world"),
        settings=settings,
        today=None if said["today"] is None else date.fromisoformat(said["today"]),
        fail_on=None if said["fail_on"] == "never" else Severity[said["fail_on"].upper()],
    )


def _files(out: Path) -> list[Path]:
    return sorted(path for path in out.rglob("*") if path.is_file())
