"""Wrong use of tools from a program: each is a finding at its line, and what is right has none."""

from __future__ import annotations

import pytest

from tests.physics.runs import run_texts

CELL = """\
gcodesim: 1
machine: gantry_xyz
frames: {table: {in: world, xyz: [400, 300, -300]}}
work_offsets: {G54: {in: table}}
STOCK
tools:
  1: {type: flat_end_mill, diameter: 8, flutes: 3, length: 60}
  2: {type: extruder, bead_width: 6, bead_height: 3, length: 60}
  3: {type: extruder, bead_width: 6, bead_height: 3, length: 60, flow: 160 mm^3/s}
  4: {type: finger_gripper, stroke: 60, force: 40 N, friction: 0.5, length: 60}
  5: {type: suction_gripper, length: 90, cups: [{at: [0, 0], diameter: 40}], vacuum: 60 kPa}
  6: {type: laser, power: 100 W, diameter: 2, absorptivity: 0.8, specific_energy: 2 J/mm^3, length: 60}
  7: {type: jet, diameter: 2, removal_rate: 8 mm^3/s, length: 60}
  9: {type: camera, width: 40, height: 30, length: 60}
  10: {type: welding_torch, wire_diameter: 1.2, wire_speed: 8 m/min, voltage: 24 V, current: 200 A, length: 60}
m_codes:
  M10: {tool: activate}
  M11: {tool: deactivate}
  M12: {gripper: close}
  M13: {gripper: open}
  M110: {camera: shoot}
signals:
  flow: {word: M67 E0, per: 1 mm^3/s}
  abrasive: {word: M67 E1, per: 1 %}
  power: {word: M67 E2, per: 1 W}
  wire_speed: {word: M67 E3, per: 1 m/min}
"""
STOCK = "stock: {box: [60, 40, 5], in: table, zero: top-front-left, material: al6082_t6, resolution: 1}"
NO_WORDS = CELL[: CELL.index("signals:")]


def at(number: int, words: str, cell: str = NO_WORDS, stock: str = STOCK) -> tuple[str, str]:
    """A program whose fourth line is the first of `words`, with this tool, and its cell."""
    program = f"G21 G90 G94\nT{number} M6\nG43 H{number}\n{words}\nM2\n"
    return program, cell.replace("STOCK", stock)


def started(words: str) -> tuple[str, str]:
    """A program without a tool; its second line is the first of `words`."""
    return f"G21 G90 G94\n{words}\nM2\n", NO_WORDS.replace("STOCK", STOCK)


PASS = "G0 X5 Y20 Z{z}\nM10\nG1 X55 F600\nM11\nG0 Z40"

USES = {
    "activate without a tool": (started("M10\nG4 P1\nM11"), [("GS507", 2)]),
    "activate a mill": (at(1, "M10\nG0 Z20\nM11"), [("GS507", 4)]),
    "activate a gripper": (at(4, "M10\nG0 Z20\nM11"), [("GS507", 4)]),
    "close a mill": (at(1, "M12\nG0 Z20\nM13"), [("GS507", 4)]),
    "shoot without a camera": (at(1, "G0 Z20\nM110"), [("GS507", 5)]),
    "fingers grip nothing": (at(4, "G0 Z90\nM12\nG4 P1\nM13"), [("GS561", 5)]),
    "cups grip nothing": (at(5, "G0 Z90\nM12\nG4 P1\nM13"), [("GS561", 5)]),
    "a bead in the air": (at(2, PASS.format(z=30)), [("GS520", 6)]),
    "a bead in the air over the edge": (at(2, "G0 X5 Y0 Z30\nM10\nG1 X55 F600\nM11"), [("GS520", 6), ("GS522", 6)]),
    "a pump that lays in the air": (at(3, "G0 X5 Y20 Z30\nM10\nG4 P1\nM11\nG0 Z40"), [("GS519", 6)]),
    "a bead beside the bed": (at(2, "G0 X-90 Y20 Z3\nM10\nG1 X-60 F600\nM11"), [("GS522", 6)]),
    "a pump beside the bed": (at(3, "G0 X-90 Y20 Z3\nM10\nG1 X-60 F600\nM11"), [("GS522", 6)]),
    "an arc on nothing": (at(10, PASS.format(z=30)), [("GS526", 6)]),
    "a beam on nothing": (at(6, "G0 X-90 Y20 Z0\nM10\nG1 X-60 F600\nM11"), [("GS541", 6)]),
    "a laser on in a rapid": (at(6, "G0 X5 Y20 Z0\nM10\nG0 X55\nM11"), [("GS540", 6)]),
    "a jet on in a rapid": (at(7, "G0 X5 Y20 Z0\nM10\nG0 X55\nM11"), [("GS540", 6)]),
    "an arc on in a rapid": (at(10, "G0 X5 Y20 Z0\nM10\nG0 X55\nM11"), [("GS525", 6)]),
    "a bead in a rapid": (at(2, "G0 X5 Y20 Z3\nM10\nG0 X55\nM11"), [("GS539", 6)]),
    "a laser never on": (at(6, "G0 X5 Y20 Z0\nG1 X55 F600"), [("GS542", 5)]),
    "an extruder never on": (at(2, "G0 X5 Y20 Z3\nG1 X55 F600"), [("GS542", 5)]),
    "a torch never on": (at(10, "G0 X5 Y20 Z0\nG1 X55 F600"), [("GS542", 5)]),
    "left on": (at(2, "G0 X5 Y20 Z3\nM10\nG1 X55 F600"), [("GS504", 7)]),
    "changed while on": (at(2, "G0 X5 Y20 Z3\nM10\nG1 X55 F600\nT1 M6\nG43 H1\nG0 Z20\nM11"), [("GS514", 7)]),
    "a bead without a bed": (at(2, PASS.format(z=3), stock=""), [("GS508", 6)]),
    "a laser without work": (at(6, PASS.format(z=0), stock=""), [("GS508", 6)]),
    "an arc without work": (at(10, PASS.format(z=0), stock=""), [("GS508", 6)]),
    "a flow below nothing": (at(3, "M67 E0 Q-5\n" + PASS.format(z=3), CELL), [("GS509", 4)]),
    "more abrasive than all": (at(7, "M67 E1 Q250\n" + PASS.format(z=0), CELL), [("GS509", 4)]),
    "more power than there is": (at(6, "M67 E2 Q250\n" + PASS.format(z=0), CELL), [("GS544", 7)]),
    "fingers that follow a spindle that stands": (
        at(4, "S1\nG0 Z90\nM12\nG4 P1\nM13", CELL + "  opening: {word: S, per: 1}\n"),
        [("GS549", 6), ("GS561", 6)],
    ),
    "a pump without flow": (at(3, PASS.format(z=3), CELL), [("GS549", 5)]),
    "an arc without wire": (at(10, "M67 E3 Q0\n" + PASS.format(z=0), CELL), [("GS549", 6)]),
    "a wire that goes back": (at(10, "M67 E3 Q-5\n" + PASS.format(z=0), CELL), [("GS509", 4)]),
}

RIGHT = {
    "a bead on the bed": at(2, PASS.format(z=3)),
    "a cut": at(6, PASS.format(z=0)),
    "a hole before each cut": at(6, "G0 X5 Y20 Z0\nM10\nG4 P0.2\nG1 X20 F600\nM11\nG0 X30\nM10\nG4 P0.2\nG1 X50\nM11"),
    "dots between rapids": at(6, "G0 X5 Y20 Z0\nM10\nG4 P0.2\nM11\nG0 X30\nM10\nG4 P0.2\nM11\nG0 Z40"),
    "tacks between rapids": at(10, "G0 X5 Y20 Z0\nM10\nG4 P0.2\nM11\nG0 X30\nM10\nG4 P0.2\nM11\nG0 Z40"),
    "a gripper that is opened first": at(4, "G0 Z90\nM13\nG4 P0.1\nG0 X20"),
    "fingers that follow a spindle that turns": at(
        4, "S1 M3\nG0 Z90\nM13\nG4 P0.1\nM5", CELL + "  opening: {word: S, per: 1}\n"
    ),
    "a pump with flow for a part of its way": at(
        3, "M67 E0 Q0\n" + PASS.format(z=3).replace("F600", "F600\nM67 E0 Q160\nG1 X58"), CELL
    ),
    "a picture": at(9, "G0 Z90\nM110"),
}


def told(program: str, cell: str) -> list[tuple[str, int]]:
    found = run_texts(program, cell).results.findings
    return [(f.code, f.span.line) for f in found if f.span.file != "cell.yaml"]


@pytest.mark.parametrize("use", USES)
def test_wrong_use_is_a_finding_with_its_line(use: str) -> None:
    (program, cell), expected = USES[use]
    assert told(program, cell) == expected


@pytest.mark.parametrize("use", RIGHT)
def test_right_use_has_none(use: str) -> None:
    assert told(*RIGHT[use]) == []


@pytest.mark.parametrize(
    "tool",
    [
        "extruder, bead_width: 6, bead_height: 3, flow: 200 mm^3/s",
        "laser, diameter: 0.5 mm, power: 2 kW",
        "welding_torch, wire_speed: 8 m/min",
    ],
)
def test_what_does_nothing_to_the_work_of_a_lathe_is_told(tool: str) -> None:
    """A lathe keeps a profile of revolution, in which a bead or a kerf has no place."""
    cell = (
        "gcodesim: 1\nmachine: lathe_xz\nstock: {cylinder: [36 mm, 60 mm], zero: top-center}\n"
        f"tools: {{1: {{type: {tool}, length: 60}}}}\n"
        "m_codes: {M10: {tool: activate}, M11: {tool: deactivate}}\n"
    )
    ran = run_texts("G21 G90 G94\nT1 M6\nG0 X60 Z5\nG1 X38 Z-5 F500\nM10\nG1 Z-20\nM11\nG0 X100\nM2\n", cell)

    (told,) = [f for f in ran.results.findings if f.code == "GS435"]
    assert told.message.startswith("T1 is moved but does nothing to the work") and told.span.line == 4
    assert ran.stock.removed == ran.stock.deposited == 0.0
