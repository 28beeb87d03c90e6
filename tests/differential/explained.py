"""Differences from LinuxCNC's standalone interpreter that are meant, each with its reason.

Debian's package is 2.9.0~pre1. Its program `rs274` interprets without a machine: what a machine would answer (a
changed tool, where the axes stand) is made up, and some of that is not what LinuxCNC does on a machine. What of it can
be made up here as well, `agreement.py` does; the rest is told here, each for exactly its circumstance.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from agreement import Comparison, differences, settings
from linuxcnc import Verdict


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """A program that differs; `text` is without comments in parentheses."""

    program: bytes
    text: str
    verdict: Verdict
    compared: Comparison

    @property
    def found(self) -> str:
        return self.compared.differences[0]

    def happened(self, *kinds: str) -> list[dict[str, Any]]:
        """Events of these kinds up to the one that differs."""
        return [event for event in self.compared.before if event["kind"] in kinds]

    def says(self, pattern: str) -> bool:
        """Whether a line of the program matches."""
        return re.search(pattern, self.text, re.IGNORECASE | re.MULTILINE) is not None


@dataclass(frozen=True, slots=True)
class Explanation:
    """`applies(case)`: whether this is the reason of a difference."""

    reason: str
    applies: Callable[[Case], bool]


def _found(pattern: str) -> Callable[[Case], bool]:
    """The difference reads like this."""
    shown = re.compile(pattern)
    return lambda case: shown.search(case.found) is not None


_PLANES_OF_UVW = _found(r"refused.*GS012 G1[789]\.1 is no G code")
_UNIT = r"G\s*0*2\s*[01](?![\d.])"
_CHANGE = r"M\s*0*6(?![\d.])"


def _lone_return(case: Case) -> bool:
    """Without the lone carriage returns, over which LinuxCNC passes, both agree."""
    without = re.sub(rb"\r(?!\n)", b"", case.program)
    return without != case.program and not differences(without, case.verdict, settings())


def _of_an_offset_in_another_unit(case: Case) -> bool:
    offsets = [event for event in case.happened("tool_offset") if any(event["offset"][:3])]
    return "differs in feed_unit" in case.found and bool(offsets) and case.says(_UNIT)


def _restored_feed(case: Case) -> bool:
    """The feeds are to each other as inch and millimetre; M72 and M73 bring F back with one decimal."""
    shown = case.compared.shown
    if "differs in feed" not in case.found or shown is None or not case.says(r"M\s*0*7\s*[023](?!\d)"):
        return False
    ratio = shown[0].get("feed", 0.0) / (shown[1].get("feed") or 1.0)
    return case.says(_UNIT) and any(abs(ratio / factor - 1.0) < 0.02 for factor in (25.4, 1.0 / 25.4))


def _first_pocket(case: Case) -> bool:
    """No tool was changed yet."""
    data = r"G\s*1\s*0(?![\d.]).*P\s*0*1(?![\d.])|P\s*0*1(?![\d.]).*G\s*1\s*0(?![\d.])"
    return not case.happened("tool_change", "tool_number") and case.says(rf"_current_pocket|{data}")


def _no_tool(case: Case) -> bool:
    return any(event["tool"] == 0 for event in case.happened("tool_change"))


def _changed_in_the_block(case: Case) -> bool:
    """A tool change in the block of G41, G42 or G43 came before the difference."""
    beside = r"G\s*0*4\s*[123](?!\d)"
    changed = bool(case.happened("tool_change"))
    return changed and case.says(rf"^.*(?:{_CHANGE}.*{beside}|{beside}.*{_CHANGE})")


def _corner_behind_a_stop(case: Case) -> bool:
    """What comes right before the move that differs is a stop."""
    acts = [event for event in case.compared.before if event["kind"] not in ("message", "print", "log", "tool_select")]
    stopped = any(event["kind"] in ("stop", "optional_stop", "pallet_shuttle") for event in acts[-3:-1])
    return stopped and re.search(r"differs in (end|kind|sweep)", case.found) is not None


def _behind_a_skip(case: Case) -> bool:
    """The line refused is an O-word that ends a skip and has more behind its keyword."""
    ends = r"[\s/]*(N[\d.\s]*)?O.*?(else|elseif|endif|while|endwhile|endrepeat|endsub)"
    refused = re.match(ends, case.compared.refused_line, re.IGNORECASE)
    return refused is not None and re.search(r"refused.*GS008", case.found) is not None


def _negative_label(case: Case) -> bool:
    refused = re.match(r"[\s/]*(N[\d.\s]*)?O\s*[-+]", case.compared.refused_line, re.IGNORECASE)
    return refused is not None and re.search(r"refused.*GS008", case.found) is not None


def _computed_label(case: Case) -> bool:
    guilty = re.sub(r"\s", "", case.verdict.text).lower()
    return case.found.startswith("refused") and guilty.startswith(("o[", "o#"))


def _overflow(case: Case) -> bool:
    shown = case.compared.shown
    return "differs in index" in case.found and shown is not None and shown[1]["index"] > 2**31 - 1


def _numbers(value: Any) -> Iterator[float]:
    if isinstance(value, list):
        for one in value:
            yield from _numbers(one)
    elif isinstance(value, int | float) and not isinstance(value, bool):
        yield value


def _last_digits(case: Case) -> bool:
    """All numbers are the same to 12 digits, of which LinuxCNC prints six behind the point."""
    shown = case.compared.shown
    what = re.search(r"differs in (\w+)", case.found)
    if shown is None or what is None or what[1] not in ("end", "center", "feed", "pitch", "value"):
        return False
    pairs = zip(_numbers(shown[0][what[1]]), _numbers(shown[1][what[1]]), strict=True)
    return all(abs(a - b) <= 1e-12 * max(abs(a), abs(b)) or abs(a - b) <= 1e-6 for a, b in pairs)


EXPLAINED: tuple[Explanation, ...] = (
    Explanation("a lone carriage return ends a line here, as in old files; LinuxCNC passes over it", _lone_return),
    Explanation(
        "G17.1, G18.1 and G19.1 choose planes of U, V and W, which are not simulated: refused here", _PLANES_OF_UVW
    ),
    Explanation(
        "an arc of more than 10,000 turns is refused here: no path of it could be planned",
        _found(r"refused.*GS106 G[23] P\d+ would be \d+ turns"),
    ),
    Explanation(
        "U, V and W: the standalone interpreter has a machine without them",
        lambda case: re.search(r"Bad character '[uvw]' used", case.verdict.message, re.IGNORECASE) is not None,
    ),
    Explanation(
        "G70, G71 and G72 without Q, which choose units on other controls, are refused by another message here",
        lambda case: (
            re.search(r"refused.*GS012 G7[012]|does not end", case.found) is not None
            and case.says(r"G\s*7\s*[012](?!\d)")
        ),
    ),
    Explanation(
        "since 2.9.4 the contour of G71 and G72 is led out to where the cycle starts, if it does not lead there; "
        "where it does, the moves are those of `tests/data/lathe_cycles`",
        lambda case: (
            re.search(r"differs in (?:end|kind|center|sweep)|events, expected", case.found) is not None
            and case.says(r"G\s*7\s*[12](?:\.[12])?\s*Q")
        ),
    ),
    Explanation(
        "LinuxCNC refuses to set a value of its INI file; the standalone interpreter has none, and sets a parameter",
        _found(r"refused.*GS122 #<_(?:ini|hal)\["),
    ),
    Explanation(
        "a number above 1e30 is refused here: no machine can be given it",
        _found(r"refused.*GS123 the value .* is out of any machine's range"),
    ),
    Explanation(
        "M66 L5 and above: the standalone interpreter has no input to wait for and takes any L",
        _found(r"refused.*GS106 L\d+ is no way to wait"),
    ),
    Explanation(
        "G64 R chooses a planner since 2.10; here a note (GS913) says so",
        lambda case: (
            "R word with no g code" in case.verdict.message
            and re.search(r"G\s*64(?![\d.]).*R|R.*G\s*64(?![\d.])", case.verdict.text, re.IGNORECASE) is not None
        ),
    ),
    Explanation(
        "a P-1 is no P to LinuxCNC, so that another one may follow",
        lambda case: (
            "GS009 P stands twice" in case.found
            and re.search(r"P\s*-\s*0*1\b", case.compared.refused_line, re.I) is not None
        ),
    ),
    Explanation(
        "a NUL ends a line of LinuxCNC's",
        lambda case: "U+0000" in case.found and "\0" in case.compared.refused_line,
    ),
    Explanation(
        "an arc behind a tapping cycle outside G17, of which LinuxCNC does not know where it left the tool",
        lambda case: "differs in sweep" in case.found and case.says(r"G\s*(74|84)") and case.says(r"G\s*0*1\s*[89]"),
    ),
    Explanation(
        "the number of an input is whole here; LinuxCNC rounds it", _found(r"refused.*GS106 P of M66 must be a whole")
    ),
    Explanation(
        "ROUND, FIX and FUP of an infinite value overflow in LinuxCNC; here they are no number",
        _found(r"refused.*GS123 the value is no number: nan"),
    ),
    Explanation(
        "outputs are numbered from 0: LinuxCNC hands on whatever number there is",
        _found(r"refused.*GS106 the number of the output is negative"),
    ),
    Explanation(
        "G5, G5.1 and G5.2 outside G17, under G93 or with cutter compensation are refused here; LinuxCNC draws "
        "some of them in a plane other than the one it then believes to be in",
        _found(r"refused.*(GS170 G5(\.\d)? (works in the XY plane only|cannot be used under G93)|GS150 G5(\.\d)? is)"),
    ),
    Explanation(
        "the weight of the first control point behind G5.2 has to be given and to be positive; LinuxCNC takes any, and "
        "-1 for none",
        _found(r"refused.*GS170 (G5\.2 needs the word P|the weight P-[\d.e+]+ must be positive)"),
    ),
    Explanation(
        "G33 and G33.1 are refused in cutter compensation; LinuxCNC makes plain feeds of them, or stops with a message "
        "that calls itself a bug",
        _found(r"refused.*GS150 G33(\.1)? is refused while cutter compensation is on"),
    ),
    Explanation(
        "the standalone interpreter keeps the number of a tool offset when G20 or G21 changes its unit, so that its "
        "next move seems to move Z, too; on a machine the offset is asked for anew in the new unit",
        _of_an_offset_in_another_unit,
    ),
    Explanation(
        "the standalone interpreter keeps the number of the feed when G20 or G21 changes its unit, so that M72 brings "
        "another F back; on a machine the feed is asked for anew in the new unit, as here",
        _restored_feed,
    ),
    Explanation(
        "the standalone interpreter begins with pocket 1 and no tool, so that what G10 says of tool 1 counts for the "
        "spindle; on a machine there is no pocket in use",
        _first_pocket,
    ),
    Explanation("T0 M6 leaves the standalone interpreter with the tool it had", _no_tool),
    Explanation(
        "the standalone interpreter forgets the tool of M61 at once", lambda case: bool(case.happened("tool_number"))
    ),
    Explanation(
        "behind M6 LinuxCNC asks where it stands: the standalone interpreter answers without the length offset and the "
        "compensation that the block of M6 switched on",
        _changed_in_the_block,
    ),
    Explanation(
        "LinuxCNC cannot take an inside corner right behind a stop in compensation: it looks at a move that no longer "
        "waits",
        _corner_behind_a_stop,
    ),
    Explanation(
        "what stands behind the O-word at which a skip ends is read by LinuxCNC only so far as it needs it; a line "
        "that is broken there is refused here",
        _behind_a_skip,
    ),
    Explanation("labels have no sign here; LinuxCNC reads a negative one", _negative_label),
    Explanation(
        "labels that are broken expressions are found by their look here, and by computing them in LinuxCNC",
        _computed_label,
    ),
    Explanation("an index of an output above 31 bits overflows in LinuxCNC", _overflow),
    Explanation(
        "M428 to M430 switch the kinematics of a machine of its own by remaps, which the standalone interpreter does "
        "not have",
        _found(r"LinuxCNC: M-code greater than 199: M4(28|29|30)\b"),
    ),
    Explanation("of a number near 1e12 LinuxCNC prints fewer digits than it has", _last_digits),
)


def explanation(program: bytes, verdict: Verdict, compared: Comparison) -> str:
    """Why this difference is meant; empty when nothing explains it."""
    text = re.sub(r"\([^)]*\)", "", program.decode("latin-1"))
    case = Case(program=program, text=text, verdict=verdict, compared=compared)
    return next((e.reason for e in EXPLAINED if e.applies(case)), "")
