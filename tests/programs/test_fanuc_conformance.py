"""Every program of the Fanuc corpus: same events at level process, or refused."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))

from corpus import differences, programs


def test_the_corpus_is_complete():
    assert len(programs("valid", "fanuc")) >= 39
    assert len(programs("invalid", "fanuc")) >= 9


@pytest.mark.parametrize("program", programs("valid", "fanuc"), ids=lambda p: p.stem)
def test_valid_program(program):
    assert differences(program, "process") == []


@pytest.mark.parametrize("program", programs("invalid", "fanuc"), ids=lambda p: p.stem)
def test_invalid_program(program):
    assert differences(program, "process") == []
