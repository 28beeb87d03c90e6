"""Python that a cell names: what it adds where it is allowed, and that nothing but the user lets it in."""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

import gcodesim
from gcodesim.cell import load_cell
from gcodesim.cli.folder_tools import FolderTools
from gcodesim.cli.main import main
from gcodesim.family import take_back

OWN = """\
from pathlib import Path
from typing import ClassVar

from gcodesim.actions import WordAction, Wrong
from gcodesim.controllers import CONTROLLERS
from gcodesim.frozen import frozen
from gcodesim.processes.materials import Material
from gcodesim.sensors.outputs import Numbers
from gcodesim.sensors.sensor import Sensor
from gcodesim.tools.tool import Tool

Path("ran").write_text("yes")


@frozen
class Pin(Tool):
    kind: ClassVar[str] = "own_pin"


@frozen(slots=False, eq=False)
class Idle(CONTROLLERS["flexible"]):
    kind: ClassVar[str] = "own_idle"


@frozen
class Clock(Sensor):
    kind: ClassVar[str] = "own_clock"
    outputs: ClassVar = {"ticks": Numbers}
    sees: ClassVar[bool] = False

    def read(self, sight):
        return {"ticks": Numbers(values={"ticks": 7.0})}


class Count(WordAction):
    kind: ClassVar[str] = "own_count"

    def __init__(self):
        self.calls = 0

    def act(self, moment):
        self.calls += 1
        said = f"call {self.calls}, X {1000 * moment.X_WT[0, 3] - X0:.3f}, P {moment.p}, T{moment.tool}"
        return Wrong(said) if moment.q == 1 else said


X0 = 300.0
FOAM = Material(id="own_foam", name="foam", law=None, source="here")
"""
CELL = """\
gcodesim: 1
code: own.py
robots: {arm: {model: kuka_kr10_r1100_2, home: [0, -90, 90, 0, 90, 0], controller: {type: own_idle}}}
frames: {table: {in: world, xyz: [600, 0, 300]}}
stock: {plate: {box: [40, 30, 10], in: table, resolution: 1, zero: top-front-left, material: own_foam}}
work_offsets: {G54: {in: table}}
orientation: {tool_axis: -Z of G54}
tools: {1: {type: own_pin, length: 50 mm}}
sensors: {clock: {type: own_clock, trigger: M110}}
m_codes: {M150: {call: own_count}}
simulation: {world: kinematic, rate: 500 Hz}
"""
PROGRAM = """\
G21 G90 G54
T1 M6
G43 H1
G0 X0 Y0 Z20
M150 P4
G4 P0.1
M110
G1 X10 F3000
G4 P0.2
M150
M150 Q1
M2
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    monkeypatch.chdir(tmp_path)
    for name, text in (("own.py", OWN), ("cell.yaml", CELL), ("part.nc", PROGRAM)):
        (tmp_path / name).write_text(text)
    for name in [name for name in sys.modules if name.startswith("gcodesim_own_")]:
        del sys.modules[name]  # so that each test sees whether the file is run
    yield tmp_path
    take_back()  # what programs in Python were lent; later tests do not know it


def _ran(folder: Path) -> bool:
    return (folder / "ran").exists()


def test_what_a_file_adds_works_where_it_is_allowed(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "part.nc", "--cell", "cell.yaml", "--allow-code", "--format", "json"]) == 1
    results = json.loads(capsys.readouterr().out)
    said = {(f["code"], f["line"]): f["message"] for f in results["findings"] if f["code"].startswith("GS58")}

    assert _ran(folder)
    assert re.fullmatch(r"own_count: call 1, X (299.9|300.0)\d*, P 4.0, T1", said["GS580", 5])
    assert re.fullmatch(r"own_count: call 2, X (309.9|310.0)\d*, P None, T1", said["GS580", 10])
    assert said["GS581", 11].startswith("own_count: call 3, X 3")
    assert "own.py" in json.dumps(results["inputs"])


def test_a_command_adds_nothing_to_the_next(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["cell", "validate", "cell.yaml", "--allow-code"]) == 0
    assert main(["list", "tools"]) == 0
    assert "own_pin" not in capsys.readouterr().out
    assert main(["cell", "validate", "cell.yaml", "--allow-code"]) == 0


def test_the_callers_of_python_may_allow_it(folder: Path) -> None:
    cell = gcodesim.load_cell("cell.yaml", allow_code=True)
    assert cell.tools[1].kind == "own_pin"
    assert cell.material(cell.stocks["plate"]).name == "foam"  # type: ignore[union-attr]
    with gcodesim.open_cell("cell.yaml", allow_code=True) as session:
        session.tool(1).couple(session.robot())
        session.step(0.1)
        assert session.sensor("clock").read()["ticks"].values == {"ticks": 7.0}  # type: ignore[attr-defined]
    assert gcodesim.simulate("part.nc", "cell.yaml", allow_code=True).status == "findings"


@pytest.mark.parametrize("command", ["run", "check", "lint", "canon"])
def test_no_command_runs_it_unasked(folder: Path, command: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([command, "part.nc", "--cell", "cell.yaml"]) == 1
    told = capsys.readouterr()
    assert "GS736" in told.out + told.err and "--allow-code" in told.out + told.err
    assert not _ran(folder)


def test_other_doors_are_shut(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The cell alone, another cell's keys, a test file, a program, the session, a service: none starts Python."""
    (folder / "part.test.yaml").write_text("program: part.nc\ncell: cell.yaml\nallow_code: true\n")
    (folder / "keys.yaml").write_text("allow_code: true\nrun_code: true\n" + CELL)
    (folder / "said.nc").write_text(
        "(allow-code)\n#<_allow_code> = 1\n(PY, open('ran','w'))\n;py,open('ran','w')\n" + PROGRAM
    )
    assert main(["test", "part.test.yaml"]) != 0
    assert main(["cell", "validate", "keys.yaml"]) == 1
    assert main(["cell", "show", "cell.yaml"]) != 0
    assert main(["run", "said.nc", "--cell", "cell.yaml"]) == 1
    assert main(["place", "part.nc", "--cell", "cell.yaml"]) != 0
    for call in (gcodesim.load_cell, gcodesim.open_cell):
        with pytest.raises(gcodesim.InputError, match="GS736"):
            call("cell.yaml")  # type: ignore[operator]
    assert gcodesim.simulate("part.nc", "cell.yaml").status != "ok"
    capsys.readouterr()
    served = FolderTools(folder)
    for answer in (
        served.check("part.nc", "cell.yaml"),
        served.run("part.nc", "cell.yaml"),
        served.lint("part.nc", "cell.yaml"),
    ):
        assert answer["exit_status"] == 1 and "GS736" in json.dumps(answer)
    assert served.check("part.nc", "--allow-code")["exit_status"] == 2
    assert served.check("--allow-code", "cell.yaml")["exit_status"] == 2
    assert not _ran(folder)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("1 / 0\n", "ZeroDivisionError in line 1"),
        ("\ndef f(:\n", "SyntaxError in line 2"),
        ("raise SystemExit(0)\n", "SystemExit in line 1"),
        ("x = 1\n", "it adds none of tools, processes"),
        (
            "from gcodesim.tools.tool import Tool\nclass A(Tool):\n    kind = 'drill'\n",
            "`drill` is a name that gcodesim has",
        ),
    ],
)
def test_a_file_that_cannot_be_used_is_told(folder: Path, text: str, said: str) -> None:
    (folder / "own.py").write_text(text)
    loaded = load_cell(folder / "cell.yaml", allow_code=True)
    (finding,) = [each for each in loaded.findings if each.code == "GS737"]
    assert said in finding.message and finding.span.line == 2


def test_two_files_do_not_share_a_name(folder: Path) -> None:
    (folder / "more.py").write_text(OWN + "# another\n")
    (folder / "cell.yaml").write_text(CELL.replace("code: own.py", "code: [own.py, more.py]"))
    (finding,) = [each for each in load_cell(folder / "cell.yaml", allow_code=True).findings if each.code == "GS737"]
    assert "own.py beside it adds" in finding.message


def test_a_file_outside_the_folder_of_the_cell_is_refused(folder: Path) -> None:
    (folder / "inner").mkdir()
    (folder / "inner" / "cell.yaml").write_text(CELL.replace("own.py", "../own.py"))
    codes = {each.code for each in load_cell(folder / "inner" / "cell.yaml", allow_code=True).findings}
    assert "GS715" in codes and not _ran(folder)
