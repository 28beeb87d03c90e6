"""Fanuc 0i/30i for milling, as data. What its blocks mean lives in `gcodesim/rs274/fanuc/`, file by file:

| Question | Fanuc | where |
| --- | --- | --- |
| structure of a file | `%`, O numbers or names, several programs in one file or folder | `program.py`, `names.py` |
| statements | which lines of a program are no blocks of words | `statements.py` |
| going elsewhere | GOTO, IF, WHILE DO END, M98, M99 P, G65, G66, G66.1, G67 | `flow.py` |
| arguments of macros | lists I and II | `arguments.py` |
| variables | vacant ones, levels, system variables | `variables.py`, `expressions.py` |
| work systems | external offset, G54.1, G52 and G92 apart, G68 | `control.py`, `offsets.py` |
| work on a rotary table | G54.2: its zero goes along | `fixture.py` |
| tilted planes | G68.2 in five forms, G53.1 | `tilted.py` |
| directions of the tool | I J K under G43.5 | `vectors.py` |
| figures | G51 scaling, G51.1 mirror image | `figure.py` |
| polar coordinates | G16: radius and angle of the plane | `polar.py` |
| devices outside | POPEN, DPRNT, PCLOS | `external.py` |
| codes of Haas | G154 P is G54.1 P; G103, G187 are read; pockets are refused | `offsets.py`, `execute.py` |
| cutter compensation | corners by intersection, start-up and cancel of type A and B | `compensation.py` |
| | change of side, blocks without a move | `compensation.py` |
| | G39: a corner is rounded | `corner_circle.py` |
| | places narrower than the tool | `interference.py` |
| corners | `,C` and `,R` between moves | `corners.py` |
| drilling | heights pass on, K repeats, X Y before R | `cycles.py` |
| a block from first to last | ignored words are warned of, not refused | `execute.py` |
"""

from __future__ import annotations

import re

from gcodesim.canon.systems import ADDITIONAL, MOST_ADDITIONAL
from gcodesim.rs274.dialects.dialect import Dialect, Figure, Lathe, SystemBlock, Unsimulated
from gcodesim.rs274.dialects.linuxcnc import (
    CANCEL,
    CHANGING,
    COMPENSATION,
    COOLANT,
    DISTANCE,
    FEED_MODE,
    LENGTH,
    MOTION,
    NON_MODAL,
    OVERRIDE,
    PATH,
    PLANE,
    RETRACT,
    SPINDLE,
    SPINDLE_MODE,
    STOPPING,
    SYSTEM,
    UNITS,
)

# groups that RS274 does not have
SCALING, MIRROR, TURN, MACRO, STROKE, POLAR, WORK_FIXTURE = 21, 22, 23, 24, 25, 26, 27

_NEAR = 48  # additional systems that every control has
NEAR_SYSTEMS = SystemBlock(range(ADDITIONAL + 1, ADDITIONAL + 1 + _NEAR), 7001)  # G54.1 P1 to P48
FAR_SYSTEMS = SystemBlock(range(ADDITIONAL + 1 + _NEAR, ADDITIONAL + 1 + MOST_ADDITIONAL), 14961)  # P49 to P300

FIXTURES = range(5521, 5521 + 8 * 20, 20)  # where the offsets of G54.2 P1 to P8 begin

CYCLES = (730, 740, 760, 810, 820, 830, 840, 850, 860, 870, 880, 890)

_G_GROUPS = {
    NON_MODAL: (
        *(40, 50, 51, 80, 90, 100, 110, 270, 280, 290, 300, 310, 390, 520, 530, 531, 600, 650, 920, 921, 1030),
        1870,
    ),
    MOTION: (0, 10, 20, 30, 330, *CYCLES),
    CANCEL: (800,),
    PLANE: (170, 180, 190),
    DISTANCE: (900, 910),
    FEED_MODE: (930, 940, 950),
    UNITS: (200, 210),
    COMPENSATION: (400, 410, 420),
    LENGTH: (430, 434, 435, 440, 490),
    RETRACT: (980, 990),
    SYSTEM: (540, 541, 1540, 550, 560, 570, 580, 590),
    PATH: (610, 620, 630, 640),
    SPINDLE_MODE: (960, 970),
    SCALING: (500, 510),
    MIRROR: (501, 511),
    TURN: (680, 682, 690),
    MACRO: (660, 661, 670),
    STROKE: (220, 230),
    POLAR: (150, 160),
    WORK_FIXTURE: (542,),
}

# what such controls have, too, and would make other moves than those written
_UNSIMULATED = {
    22: "involute interpolation",
    32: "involute interpolation",
    23: "exponential interpolation",
    33: "exponential interpolation",
    24: "a circle in space",
    34: "a circle in space",
    61: "a spline",
    62: "a NURBS curve",
    70: "hypothetical axis interpolation",
    71: "cylindrical interpolation",
    1070: "cylindrical interpolation",
    106: "tool retract and recover",
    120: "a round pocket (Haas)",
    130: "a round pocket (Haas)",
    700: "holes on a circle (Haas)",
    710: "holes on an arc (Haas)",
    720: "holes on a line (Haas)",
    1500: "a pocket (Haas)",
    121: "polar coordinate interpolation",
    131: "polar coordinate interpolation",
    1120: "polar coordinate interpolation",
    1130: "polar coordinate interpolation",
    311: "multi-stage skip",
    370: "tool length measurement",
    401: "normal direction control",
    411: "normal direction control",
    421: "normal direction control",
    412: "cutter compensation for five axes",
    422: "cutter compensation for five axes",
    431: "tool length along the tool's axis",
    450: "tool offset along the axes",
    460: "tool offset along the axes",
    470: "tool offset along the axes, or the engraving of a text (Haas)",
    480: "tool offset along the axes",
    491: "tool centre point control",
    544: "workpiece setting error compensation",
    683: "a tilted working plane",
    684: "a tilted working plane",
    721: "figure copy",
    722: "figure copy",
    811: "chopping",
    842: "rigid tapping in the older form",
    843: "rigid tapping in the older form",
}

_M_GROUPS = {
    STOPPING: (0, 1, 2, 30, 98, 99),
    CHANGING: (6,),
    SPINDLE: (3, 4, 5, 19, 29),
    COOLANT: (7, 8, 9),
    OVERRIDE: (48, 49),
}

_SKIPPED = (
    Unsimulated(("G5", "G5.1", "G8", "G103", "G187"), "GS913", "the planned motion always looks ahead"),
    Unsimulated(("G22", "G23"), "GS913", "the cell's `travel` is checked instead"),
    Unsimulated(("G27",), "GS913", "the move is made; whether it ends at the reference point is not looked at"),
    Unsimulated(("G31",), "GS913", "what the probe meets is not looked at: it trips at the end of the move"),
    Unsimulated(("G60",), "GS913", "the move goes straight to its end, without the overrun"),
    Unsimulated(("G10",), "GS913", "the blocks up to G11 are passed over: they write data of the control"),
    Unsimulated(("G30",), "GS913", "where that reference point lies is not known: the machine goes home"),
    Unsimulated(
        ("POPEN", "PCLOS", "BPRNT", "SETVN"), "GS912", "nothing is sent; texts of DPRNT stand in the log of a run"
    ),
    Unsimulated(("G54.2",), "GS913", "how a table takes the zero of the work along is known only with a cell"),
    Unsimulated(("I J K",), "GS913", "how rotary axes bring the tool along a vector is known only with a cell"),
    Unsimulated(("G53.1",), "GS913", "how rotary axes bring the tool upright to the plane is known only with a cell"),
    Unsimulated(
        ("G43.4", "G43.5"),
        "GS913",
        "the length counts along Z: no rotary axis of the machine has a place (`at`)",
    ),
)

_LATHE = Lathe(
    words=re.compile(
        rb"(?<![A-Z])(G(?:50[ \t]*S|7[0-3][ \t]*[PQUW]|28[ \t]*[UW]|76[ \t]*P[ \t]*[0-9]{5,6}(?![0-9.]))"
        rb"|G(?:92[ \t]*S|7[789][ \t]*[XZ]|33(?![0-9.])(?![^\r\n]*K)(?=[^\r\n]*F))"
        rb"|T(0[1-9])\2(?![0-9.]))"
    ),
    changes_by_m6=False,
    refused=True,
    code="GS016",
    message="this is a program for a lathe (`{word}`, and never Y): the Fanuc dialect here is that of milling",
    hint="`--dialect fanuc_lathe` reads it, `fanuc_lathe_b` code system B: X is a diameter there, T0101 a tool",
)

FANUC = Dialect(
    name="fanuc",
    grammar="fanuc",
    longest_line=4096,
    most_m_codes=3,
    g_groups={code: group for group, codes in _G_GROUPS.items() for code in codes},
    m_groups={code: group for group, codes in _M_GROUPS.items() for code in codes},
    users={},  # a control passes over a word that nothing uses; `execute.py` warns
    user_m_codes=range(10, 1000),
    open_m_codes=True,
    unsimulated=_UNSIMULATED,
    letters=frozenset((*"abcdefghijklmpqrstuvwxyz", ",c", ",r")),
    named_parameters=False,
    first_motion=0,
    executor="gcodesim.rs274.fanuc.executor:FanucExecutor",
    statements=True,
    skipped=_SKIPPED,
    figures={
        SCALING: Figure(510, "G51", "G50"),
        MIRROR: Figure(511, "G51.1", "G50.1"),
        TURN: Figure(680, "G68", "G69"),
    },
    shift_off="G92 or G52 of zero",
    lathe=_LATHE,
    grammar_parts="gcodesim.rs274.fanuc.statements:MacroParts",
    further_systems=(NEAR_SYSTEMS, FAR_SYSTEMS),
    turned_systems=False,
    options={
        "decimal_point": ("calculator", "increments"),  # X10 is 10 mm, or 10 increments of 0.001 mm
        "compensation_start": ("A", "B"),  # how cutter compensation starts and is cancelled
        "compensation_blocks": ("3", "4", "5", "6", "7", "8"),  # how many blocks are read while it is on
    },
    rapids_stand=True,
    h0_cancels=True,
)
