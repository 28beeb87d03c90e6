"""RS274 as LinuxCNC 2.9 speaks it."""

from __future__ import annotations

import re

from gcodesim.rs274.dialects.dialect import Dialect, Lathe

# modal groups as in the LinuxCNC user manual, "G-code overview"; the numbers serve only as names
NON_MODAL, MOTION, PLANE, DISTANCE, CENTRE, FEED_MODE, UNITS, COMPENSATION, LENGTH = 0, 1, 2, 3, 4, 5, 6, 7, 8
CANCEL_CYCLES = 800  # G80, which may stand twice in a block
RETRACT, SYSTEM, PATH, SPINDLE_MODE, DIAMETER, CANCEL, SHIFT = 10, 12, 13, 14, 15, 16, 17

CONTOUR_CYCLES = (700, 710, 711, 712, 720, 721, 722)

_G_GROUPS = {
    NON_MODAL: (40, 53, 100, 280, 281, 300, 301, 520, 530, 920),
    SHIFT: (921, 922, 923),
    MOTION: (
        *(0, 10, 20, 30, 50, 51, 52, 330, 331, 382, 383, 384, 385),
        *CONTOUR_CYCLES,
        *(730, 740, 760, 810, 820, 830, 840, 850, 860, 870, 880, 890),
    ),
    CANCEL: (CANCEL_CYCLES,),  # ends a cycle, and may share a block with another motion
    PLANE: (170, 180, 190),
    DISTANCE: (900, 910),
    CENTRE: (901, 911),
    FEED_MODE: (930, 940, 950),
    UNITS: (200, 210),
    COMPENSATION: (400, 410, 411, 420, 421),
    LENGTH: (430, 431, 432, 490),
    RETRACT: (980, 990),
    SYSTEM: (540, 550, 560, 570, 580, 590, 591, 592, 593),
    PATH: (610, 611, 640),
    SPINDLE_MODE: (960, 970),
    DIAMETER: (70, 80),
}

STOPPING, OUTPUT, CHANGING, SPINDLE, COOLANT, OVERRIDE, USER = 4, 5, 6, 7, 8, 9, 10

_M_GROUPS = {
    STOPPING: (0, 1, 2, 30, 60, 98, 99),
    OUTPUT: (62, 63, 64, 65, 66, 67, 68),
    CHANGING: (6, 61),
    SPINDLE: (3, 4, 5, 19, 70, 71, 72, 73),
    COOLANT: (7, 8, 9),
    OVERRIDE: (48, 49, 50, 51, 52, 53),
}

_ARCS = {"g2", "g3"}
_CYCLES = {"g73", "g74", "g81", "g82", "g83", "g84", "g85", "g86", "g87", "g88", "g89"}
_COMPENSATION = {"g41", "g41.1", "g42", "g42.1"}

_CONTOURS = {"g70", "g71", "g71.1", "g71.2", "g72", "g72.1", "g72.2"}

_USERS = {
    "d": _COMPENSATION | _CONTOURS | {"g96"},
    "$": {"m3", "m4", "m5", "m19", "m51", "g33", "g33.1", "g76"},  # or S
    "e": _CONTOURS | {"g33", "g33.1", "g76", "m66", "m67", "m68"},
    "h": {"g43", "g43.2", "g76"},
    "i": _CONTOURS | _ARCS | {"g5", "g5.1", "g10", "g33.1", "g76", "g87"},
    "j": _ARCS | {"g5", "g5.1", "g10", "g33.1", "g76", "g87"},
    "k": _ARCS | {"g33", "g33.1", "g76", "g87"},
    "l": (_CYCLES - {"g74"}) | _COMPENSATION | {"g10", "g76", "g5.2", "m66", "m98"},
    "p": _CONTOURS
    | _ARCS
    | {"g4", "g10", "g5", "g5.2", "g64", "g74", "g76", "g82", "g84", "g86", "g88", "g89"}
    | {"m19", "m50", "m51", "m52", "m53", "m62", "m63", "m64", "m65", "m66", "m98", "user"},
    "q": _CONTOURS | {"g5", "g10", "g64", "g73", "g76", "g83", "m19", "m61", "m66", "m67", "m68", "user"},
    "r": _CONTOURS | _ARCS | _CYCLES | {"g10", "g64", "g41.1", "g42.1", "g76", "m19"},
}

_LATHE = Lathe(
    words=re.compile(rb"(?<![A-Z0-9])(G0?(?:[78]|7[0-2](?:\.[12])?|33|76|96))(?![0-9.])"),
    changes_by_m6=True,
    refused=False,
    code="GS916",
    message="this is a program for a lathe (`{word}`, and never Y): the moves are right, the work stands still",
    hint="a cell with `machine: lathe_xz` turns the work; in any other look at paths and times only",
)

LINUXCNC = Dialect(
    name="linuxcnc",
    grammar="rs274",
    longest_line=252,
    most_m_codes=4,
    g_groups={code: group for group, codes in _G_GROUPS.items() for code in codes},
    m_groups={code: group for group, codes in _M_GROUPS.items() for code in codes},
    users={letter: frozenset(names) for letter, names in _USERS.items()},
    user_m_codes=range(100, 200),
    letters=frozenset("abcdefghijklmpqrstuvwxyz@^$"),
    lathe=_LATHE,
    unsimulated={62: "a NURBS curve with knots and weights (LinuxCNC 2.10)"},
    # the remaps of its five-axis configurations: kinematics with the tip, and without (manual, "Switchable Kinematics")
    tip_m_codes={428: True, 429: False},
    look_ahead=50,  # ARC_BLEND_OPTIMIZATION_DEPTH as it is delivered (ini-config.adoc, initraj.cc)
    corners_count=True,
)
