"""Every program of the conformance corpus: same events, or refused at the same line."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))

from corpus import differences, programs


def test_the_corpus_is_complete():
    assert len(programs("valid")) >= 203
    assert len(programs("invalid")) >= 146


@pytest.mark.parametrize("program", programs("valid"), ids=lambda p: p.stem)
def test_valid_program(program):
    assert differences(program) == []


@pytest.mark.parametrize("program", programs("invalid"), ids=lambda p: p.stem)
def test_invalid_program(program):
    assert differences(program) == []
