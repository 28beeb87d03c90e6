"""What a process or tool of a stranger may count on: it declares itself, and everything downstream knows it.

Whole runs: program and cell as texts, the real executor and recorder, the files that they write.
"""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest

from gcodesim.playback import Recording
from gcodesim.playback.quantities import charts_of, quantities_of
from gcodesim.processes import PROCESSES
from gcodesim.report.pack import Pack
from gcodesim.report.page import run_data
from gcodesim.report.summary import summary_rows
from gcodesim.tools import TOOLS
from gcodesim.tools.parts import PARTS, body_part
from tests.contract.newcomers import HERE, LENS, NEW
from tests.physics.runs import Ran, run_texts

STOCK = "stock: {min: [0, 0, -20], max: [60, 40, 0], in: table, material: al6082_t6, resolution: 0.5}"
CELL = f"""
gcodesim: 1
machine: gantry_xyz
frames: {{table: {{in: world, xyz: [400, 300, -400]}}}}
work_offsets: {{G54: {{in: table}}}}
{STOCK}
m_codes: {{M10: {{tool: activate}}, M11: {{tool: deactivate}}}}
simulation: {{rate: 250 Hz}}
"""
NO_STOCK = CELL.replace(STOCK, "")
ACROSS = """G21 G90 G17 G94 G61
T1 M6
G43 H1
G0 X-10 Y20 Z{z}
M10
G1 X70 F3000
M11
G0 Z80
M2
"""


@pytest.fixture(autouse=True)
def newcomers(monkeypatch: pytest.MonkeyPatch) -> None:
    for family, table in ((TOOLS, "tools"), (PROCESSES, "processes"), (PARTS, "parts")):
        for name, place in NEW[table].items():
            monkeypatch.setitem(family._entries, name, f"{HERE}:{place}")


def go(tool: str, z: float, out: Path, *, cell: str = CELL, program: str = ACROSS) -> Ran:
    if not ("lamp" in tool or "gun" in tool):  # others are not switched: nothing would receive it
        cell = "".join(line for line in cell.splitlines(keepends=True) if not line.startswith("m_codes: {M10: {tool"))
        program = program.replace("M10\n", "\n").replace("M11\n", "\n")
    return run_texts(program.format(z=z), f"{cell}tools:\n  1: {tool}\n", out)


def written(out: Path) -> tuple[dict, list[dict[str, str]]]:
    """The only tool of `results.json`, and the rows of `lines.csv`."""
    (tool,) = json.loads((out / "results.json").read_text())["tools"]
    with (out / "lines.csv").open() as file:
        return tool, list(csv.DictReader(file))


def test_a_tool_without_a_process_moves_and_does_nothing(tmp_path: Path) -> None:
    ran = go("{type: pointer, length: 60}", -5, tmp_path)

    assert ran.results.status == "ok" and not ran.bad
    assert ran.stock.removed == 0.0
    assert set(ran.column("/process", "engaged")[:, 0]) == {0.0}
    tool, lines = written(tmp_path)
    assert tool["removed_mm3"] == tool["max_force_N"] == 0.0
    assert list(lines[0])[-1] == "share_at_feed"  # nothing of its own


def test_the_same_without_stock(tmp_path: Path) -> None:
    assert not go("{type: pointer, length: 60}", -5, tmp_path, cell=NO_STOCK).bad


@pytest.mark.parametrize("focus", [1.0, 300.0])
def test_a_laser_acts_far_below_its_tip(focus: float, tmp_path: Path) -> None:
    """Half a millimetre of its beam is in the stock, whatever the distance."""
    program = ACROSS.replace("Z80", f"Z{focus}")
    ran = go(f"{{type: lamp, focus: {focus}, spot: 2, length: 60}}", focus - 0.5, tmp_path, program=program)

    assert not ran.bad
    assert ran.stock.removed == pytest.approx(60e-3 * 2e-3 * 0.5e-3, rel=0.02)
    assert ran.column("/process", "engaged").any()
    assert set(ran.column("/process", "kind")[:, 0]) == {"", "burning"}


def test_a_laser_out_of_reach_is_not_asked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(PROCESSES["burning"], "run", None)  # would raise

    assert go("{type: lamp, focus: 1}", 3, tmp_path).stock.removed == 0.0


def test_own_columns_are_in_every_file(tmp_path: Path) -> None:
    ran = go("{type: lamp, focus: 1, spot: 2}", 0.5, tmp_path)
    tool, lines = written(tmp_path)

    heat = 2e10 * ran.stock.removed
    assert tool["heat_J"] == pytest.approx(heat)
    assert tool["hot_s"] == pytest.approx(80.0 / 50.0, rel=0.05)  # 80 mm at 50 mm/s
    assert "max_dose_J_m2" not in tool  # it is shown in the log alone
    assert list(tool)[-3:] == ["line_of_max_force", "heat_J", "hot_s"]
    assert list(lines[0])[-2:] == ["heat_J", "hot_s"]
    assert sum(float(line["heat_J"]) for line in lines) == pytest.approx(heat, rel=1e-5)
    assert [line["line"] for line in lines if float(line["heat_J"])] == ["6"]

    logged = ran.column("/process", "heat_j", "dose_j_m2", "hot")
    assert logged[-1, 0] == pytest.approx(heat)  # a sum counts since the start
    assert (np.diff(logged[:, 0]) >= 0.0).all()
    assert logged[:, 1].max() > 0.0 and logged[-1, 1] == 0.0  # others are of the step
    assert (ran.column("/process", "max_dose_j_m2")[:, 0] >= logged[:, 1]).all()  # or the greatest since the one before
    assert set(logged[:, 2]) == {0.0, 1.0}
    assert ["T1: heat", f"{heat:.4g} J", "energy that went into the material"] in summary_rows(ran.results)


def test_own_columns_can_be_drawn(tmp_path: Path) -> None:
    go("{type: lamp, focus: 1, spot: 2}", 0.5, tmp_path)
    recording = Recording.open(tmp_path)
    (chart,) = charts_of(recording, ["heat_j"])

    assert {"force", "heat_j", "dose_j_m2", "hot"} <= set(quantities_of(recording))
    assert chart.speaks and chart.curves[0].values.max() > 0.0
    panels = json.loads(recording.log.attachment("layout.json"))["configById"]
    assert [path["value"] for path in panels["Plot!own"]["paths"]] == ["/process.heat_j", "/process.max_dose_j_m2"]
    assert "/process.hot" in [path["value"] for path in panels["StateTransitions!program"]["paths"]]
    page = run_data(recording, "burnt", Pack())
    assert {"Heat j", "Hot"} <= {chart["title"] for chart in page["charts"]}
    assert page["results"]["tools"][0]["heat_J"] > 0.0


def test_misuse_is_told_by_the_process_in_its_own_words(tmp_path: Path) -> None:
    program = ACROSS.replace("G1 X70 F3000", "G0 X70")
    ran = go("{type: lamp, focus: 1, spot: 2}", 0.5, tmp_path, program=program)

    assert ran.misuse == [("GS401", 6)]
    assert "T1 burns 60" in ran.bad[0].message


def test_a_process_on_a_surface_sees_it_and_takes_nothing(tmp_path: Path) -> None:
    ran = go("{type: gun}", 50, tmp_path)
    tool, lines = written(tmp_path)

    area = 2 * (60 * 40 + 60 * 20 + 40 * 20) * 1e-6
    seconds = 80.0 / 50.0
    assert ran.stock.removed == 0.0
    assert tool["film_mm"] == pytest.approx(1e3 * 1e-6 * seconds / area, rel=0.05)
    assert float(lines[-1]["film_mm"]) == pytest.approx(tool["film_mm"], rel=1e-5)  # it stands from then on
    assert ran.column("/process", "film_m")[-1, 0] == pytest.approx(tool["film_mm"] * 1e-3)


def test_a_process_on_a_surface_has_nothing_to_do_without_stock(tmp_path: Path) -> None:
    ran = go("{type: gun}", 50, tmp_path, cell=NO_STOCK)

    assert not ran.bad
    assert written(tmp_path)[0]["film_mm"] == 0.0


def test_a_process_on_bodies_gets_fixtures_and_stocks(tmp_path: Path) -> None:
    fixture = "fixtures: {post: {min: [30, 15, 0], max: [40, 25, 10], in: table}}\n"
    ran = go("{type: feeler}", 15, tmp_path, cell=CELL + fixture)
    tool, _ = written(tmp_path)

    assert not ran.bad
    assert tool["bodies"] == 2.0
    assert tool["max_nearness_mm"] == pytest.approx(15.0, abs=1e-6)  # 5 mm above the post


def test_a_process_on_nothing_sees_every_step(tmp_path: Path) -> None:
    ran = go("{type: watched_mill, diameter: 10, length: 60}", 30, tmp_path, program=ACROSS.replace("M10\n", ""))
    tool, _ = written(tmp_path)

    steps = ran.results.times.total
    assert tool["pictures"] == pytest.approx(np.floor(steps / 0.1), abs=1.0)
    assert tool["way_mm"] > 80.0


def test_a_camera_goes_on_while_its_tool_is_kept_from_cutting(tmp_path: Path) -> None:
    """A probing move takes nothing; what has nothing to take sees it all the same."""
    program = ACROSS.replace("M10\n", "").replace("M11\n", "").replace("G1 X70 F3000", "G0 X30\nG38.2 Z-5 F300")
    ran = go("{type: watched_mill, diameter: 10, length: 60}", 5, tmp_path, program=program)

    assert ran.stock.removed == 0.0
    assert written(tmp_path)[0]["pictures"] == pytest.approx(np.floor(ran.results.times.total / 0.1), abs=1.0)


def test_two_processes_do_what_each_does_alone(tmp_path: Path) -> None:
    program = ACROSS.replace("M10\n", "S8000 M3\n").replace("M11\n", "M5\n").replace("F3000", "F600")
    alone = go("{type: flat_end_mill, diameter: 10, length: 60}", -1, tmp_path / "alone", program=program)
    both = go("{type: watched_mill, diameter: 10, length: 60}", -1, tmp_path / "both", program=program)

    assert both.stock.removed == alone.stock.removed > 0.0
    first, second = written(tmp_path / "alone")[0], written(tmp_path / "both")[0]
    assert {key: second[key] for key in first} == first
    assert list(second)[len(first) :] == ["pictures", "way_mm"]
    assert (tmp_path / "alone" / "stock.stl").read_bytes() == (tmp_path / "both" / "stock.stl").read_bytes()


def test_parts_have_their_own_words_or_some_made_up(tmp_path: Path) -> None:
    fixture = "fixtures: {post: {min: [30, 15, 0], max: [40, 25, 10], in: table}}\n"
    lens = go("{type: lamp, focus: 1}", 5, tmp_path / "lens", cell=CELL + fixture)
    finger = go("{type: pointer, length: 60}", 5, tmp_path / "finger", cell=CELL + fixture)

    assert [(f.code, f.hint) for f in lens.bad] == [("GS304", LENS.hint)]
    assert lens.bad[0].message.startswith("the lens of T1 hits post")
    assert finger.bad[0].message.startswith("the finger of T1 hits post")
    assert body_part("third_hand").words == "the third hand"


def test_the_same_run_gives_the_same_bytes(tmp_path: Path) -> None:
    for name in ("first", "second"):
        go("{type: lamp, focus: 1, spot: 2}", 0.5, tmp_path / name)
    for file in ("run.mcap", "results.json", "lines.csv", "stock.stl"):
        assert (tmp_path / "first" / file).read_bytes() == (tmp_path / "second" / file).read_bytes()


POWERED = """G21 G90 G17 G94 G61
T1 M6
G43 H1
G0 X0 Y0 Z30
{on}
G1 X50 F3000
{more}
G1 X100
{off}
G0 Z80
M2
"""


@pytest.mark.parametrize(
    ("signals", "on", "more", "off"),
    [
        ("{word: S, per: 1 W}", "S20 M3", "S40", "M5"),
        ("{word: S, per: 2 W}", "S10 M4", "S20", "M5"),
        ("{word: M67 E0, per: 1 W}", "M67 E0 Q20", "M67 E0 Q40", "M67 E0 Q0"),
        ("{word: M68 E3, per: 1 kW}", "M68 E3 Q0.02", "M68 E3 Q0.04", "M68 E3 Q0"),
        ("{word: M110, per: 1}", "M110 P20", "M110 P40", "M110 P0"),
    ],
)
def test_the_power_of_a_laser_comes_from_the_words_of_the_cell(
    signals: str, on: str, more: str, off: str, tmp_path: Path
) -> None:
    """A second at 20 W, and one at 40 W; the words that give it count as simulated."""
    signals = signals.replace("per: 1}", "per: 1 W}")
    program = POWERED.format(on=on, more=more, off=off)
    ran = go("{type: beam}", 0, tmp_path, cell=f"{CELL}signals: {{power: {signals}}}\n", program=program)
    tool, lines = written(tmp_path)

    assert not ran.bad and not ran.results.not_simulated
    assert tool["energy_J"] == pytest.approx(60.0, rel=0.05)
    assert tool["max_beam_W"] == pytest.approx(40.0)
    energy = {line["line"]: float(line["energy_J"]) for line in lines}
    assert energy["6"] == pytest.approx(20.0, rel=0.05) and energy["8"] == pytest.approx(40.0, rel=0.05)
    assert energy["4"] == energy["10"] == 0.0


def test_a_signal_that_the_cell_gives_no_word_has_its_default(tmp_path: Path) -> None:
    ran = go("{type: beam}", 0, tmp_path, program=POWERED.format(on="M67 E0 Q20", more="", off=""))

    assert written(tmp_path)[0]["max_beam_W"] == 5.0
    assert [word["word"] for word in ran.results.not_simulated] == ["M67 E0"]


def test_a_newcomer_receives_the_actions_that_it_declares(tmp_path: Path) -> None:
    actions = "m_codes: {M62 P1: {gripper: close}, M63 P1: {gripper: open}, M20: {claw: hold gently}}\n"
    ran = go(
        "{type: claw}", 0, tmp_path, cell=CELL + actions, program=POWERED.format(on="M62 P1", more="M63 P1", off="M20")
    )
    tool, lines = written(tmp_path)

    assert not ran.bad and not ran.results.not_simulated
    closed = {line["line"]: float(line["closed_s"]) for line in lines}
    assert closed["6"] == pytest.approx(1.0, rel=0.05) and closed["8"] == 0.0 and closed["10"] > 0.0
    assert tool["max_grip"] == 1.0
