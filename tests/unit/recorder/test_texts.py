"""What a program says, in the log of its run."""

from pathlib import Path

import gcodesim
from gcodesim.log.reader import read_messages

CELL = "gcodesim: 1\nmachine: gantry_xyz\nsimulation: {world: kinematic}\n"
PROGRAM = """G21 G90
#1=3.5
(MSG, hello)
(DEBUG, at #1)
G0 X10
(PRINT, %.1f x#<_x>)
(LOGOPEN, ../log.txt)
(PROBEOPEN ../points.txt)
G4 P0.5
(LOG, rested %d#1)
G0 X0
(LOGCLOSE)
(PROBECLOSE)
M2
"""


def test_texts_are_events_at_their_time_and_nothing_is_written_elsewhere(tmp_path: Path) -> None:
    folder = tmp_path / "here"
    folder.mkdir()
    (folder / "cell.yaml").write_text(CELL)
    (folder / "part.nc").write_text(PROGRAM)
    gcodesim.simulate(folder / "part.nc", folder / "cell.yaml", folder / "out")

    log = folder / "out" / "run.mcap"
    events = [(m.code, m.file, m.line, m.message, t) for t, m in read_messages(log, "/event")]
    said = [event for event in events if not event[0].startswith("GS")]
    assert [event[:4] for event in said[1:-1]] == [
        ("message", "part.nc", 3, "hello"),
        ("message", "part.nc", 4, "at 3.500000"),
        ("print", "part.nc", 6, "x10.0"),
        ("log", "part.nc", 10, "rested 4"),
    ]
    times = [event[4] for event in said[1:-1]]
    assert times[0] == times[1] == 0 < times[2] and times[3] - times[2] == 500_000_000
    assert sorted(path.name for path in tmp_path.rglob("*") if path.is_file() and path.parent != folder / "out") == [
        "cell.yaml",
        "part.nc",
    ]
