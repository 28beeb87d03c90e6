"""Programs in the style do the same, which `formatted` itself proves, and the style of a style is itself."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))

from corpus import compare, programs, settings_of

from gcodesim.diagnostics import SourceText
from gcodesim.formatting import CannotFormatError, Style, formatted
from gcodesim.regress.programs import programs_in
from gcodesim.rs274 import Settings
from gcodesim.rs274.assumed import assumed_tools
from gcodesim.rs274.dialects import DIALECTS

TOP = Path(__file__).parents[2]
SHIPPED = [path for folder in ("programs", "gcodesim/data") for path in programs_in(TOP / folder)]
DATA = [TOP / "tests/data" / folder for folder in ("programs", "printing", "turning")]
OURS = [*SHIPPED, *(path for folder in DATA for path in programs_in(folder))]
KINDS = [(corpus, kind) for corpus in ("rs274", "fanuc", "differences") for kind in ("valid", "invalid")]
CORPUS = [path for corpus, kind in KINDS for path in programs(kind, corpus)]
STYLES = (Style(), Style(spaces=False, case="lower", code_digits=2, decimals=3), Style(step=10, indent=0))


def settings_by_setup(path: Path) -> Settings:
    return settings_of(path, compare().load(str(path.with_suffix(".json")))["setup"])


def is_formatted(path: Path, settings: Settings, style: Style) -> bool:
    """Whether the program was formatted, and a second time did not change it; false where it has errors."""
    source = SourceText.read(path)
    try:
        once = formatted(source, settings, style)
    except CannotFormatError:
        return False
    twice = formatted(once.program, settings, style)
    assert twice.program.raw == once.program.raw, path.name
    assert len(once.program.lines) == len(source.lines), path.name
    return True


def test_a_part_of_the_corpus():
    done = [is_formatted(path, settings_by_setup(path), STYLES[n % 3]) for n, path in enumerate(CORPUS[::4])]

    assert sum(done) > 60


@pytest.mark.parametrize("dialect", ["linuxcnc", "fanuc", "marlin"])
def test_programs_that_are_shipped(dialect):
    count = 0
    for n, path in enumerate(SHIPPED):
        if len(path.read_bytes()) < 20_000:
            tools = assumed_tools(SourceText.read(path))
            count += is_formatted(path, Settings(dialect=dialect, tool_table=tools, max_blocks=20_000), STYLES[n % 3])

    assert count > (30 if dialect == "linuxcnc" else 5)


@pytest.mark.slow
@pytest.mark.parametrize("style", STYLES)
def test_the_whole_corpus(style):
    done = [is_formatted(path, settings_by_setup(path), style) for path in CORPUS]

    assert sum(done) > 200


@pytest.mark.slow
@pytest.mark.parametrize("dialect", DIALECTS)
def test_all_programs_in_all_dialects(dialect):
    for path in OURS:
        tools = assumed_tools(SourceText.read(path))
        for style in STYLES:
            is_formatted(path, Settings(dialect=dialect, tool_table=tools), style)
