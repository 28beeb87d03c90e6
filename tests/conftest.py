"""A small finished run, which tests of everything that reads logs share."""

import os
import re

import pytest

from tests.cluster import Cluster

os.environ.pop("FORCE_COLOR", None)  # build servers set it; tests compare text without colour

CONFORMANCE = re.compile(
    r"/test_(?P<fanuc>fanuc_)?conformance\.py::test_(in)?valid_program\[(?P<feature>[a-z0-9]+?)(_|\])"
)

PROGRAM = """(a slot of two depths and a hole)
G21 G90 G17 G94
T1 M6
G43 H1
S8000 M3
G0 X10 Y10
G0 Z2
G1 Z-1 F400
G1 X30
G1 Z-2
G1 X10
G0 Z20
M8
T2 M6
G43 H2
S8000 M3
G0 X40 Y15
G0 Z2
G1 Z-3 F300
G4 P0.5
G0 Z20
M9
M5
M2
"""
CELL = """gcodesim: 1
machine: gantry_xyz
stock: {box: [60, 40, 12], zero: top-front-left, material: al6082_t6, resolution: 1}
magazine: {change_time: 4 s}
tools:
  1: {type: flat_end_mill, diameter: 6 mm}
  2: {type: flat_end_mill, diameter: 10 mm}
simulation: {world: kinematic}
"""


@pytest.fixture(scope="session")
def standing(tmp_path_factory):
    """A cluster of Dask with two workers that serves many tests; none may end what it finds there."""
    one = Cluster(folder=tmp_path_factory.mktemp("standing"))
    one.start(workers=2)
    yield one
    one.stop()


@pytest.fixture(scope="session")
def slot_folder(tmp_path_factory):
    """The output folder of a run that cuts a slot with one tool and a hole with another."""
    import gcodesim

    folder = tmp_path_factory.mktemp("slot")
    (folder / "slot.nc").write_text(PROGRAM)
    (folder / "cell.yaml").write_text(CELL)
    gcodesim.simulate(folder / "slot.nc", folder / "cell.yaml", folder / "out")
    return folder / "out"


@pytest.fixture
def slot(slot_folder):
    """That run, opened anew."""
    from gcodesim.playback import Recording

    return Recording.open(slot_folder)


def pytest_terminal_summary(terminalreporter):
    _conformance(terminalreporter)
    _not_run(terminalreporter)


def _not_run(terminalreporter):
    """Tests that something of this machine keeps from running, by name."""
    skipped = [report for report in terminalreporter.stats.get("skipped", []) if not hasattr(report, "wasxfail")]
    if skipped:
        terminalreporter.write_sep("-", f"{len(skipped)} not run")
    for report in skipped:
        reason = report.longrepr[2] if isinstance(report.longrepr, tuple) else str(report.longrepr)
        terminalreporter.write_line(f"{report.nodeid}: {reason.removeprefix('Skipped: ')}")


def _conformance(terminalreporter):
    """How many programs of the conformance corpora pass, by feature: the first part of their names."""
    counts = {}
    for outcome in ("passed", "failed"):
        for report in terminalreporter.stats.get(outcome, []):
            found = CONFORMANCE.search(report.nodeid)
            if found and report.when == "call":
                corpus = "fanuc" if found["fanuc"] else "rs274"
                good, bad = counts.get((corpus, found["feature"]), (0, 0))
                counts[corpus, found["feature"]] = (good + (outcome == "passed"), bad + (outcome == "failed"))
    if counts:
        terminalreporter.write_sep("-", "conformance by feature")
    for corpus in sorted({corpus for corpus, _ in counts}):
        shown = [f"{name} {g}/{g + b}" for (of, name), (g, b) in sorted(counts.items()) if of == corpus]
        terminalreporter.write_line(f"{corpus}: " + ", ".join(shown))
