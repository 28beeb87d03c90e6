"""What distinguishes one control's language from another's, as data."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import field
from typing import NamedTuple

from gcodesim.frozen import frozen

# G codes are written times ten: G54 is 540, G59.3 is 593


class Unsimulated(NamedTuple):
    """Words that are read and not simulated: the finding's code, and what a user may do or expect."""

    words: tuple[str, ...]
    code: str
    hint: str


class SystemBlock(NamedTuple):
    """Work systems besides G54 to G59.3, numbered as in `canon.systems`; parameter `first` has X of the first."""

    systems: range
    first: int


class Figure(NamedTuple):
    """A modal way to draw all that follows differently: its code that switches it on, and the names of both."""

    on: int
    name: str
    off: str


@frozen
class Lathe:
    """How a program for this control's lathes is known, and what to say about it (`{word}` is what gave it away).

    `changes_by_m6`: such a lathe has M6, too, so that it does not stand for a mill. `refused`: the same words mean
    something else there.
    """

    words: re.Pattern[bytes]
    changes_by_m6: bool
    refused: bool
    code: str
    message: str
    hint: str


@frozen
class Dialect:
    """The codes, words and limits of a control.

    `g_groups` and `m_groups` give each code's modal group; `users` says which
    codes use a letter (`g43`, `m66` …), so that a word that nothing uses is a
    finding; letters without an entry are always allowed. `unsimulated`
    says what codes do that the control has and the simulation has not. `computes`
    says whether there are parameters and expressions, `open_m_codes` that machine builders
    use `user_m_codes` as they like, so that no program is wrong because of
    one, `passes_over_far_centres` that K beside I and J in the XY plane is no
    fault. `arcs_name_axes` says that an arc names an axis of its plane even
    where it is a full circle, and `arc_miss` how far [mm] its end may be off its
    circle: the first passes always, the second is the most that 0.1 % of the
    radius may allow; None for RS274's. `dots_are_lines` says that an arc around its own
    start point is a straight line to its end. `g53_under_g91` says that G53 is absolute
    whatever the distance mode, where RS274 refuses it. `first_motion` is the motion in force at the start, -1 for none.
    `executor` names the class (`module:Class`) that runs programs of a control
    whose blocks mean something else than those of RS274. `statements`: GOTO, IF
    and WHILE stand in lines of their own, and O begins a program. `skipped` are words of this
    control alone that are read and not simulated; `figures` says by modal group what draws
    differently and outlives the program, `shift_off` how G52 and G92 are cancelled
    where not by codes of RS274; `lathe` how programs of its lathes are known.
    `grammar_parts` names the class (`module:Class`, below `grammar.LineParts`) that makes the parts of a line where the
    grammar has rules of its own. `further_systems` are work systems besides G54 to G59.3, and `turned_systems` says
    whether one may be turned about Z. `options` are settings that this control alone has, each with what it may be, the
    usual one first. `prints`: a control of 3D printers, whose E words are filament. `tip_m_codes` are M codes
    with which a control whose machine turns tool or work begins (True) and ends to hold the tip;
    a cell may map them to something else. `turret`: a tool change turns a turret, and the spindle, which carries the
    work, goes on. `rapids_stand`: a rapid move ends at rest, whatever the path control (FANUC, B-63944EN, 4.1: it is
    decelerated at the end of its block, and the next one begins when it is in position). `only_changes_stop`: words for
    spindle and coolant stop the machine only where they change something. `look_ahead` is how many
    blocks the control knows behind the one that runs; None: without end, or not known. `corners_count`: arcs that it
    puts into corners are blocks too, and of the last one before a stop it counts on half (LinuxCNC). `h0_cancels`: G43
    H0 puts no length in force.
    """

    name: str
    grammar: str
    longest_line: int
    most_m_codes: int
    g_groups: Mapping[int, int]
    m_groups: Mapping[int, int]
    users: Mapping[str, frozenset[str]]
    user_m_codes: range
    letters: frozenset[str]
    unsimulated: Mapping[int, str] = field(default_factory=dict)
    open_m_codes: bool = False
    passes_over_far_centres: bool = False
    arcs_name_axes: bool = False
    arc_miss: tuple[float, float] | None = None
    dots_are_lines: bool = False
    g53_under_g91: bool = False
    needs_end: bool = True
    flow_words: bool = True
    statements: bool = False
    named_parameters: bool = True
    computes: bool = True
    first_motion: int = -1
    executor: str = ""
    skipped: tuple[Unsimulated, ...] = ()
    figures: Mapping[int, Figure] = field(default_factory=dict)
    shift_off: str = ""
    lathe: Lathe | None = None
    grammar_parts: str = ""
    further_systems: tuple[SystemBlock, ...] = ()
    turned_systems: bool = True
    options: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    prints: bool = False
    tip_m_codes: Mapping[int, bool] = field(default_factory=dict)
    turret: bool = False
    rapids_stand: bool = False
    only_changes_stop: bool = False
    look_ahead: int | None = None
    corners_count: bool = False
    h0_cancels: bool = False

    def option(self, name: str, given: Mapping[str, str]) -> str:
        """What an option of this control is set to, by the settings `given`; ValueError if it cannot be that."""
        known = self.options[name]
        value = given.get(name, known[0])
        if value not in known:
            raise ValueError(f"{name} of {self.name} is one of {', '.join(known)}, not {value}")
        return value


def g_name(code: int) -> str:
    """`g54`, `g59.3` of a code times ten."""
    return f"g{code // 10}" if code % 10 == 0 else f"g{code // 10}.{code % 10}"
