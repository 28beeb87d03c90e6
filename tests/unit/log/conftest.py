"""The made-up run and the checker of logs, as modules."""

import importlib.util
import sys
from pathlib import Path

import pytest

from gcodesim.log import LogWriter

HERE = Path(__file__).parent


def load(path):
    spec = importlib.util.spec_from_file_location(f"log_tests_{path.stem}", path)
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="session")
def run():
    """`synthetic.py`: `run.write(path)` makes a complete log."""
    return load(HERE / "synthetic.py")


@pytest.fixture(scope="session")
def checker():
    """`check_log.py`, which checks a log against the table of topics and the rules of the viewer."""
    return load(HERE.parents[1] / "data" / "log" / "check_log.py")


@pytest.fixture
def complaints(checker):
    return lambda path: checker.check_log(str(path))[0]


@pytest.fixture
def new_log(run):
    """Opens logs of the made-up run, which are given up when the test does not close them."""
    opened = []

    def start(path, **changes):
        opened.append(LogWriter(path, run.description(**changes)))
        return opened[-1]

    yield start
    for log in opened:
        log.abandon()
