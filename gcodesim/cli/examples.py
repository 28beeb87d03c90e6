"""Runs the examples of findings, for `scripts/make_examples.py` and the tests."""

from __future__ import annotations

import contextlib
import io
import os
import re
import shutil
from importlib.resources import files
from pathlib import Path
from typing import Final

from gcodesim.cli.main import main

FOLDER: Final = Path(str(files("gcodesim"))) / "data" / "examples"
_THEN: Final = " && gcodesim "
_VERDICT = re.compile(r"\S+: (?:\d+|no) errors?, |(?:\d+|none) failed|\S+: \d+ runs")


def transcript_of(command: str, folder: Path) -> str:
    """`$ gcodesim COMMAND` and the findings that it prints, run in `folder` beside copies of all example files.

    Of several commands (`run … && gcodesim ros …`) what the last one prints is shown.

    Everything from the verdict on is left out, since it does not belong to the finding.
    """
    for path in FOLDER.iterdir():
        if path.is_file() and path.suffix != ".txt":
            shutil.copy(path, folder / path.name)
    before, out = Path.cwd(), io.StringIO()
    os.chdir(folder)
    try:
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(io.StringIO()):
            *before_it, last = command.split(_THEN)
            for one in before_it:
                main(one.split())
            out.seek(0)
            out.truncate()
            main(last.split())
    finally:
        os.chdir(before)
    lines: list[str] = []
    for line in out.getvalue().splitlines():
        if _VERDICT.match(line):
            break
        lines.append(line)
    while lines and not lines[-1]:
        del lines[-1]
    return "\n".join([f"$ gcodesim {command}", *lines]) + "\n"
