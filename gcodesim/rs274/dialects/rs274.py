"""RS274/NGC version 3 (Kramer, Proctor and Messina 2000, NISTIR 6556); later additions are errors."""

from __future__ import annotations

from gcodesim.rs274.dialects.dialect import Dialect
from gcodesim.rs274.dialects.linuxcnc import LINUXCNC, NON_MODAL, SHIFT

# tables 5 and 7 of the report
_MOTIONS = (0, 10, 20, 30, 382, 800, 810, 820, 830, 840, 850, 860, 870, 880, 890)
_MODES = (170, 180, 190, 200, 210, 400, 410, 420, 430, 490, 610, 611, 640, 900, 910, 930, 940, 980, 990)
_OFFSETS = (40, 100, 280, 300, 530, 540, 550, 560, 570, 580, 590, 591, 592, 593, 920, 921, 922, 923)
_G_CODES = frozenset((*_MOTIONS, *_MODES, *_OFFSETS))
_M_CODES = frozenset((0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 30, 48, 49, 60))

RS274 = Dialect(
    name="rs274",
    grammar=LINUXCNC.grammar,
    longest_line=256,
    most_m_codes=LINUXCNC.most_m_codes,
    g_groups={
        code: NON_MODAL if group == SHIFT else group for code, group in LINUXCNC.g_groups.items() if code in _G_CODES
    },
    m_groups={code: group for code, group in LINUXCNC.m_groups.items() if code in _M_CODES},
    users=LINUXCNC.users,
    user_m_codes=range(0),
    letters=frozenset("abcdfghijklmnpqrstxyz"),
    flow_words=False,
    named_parameters=False,
)
