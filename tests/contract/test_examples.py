"""Every finding has an example, and the example prints what its transcript says.

After a change of messages: `python scripts/make_examples.py`, and read the difference.
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from gcodesim.cli.examples import FOLDER, transcript_of
from gcodesim.diagnostics import codes
from gcodesim.diagnostics.examples import command_of, example_of

NONE = {
    "GS015": "needs a thousand faults; tests/programs/test_bounds.py has them",
    "GS205": "an arm goes past a joint limit rather than flip; only a path with no neighbouring solution at all does",
    "GS208": "the reader refuses such blocks (GS107, GS108); only a path built in Python has a feed of zero",
    "GS728": "depends on whether pybullet is installed",
    "GS731": "depends on whether pybullet is installed",
    "GS612": "depends on whether pybullet is installed",
    "GS613": "a fault of gcodesim itself",
    "GS614": "needs a damaged log; tests/cli/test_views.py has some",
    "GS631": "names a file by its absolute path; tests/unit/sweep/test_prepared.py has it",
    "GS632": "needs workers that die; tests/unit/scale/test_crew.py has them",
    "GS751": "needs two runs at once; tests/cli/test_output_folder.py has them",
    "GS590": "takes 10,000 readings; tests/unit/observation/test_sensors_in_a_run.py has it with fewer",
    "GS616": "needs somebody who stops a run; tests/cli/test_interrupts.py does",
}
TRANSCRIPTS = sorted(FOLDER.glob("GS*.txt"))


def test_every_code_has_an_example_or_a_reason() -> None:
    known = {code.code for code in codes()}

    assert {path.stem for path in TRANSCRIPTS} == known - set(NONE)
    assert set(NONE) <= known


@pytest.mark.parametrize("path", TRANSCRIPTS, ids=lambda path: path.stem)
def test_example_prints_what_its_transcript_says(path: Path, tmp_path: Path) -> None:
    text = path.read_text(encoding="utf-8")

    assert transcript_of(command_of(text), tmp_path) == text
    assert re.search(rf"^ *\S+: (error|warning|note) {path.stem}: \S", text, re.MULTILINE)


@pytest.mark.parametrize("path", TRANSCRIPTS, ids=lambda path: path.stem)
def test_example_is_small(path: Path) -> None:
    example = example_of(path.stem)

    assert example is not None and example.files
    assert all(len(text.splitlines()) <= 25 for text in example.files.values())
    assert example.printed.count("\n") <= 20


def test_no_file_lies_about() -> None:
    """Every file is an example's own, or named in a command or a cell of several."""
    files = [path for path in FOLDER.iterdir() if path.is_file()]  # Python leaves byte code beside what it runs
    texts = "\n".join(path.read_text(encoding="utf-8") for path in files)
    for path in files:
        assert path.stem.startswith("GS") or path.name in texts, path.name
        if path.stem.startswith("GS"):
            assert (FOLDER / f"{path.name[:5]}.txt").is_file(), path.name
