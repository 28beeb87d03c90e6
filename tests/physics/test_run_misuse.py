"""What no machinist would do, in whole runs: one finding an event, in the right line, and none in clean programs."""

from __future__ import annotations

import pytest

from tests.physics.runs import Ran, run_texts

GANTRY = """
gcodesim: 1
machine: gantry_xyz
work_offsets: {G54: {in: world, xyz: [400, 300, -200]}}
stock: {min: [0, 0, -20], max: [50, 40, 0], in: G54, material: al6082_t6, resolution: 0.5}
"""

ARM = """
gcodesim: 1
robots:
  arm: {model: kuka_kr10_r1100_2, home: [0, -90, 90, 0, 90, 0], payload: {mass: 3 kg, xyz: [0, 0, 60]}}
frames:
  table: {in: world, xyz: [550, 0, 300]}
work_offsets: {G54: {in: table}}
orientation: {tool_axis: -Z of G54, spin: free}
stock: {min: [0, 0, -20], max: [50, 40, 0], in: table, material: al6082_t6, resolution: 0.5}
"""

TOOLS = """
tools:
  1: {type: flat_end_mill, diameter: 8, flutes: 3, length: 40, flute_length: 10, holder: {diameter: 30, length: 40}}
  2: {type: drill, diameter: 5, length: 60}
  3: {type: ball_end_mill, diameter: 6, length: 95}
magazine: {in: world, xyz: [200, 500, 300], pitch: 80, change_time: 1 s}
"""

HEAD = "G21 G90 G17 G94 G61\nT1 M6\nG43 H1\nS6000 M3\n"  # four lines
TAIL = "G0 Z30\nM5\nM2\n"


def misuse(program: str, cell: str = GANTRY, world: str = "kinematic") -> Ran:
    return run_texts(program, cell + TOOLS, world=world)


# program, findings as (code, line)
FAULTS = {
    "rapid through stock": (HEAD + "G0 X-10 Y20 Z10\nG0 Z-2\nG0 X60\n" + TAIL, [("GS401", 7)]),
    "rapid down into stock": (HEAD + "G0 X25 Y20 Z10\nG0 Z-2\nG1 X30 F600\n" + TAIL, [("GS401", 6)]),
    "two rapids, one event": (HEAD + "G0 X-10 Y20 Z10\nG0 Z-2\nG0 X25\nG0 Y50\n" + TAIL, [("GS401", 7)]),
    "spindle never started": (
        "G21 G90 G61\nT1 M6\nG43 H1\nG0 X-10 Y20 Z10\nG0 Z-2\nG1 X60 F600\n" + TAIL,
        [("GS501", 6)],
    ),
    "spindle stopped on the way": (
        HEAD + "G0 X-10 Y20 Z10\nG0 Z-2\nG1 X20 F600\nM5\nG1 X60\nG0 Z30\nM2\n",
        [("GS501", 9)],
    ),
    "reversed": (
        "G21 G90 G61\nT1 M6\nG43 H1\nS6000 M4\nG0 X-10 Y20 Z10\nG0 Z-2\nG1 X60 F600\n" + TAIL,
        [("GS502", 7)],
    ),
    "shank": (HEAD + "G0 X-10 Y-3 Z10\nG0 Z-12\nG1 X60 F600\n" + TAIL, [("GS404", 7)]),
    "holder": (
        HEAD + "G0 X-30 Y-14 Z10\nG0 Z-41\nG1 X20 F600\nG1 X-30\n" + TAIL,
        [("GS405", 7)],
    ),
    "inside at M6": (
        HEAD + "G0 X25 Y20 Z10\nG1 Z-2 F300\nG1 X30\nM5\nT3 M6\nS6000 M3\nG1 X35\nG0 Z30\nM5\nM2\n",
        [("GS403", 9), ("GS162", 11)],
    ),
    "spindle left on": (HEAD + "G0 X0 Y0 Z30\nM2\n", [("GS503", 6)]),
}


HASTY = """
gcodesim: 1
machine:
  axes:
    X: {travel: [0, 800], speed: 60 m/min, acceleration: ACCELERATION m/s^2}
    Y: {travel: [0, 800], speed: 60 m/min, acceleration: ACCELERATION m/s^2}
    Z: {travel: [-400, 0], speed: 60 m/min, acceleration: ACCELERATION m/s^2}
work_offsets: {G54: {in: world, xyz: [400, 300, -200]}}
stock: {min: [0, 0, -20], max: [50, 40, 0], in: G54, material: al6082_t6, resolution: 0.5}
"""


@pytest.mark.parametrize("acceleration", [1, 1500, 100_000])
@pytest.mark.parametrize("gap", [0, 0.05, 0.2])
def test_a_rapid_close_above_the_stock_is_no_fault(acceleration: float, gap: float) -> None:
    """The shank begins 10 mm above the tip, whatever the steps of a move that is over in a moment."""
    ways = f"G0 X-10 Y10 Z20\nG0 Z{gap}\nG0 X60 Y30\nG0 X-10 Z{gap}\nG0 Z9\nG1 Z{gap} F6000\nG0 X20 Y20\n"
    assert misuse(HEAD + ways + TAIL, HASTY.replace("ACCELERATION", str(acceleration))).misuse == []


@pytest.mark.parametrize("name", FAULTS)
def test_misuse_is_one_finding_in_its_line(name: str) -> None:
    program, wanted = FAULTS[name]
    ran = misuse(program)
    assert ran.misuse == wanted


@pytest.mark.parametrize(("beside", "wanted"), [(6.6, []), (6.0, [("GS405", 7)])])
def test_a_conical_holder_reaches_as_far_as_it_is_wide_there(beside: float, wanted: list[tuple[str, int]]) -> None:
    """Its nose is 1 mm below the top of the block, where the cone has grown from 6 to 6.5 mm."""
    slim = TOOLS.replace("{diameter: 30, length: 40}", "{diameter: 12, upper_diameter: 40, length: 28}")
    program = HEAD + f"G0 X-30 Y-{beside} Z10\nG0 Z-41\nG1 X20 F600\nG1 X-30\n" + TAIL
    assert run_texts(program, GANTRY + slim, world="kinematic").misuse == wanted


@pytest.mark.parametrize("world", ["kinematic", "bullet"])
@pytest.mark.parametrize("name", ["rapid through stock", "spindle never started", "shank"])
def test_misuse_on_an_arm(name: str, world: str) -> None:
    program, wanted = FAULTS[name]
    ran = misuse(program, ARM, world)
    assert ran.misuse == wanted


def test_a_tool_that_starts_inside_the_stock_cuts_nothing() -> None:
    """The machine's home puts the tool through the block, its edges below; going up takes nothing away."""
    cell = GANTRY.replace("gantry_xyz", "{model: gantry_xyz, home: [425 mm, 320 mm, -195 mm]}")
    cell = cell.replace("max: [50, 40, 0]", "max: [50, 40, 20]")
    ran = misuse("G21 G90\nT1 M6\nG0 Z40\nM2\n", cell)
    assert ran.misuse == [("GS402", 2), ("GS307", 3)]  # the nose of the spindle is in it, too
    assert ran.stock.removed == 0.0


def test_a_process_left_on() -> None:
    ran = run_texts(
        "G21 G90 G61\nT1 M6\nG43 H1\nG0 X10 Y20 Z3\nM10\nG1 X40 F3000\nM2\n",
        GANTRY + "tools:\n  1: {type: extruder, bead_width: 6, bead_height: 3, length: 100}\n"
        "m_codes:\n  M10: {tool: activate}\n  M11: {tool: deactivate}\n",
    )
    assert ran.misuse == [("GS504", 7)]


POCKET = "".join(
    f"G0 X15 Y15 Z2\nG1 Z{-2 * layer} F300\nG1 X35 F900\nG1 Y25\nG1 X15\nG1 Y15\nG1 Y20\nG1 X35\n" for layer in (0.5, 1)
)
CLEAN = {
    "pocket": HEAD + POCKET + TAIL,
    "peck drilling": "G21 G90 G61\nT2 M6\nG43 H2\nS3000 M3\nG0 X0 Y0 Z20\n"
    "G99 G83 X10 Y10 Z-12 R2 Q3 F200\nX40\nY30\nX10\nG80\nG98 G81 X25 Y20 Z-5 R2 F200\nG80\n" + TAIL,
    "contour": HEAD
    + "G0 X-10 Y-10 Z5\nG0 Z-4\nG1 G41 D1 X-4 Y0 F900\nG1 Y36\nG40\nG0 Z20\n".replace("G41 D1 ", "").replace(
        "G40\n", ""
    )
    + "G0 X-5 Y-12\nG0 Z-8\nG1 Y45 F900\nG1 X55\nG1 Y-5\nG1 X-12\nG0 Z5\nG0 X10 Y10\nG1 Z-3 F200\nG2 I8 F700\n"
    + TAIL,
    "ball": "G21 G90 G64 P0.02\nT3 M6\nG43 H3\nS9000 M3\nG0 X5 Y5 Z5\nG1 Z-1 F300\n"
    + "".join(f"G1 X45 F1200\nG1 Y{5.5 + 1.0 * i}\nG1 X5\nG1 Y{6.0 + 1.0 * i}\n" for i in range(4))
    + TAIL,
}


@pytest.mark.parametrize("world", ["kinematic", "bullet"])
@pytest.mark.parametrize("cell", [GANTRY, ARM], ids=["gantry", "arm"])
@pytest.mark.parametrize("name", CLEAN)
def test_clean_programs_raise_no_alarm(name: str, cell: str, world: str) -> None:
    ran = misuse(CLEAN[name], cell, world)
    assert not ran.bad
    assert ran.stock.removed > 0.0


def test_a_rapid_back_into_a_hole_that_a_soft_arm_pecks_is_no_cut() -> None:
    """Less than a cell: the arm stands a micrometre elsewhere than when it drilled, and short steps bound little."""
    program = "G21 G90 G17 G94\nT2 M6\nG43 H2\nS3000 M3\nG0 X7.3 Y12.1 Z5\nG98 G83 Z-18 R1 Q3 F300\nG80\n" + TAIL
    fine = ARM.replace("resolution: 0.5", "resolution: 0.25") + "simulation: {rate: 2 kHz}\n"
    assert misuse(program, fine).bad == []


CHANGES = {
    "at once": "T3 M6\nG43 H3\n",
    "late": "T3 M6\nG4 P0.1\nG43 H3\n",
    "twice": "T2 M6\nG43 H2\nT3 M6\nG43 H3\n",
}


@pytest.mark.parametrize("change", CHANGES)
@pytest.mark.parametrize("instant", [False, True])
@pytest.mark.parametrize(("height", "stands"), [(10, True), (20, False)])
def test_a_longer_tool_stands_where_it_is_put_in(change: str, instant: bool, height: int, stands: bool) -> None:
    """T3 is 15 mm longer than T1 with its holder; what comes into force then is a name of the place, no way to it."""
    tools = TOOLS.replace(", change_time: 1 s", "") if instant else TOOLS
    ran = run_texts(HEAD + f"G0 X25 Y20 Z{height}\n" + CHANGES[change] + "G0 Z40\n" + TAIL, GANTRY + tools)

    assert ran.stock.removed == 0.0
    assert ran.misuse == ([("GS403", 6 + 2 * (change == "twice"))] if stands else [])


AXIAL = {
    "drill": "diameter: 6",
    "spot_drill": "diameter: 8",
    "step_drill": "tip_diameter: 5, step_length: 6, diameter: 8",
    "countersink": "diameter: 10",
    "reamer": "diameter: 6",
    "tap": "diameter: 6, pitch: 1",
    "flat_end_mill": "diameter: 6",
}


@pytest.mark.parametrize("kind", AXIAL)
def test_a_drill_that_mills_sideways_is_told(kind: str) -> None:
    """Fed across at depth; down and up again, also along the same wall, is what it is for."""
    cell = GANTRY + f"tools:\n  1: {{type: {kind}, {AXIAL[kind]}, length: 60}}\n"
    begin, end = "G21 G90\nT1 M6\nG43 H1\nS2000 M3\nG0 X10 Y15 Z3\nG1 Z-4 F200\n", "G1 Z3 F600\nM5\nM2\n"
    sideways = [code for code, _ in run_texts(begin + "X25 F300\n" + end, cell).misuse if code == "GS409"]
    assert sideways == ([] if kind == "flat_end_mill" else ["GS409"])
    assert run_texts(begin + "Z-2\nZ-6 F200\n" + end, cell).misuse == []
