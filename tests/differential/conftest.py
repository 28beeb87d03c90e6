"""LinuxCNC's interpreter, installed when it is missing and may be."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))

from linuxcnc import Interpreter, install


@pytest.fixture(scope="module")
def interpreter() -> Iterator[Interpreter]:
    problem = install()
    assert not problem, problem
    with Interpreter() as running:
        yield running
