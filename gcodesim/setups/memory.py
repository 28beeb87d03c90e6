"""What a set-up left in its folder the last time, and whether it is still what a run would leave."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Mapping, Sequence
from datetime import date
from pathlib import Path
from typing import Any, Final

from gcodesim.cell import LoadedCell
from gcodesim.diagnostics import Diagnostic, SourceText
from gcodesim.diagnostics.stored import as_stored, from_stored
from gcodesim.files.digest import digest_of_texts
from gcodesim.files.output_folder import LOG_NAME, RESULTS_NAME, SETUP_NAME
from gcodesim.files.whole_file import write_whole
from gcodesim.frozen import frozen
from gcodesim.jobs.job import Job, Options
from gcodesim.numbers import clean, read_json

SCHEMA: Final = "gcodesim-setup/1"


@frozen
class Remembered:
    """A set-up that needs no new run: its results, findings, and those that the cell suppresses, with the reason."""

    results: Mapping[str, Any]
    findings: Sequence[Diagnostic]
    suppressed: Sequence[tuple[Diagnostic, str]]


def key_of(program: SourceText, loaded: LoadedCell, options: Options, said: str, code: str) -> str:
    """A hash of all that is known before a run and decides it.

    `said` is what the command line says about reading, `code` the digest of the code that runs.
    """
    today = options.today or date.today()
    ended = [] if loaded.cell is None else [one.until is not None and today > one.until for one in loaded.cell.suppress]
    asked = repr((options.world, options.fail_on, options.only))
    parts = [code, said, asked, program.name, program.sha256, repr(ended)]
    parts += [f"{file.name} {file.sha256}" for file in loaded.files]
    return digest_of_texts(*parts)


def recall(folder: Path, key: str) -> Remembered | None:
    """What the last run of a set-up left in `folder`; None if it was of other inputs, or a file was changed since."""
    try:
        known = read_json((folder / SETUP_NAME).read_bytes())
        if known["schema"] != SCHEMA or known["key"] != key:
            return None
        if any(_digest(folder / name) != digest for name, digest in {**known["inputs"], **known["files"]}.items()):
            return None
        return Remembered(
            results=read_json((folder / RESULTS_NAME).read_bytes()),
            findings=[from_stored(finding) for finding in known["findings"]],
            suppressed=[(from_stored(finding), reason) for finding, reason in known["suppressed"]],
        )
    except (OSError, ValueError, LookupError, TypeError, AttributeError):  # whatever somebody has put there
        return None


def remember(
    folder: Path,
    key: str,
    job: Job,
    findings: Sequence[Diagnostic],
    suppressed: Sequence[tuple[Diagnostic, str]],
) -> None:
    """Keep beside the files of a run which inputs they came of. Subprograms and files of channels are told by name."""
    own = {*job.loaded.sources, *job.options.sources, job.program.name}  # these are in the key
    read = [
        os.path.relpath(source.folder / source.name, folder)
        for each in job.all
        for source in each.sources.values()
        if source.folder is not None and source.name not in own
    ]
    files = sorted(path.name for path in folder.iterdir() if path.is_file() and path.name != SETUP_NAME)
    content = {
        "schema": SCHEMA,
        "key": key,
        "inputs": {name: _digest(folder / name) for name in sorted(set(read))},
        "files": {name: _digest(folder / name) for name in files},
        "findings": [as_stored(finding) for finding in findings],
        "suppressed": [[as_stored(finding), reason] for finding, reason in suppressed],
    }
    write_whole(folder / SETUP_NAME, (json.dumps(clean(content), indent=1, ensure_ascii=False) + "\n").encode())


def forget(folder: Path) -> None:
    """From now on the files of the folder change."""
    (folder / SETUP_NAME).unlink(missing_ok=True)


def _digest(path: Path) -> str:
    try:
        if path.name == LOG_NAME:  # large, and read by nobody here
            return str(path.stat().st_size)
        return hashlib.sha256(path.read_bytes()).hexdigest()
    except OSError:
        return "absent"
