"""Grbl 1.1: a small control. What it does not know is an error, as there; `$` lines are commands to it, no program."""

from __future__ import annotations

from gcodesim.rs274.dialects.dialect import Dialect
from gcodesim.rs274.dialects.linuxcnc import LINUXCNC, NON_MODAL, SHIFT

# the table of supported commands at the head of the control's parser
_MOTIONS = (0, 10, 20, 30, 382, 383, 384, 385, 800)
_MODES = (170, 180, 190, 200, 210, 400, 431, 490, 610, 900, 910, 911, 930, 940)
_OFFSETS = (40, 100, 280, 281, 300, 301, 530, 540, 550, 560, 570, 580, 590, 920, 921)
_G_CODES = frozenset((*_MOTIONS, *_MODES, *_OFFSETS))
_M_CODES = frozenset((0, 1, 2, 3, 4, 5, 7, 8, 9, 30))
_ARCS = frozenset(("g2", "g3"))

GRBL = Dialect(
    name="grbl",
    grammar="grbl",
    longest_line=4096,  # blanks and comments do not count: `grbl.py` looks
    most_m_codes=LINUXCNC.most_m_codes,
    g_groups={
        code: NON_MODAL if group == SHIFT else group for code, group in LINUXCNC.g_groups.items() if code in _G_CODES
    },
    m_groups={code: group for code, group in LINUXCNC.m_groups.items() if code in _M_CODES},
    users={
        "i": _ARCS,
        "j": _ARCS,
        "k": _ARCS,
        "l": frozenset(("g10",)),
        "p": frozenset(("g4", "g10")),
        "r": _ARCS,
    },
    user_m_codes=range(0),
    letters=frozenset("fijklnprstxyz"),
    needs_end=False,
    flow_words=False,
    named_parameters=False,
    computes=False,
    passes_over_far_centres=True,
    arcs_name_axes=True,
    arc_miss=(0.005, 0.5),
    dots_are_lines=True,  # `mc_arc` finds no segment in them, and ends with the line to the target
    g53_under_g91=True,
    first_motion=0,
    executor="gcodesim.rs274.grbl:GrblExecutor",
    only_changes_stop=True,  # steps 4, 7 and 8 of `gc_execute_line` empty the planner only for another S, M3 or M8
    look_ahead=14,  # BLOCK_BUFFER_SIZE is 16 (config.h of 1.1): one place stays free, and one block runs
)
