"""A path written as a program is read back as the same path."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gcodesim
from gcodesim.diagnostics import SourceText
from gcodesim.motion.tool_path import ARC
from gcodesim.rs274 import Settings, lint
from gcodesim.rs274.assumed import assumed_tools
from gcodesim.rs274.dialects import DIALECTS

INCREMENT = {"fanuc": 0.6e-6}
"""[m] to which a control rounds what it reads."""

PROGRAM = """\
G21 G90 G17
T2 M6
S8000 M3
M8
G61
G0 X10 Y5 Z3
G1 Z-1 F200
G64 P0.02
G1 X20.5 A30 F600
G2 X30.5 Y5 I5 J0
G3 X30.5 Y5 Z-3 I-5 J0 P2
G18 G2 X20 Z-2 R9
G19 G3 Y7 Z-4 R8
G17 G1 X0 Y0.123457
M9
M5
M2
"""


def _read(tmp_path: Path, text: str, dialect: str = "linuxcnc") -> gcodesim.ToolPath:
    file = tmp_path / "part.nc"
    file.write_text(text)
    return gcodesim.read(file, Settings(dialect=dialect, tool_table=assumed_tools(SourceText.read(file))))


def test_a_program_is_written_and_read_back(tmp_path: Path) -> None:
    path = _read(tmp_path, PROGRAM)

    again = _read(tmp_path, path.to_gcode())

    assert (path.kind == ARC).sum() == 4
    for column in ("kind", "start", "end", "center", "sweep", "feed", "mode", "tolerance"):
        assert np.allclose(getattr(again, column), getattr(path, column), atol=2e-9), column
    for name in ("tool", "spindle", "flood", "mist"):
        assert [getattr(again.state_of(k), name) for k in range(len(path))] == [
            pytest.approx(getattr(path.state_of(k), name)) for k in range(len(path))
        ]


@pytest.mark.parametrize("dialect", [name for name in DIALECTS if "lathe" not in name])
def test_what_is_written_is_clean_in_its_dialect(dialect: str, tmp_path: Path) -> None:
    line = gcodesim.linear_interpolation([0.01, 0.02, 0.03], [0.04, 0.02, 0.03], 4)
    arc = gcodesim.circular_interpolation([0.04, 0.02, 0.03], [0.05, 0.03, 0.03], 0.02, 6)
    path = gcodesim.ToolPath.from_points((line + arc).positions, feed=0.01)

    text = path.to_gcode(dialect)

    findings = lint(SourceText("part.nc", text.encode()), Settings(dialect=dialect))
    assert [f.message for f in findings if f.level >= f.level.WARNING] == []
    assert np.allclose(_read(tmp_path, text, dialect).positions[1:], path.positions, atol=INCREMENT.get(dialect, 1e-9))


def test_append_and_prepend_join_paths() -> None:
    one = gcodesim.linear_interpolation([0, 0, 0], [1, 0, 0], 3)
    other = gcodesim.linear_interpolation([1, 0, 0], [1, 1, 0], 2)

    assert np.array_equal(one.append(other).positions, other.prepend(one).positions)
    assert len(one.append(other)) == 3


def test_the_process_tool_is_switched_by_the_given_words() -> None:
    path = gcodesim.ToolPath.from_points(np.eye(4, 3), active=[False, True, False], feed=0.01)

    lines = path.to_gcode(switch=("M62 P1", "M63 P1")).splitlines()

    moves = [k for k, line in enumerate(lines) if line.startswith("G1")]
    assert moves[0] < lines.index("M62 P1") < moves[1] < lines.index("M63 P1") < moves[2]


def _leaning() -> gcodesim.ToolPath:
    from gcodesim.frames import Pose

    arc = gcodesim.ToolPath.from_points(np.eye(2, 3), feed=0.01)
    arc.kind[:], arc.sweep[:], arc.normal[:] = ARC, 1.0, (0.0, 0.6, 0.8)
    return arc.transform(Pose.identity())


@pytest.mark.parametrize(
    ("path", "arguments", "text"),
    [
        (gcodesim.ToolPath.from_points(np.eye(2, 3)), {"dialect": "siemens"}, "no dialect `siemens`"),
        (gcodesim.ToolPath.from_points(np.eye(2, 3), active=True), {}, "give the words"),
        (_leaning(), {}, "move 1 is an arc about an axis that leans"),
    ],
)
def test_what_a_program_cannot_say_is_told(path: gcodesim.ToolPath, arguments: dict[str, Any], text: str) -> None:
    with pytest.raises(ValueError, match=text):
        path.to_gcode(**arguments)
