"""Marlin 2.1 (marlinfw.org/meta/gcode), and the printers' controls that differ from it in some words.

Klipper (docs/G-Codes.md) and RepRapFirmware (docs.duet3d.com, G-code dictionary). Blocks of a printer mean something
else than those of RS274, so tables of codes are of no use here: `rs274/marlin` reads them.
"""

from __future__ import annotations

from dataclasses import replace

from gcodesim.rs274.dialects.dialect import Dialect, Unsimulated

_SKIPPED = (
    Unsimulated(
        ("M104", "M109", "M140", "M190", "M141", "M191", "M116", "M105", "M155", "M303", "M301", "M304", "G10"),
        "GS921",
        "heating takes no time here, and nothing depends on temperature",
    ),
    Unsimulated(("M106", "M107", "M710"), "GS922", "nothing that is simulated depends on a fan"),
    Unsimulated(
        ("M73", "M117", "M118", "M75", "M76", "M77", "M300", "M31", "M78", "M70"),
        "GS923",
        "what a display shows changes no motion",
    ),
    Unsimulated(("M17", "M18", "M84"), "GS907", "motors without current move nothing here"),
    Unsimulated(("M400",), "GS907", "what follows begins after the moves before it anyway"),
    Unsimulated(
        ("M92", "M420", "M425", "M572", "M851", "M900"),
        "GS907",
        "the printer is taken to go where the program says, and to lay what it says",
    ),
    Unsimulated(("macro",), "GS924", "only the printer's configuration says what it does"),
)

MARLIN = Dialect(
    name="marlin",
    grammar="rs274",
    longest_line=1 << 20,
    most_m_codes=1,
    g_groups={},
    m_groups={},
    users={},
    user_m_codes=range(0),
    letters=frozenset("xyz"),
    open_m_codes=True,
    needs_end=False,
    flow_words=False,
    named_parameters=False,
    computes=False,
    turned_systems=True,
    executor="gcodesim.rs274.marlin.executor:PrinterExecutor",
    skipped=_SKIPPED,
    prints=True,
)
KLIPPER = replace(MARLIN, name="klipper")
REPRAPFIRMWARE = replace(
    MARLIN,
    name="reprapfirmware",
    skipped=(
        Unsimulated(("M98",), "GS907", "the macro's file is not in the folder of the program, which is the card here"),
        Unsimulated(("M208",), "GS907", "the machine of the cell says how far its axes go"),
        *_SKIPPED,
    ),
)
