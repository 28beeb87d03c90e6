"""Small programs in which gcodesim once differed from LinuxCNC's interpreter, with what that makes of them.

Found by the differential test (`tests/differential`), which also adds to them: `keep.py`.
"""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))

from corpus import differences, programs

PROGRAMS = [*programs("valid", "differences"), *programs("invalid", "differences")]


def test_there_are_some():
    assert len(PROGRAMS) >= 10


@pytest.mark.parametrize("program", PROGRAMS, ids=lambda p: p.stem)
def test_program(program):
    assert differences(program) == []
