"""Differences from LinuxCNC's standalone interpreter that are meant, each with its reason.

Debian's package is 2.9.0~pre1. Its program `rs274` interprets without a machine:
what a machine would answer (a probe, a changed tool, where the axes stand) is
made up, and some of that is not what LinuxCNC does on a machine.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass

from linuxcnc import Verdict


@dataclass(frozen=True, slots=True)
class Explanation:
    """`applies(program, verdict, difference)`: whether this is the reason of a difference."""

    reason: str
    applies: Callable[[str, Verdict, str], bool]


def _about(difference: str, program: str) -> Callable[[str, Verdict, str], bool]:
    shown, wrote = re.compile(difference, re.IGNORECASE), re.compile(program, re.IGNORECASE | re.MULTILINE)
    return lambda text, verdict, found: bool(shown.search(found)) and bool(wrote.search(text))


EXPLAINED: tuple[Explanation, ...] = (
    Explanation(
        "G17.1, G18.1 and G19.1 choose planes of U, V and W, which are not simulated: refused here",
        _about(r"refused.*GS012", r"G\s*1\s*[789]\s*\.\s*1"),
    ),
    Explanation(
        "an arc of more than 10,000 turns is refused here: no path of it could be planned",
        _about(r"refused.*GS106 G[23] P\d+ would be", r"P"),
    ),
    Explanation(
        "U, V and W: the standalone interpreter has a machine without them",
        _about(r"Bad character '[uvw]' used", r"[UVW]"),
    ),
    Explanation(
        "the cycles of lathes G70, G71 and G72 are not simulated: refused here",
        _about(r"GS012 G7[012]|does not end", r"G\s*7\s*[012]"),
    ),
    Explanation(
        "a number above 1e30 is refused here: no machine can be given it",
        _about(r"GS123 the value .* is out of any machine's range", r"."),
    ),
    Explanation(
        "M66 L5 and above: the standalone interpreter has no input to wait for and takes any L",
        _about(r"GS106 L\d+ is no way to wait", r"M\s*66"),
    ),
    Explanation(
        "G5, G5.1 and G5.2 outside G17, under G93 or with cutter compensation are refused here; LinuxCNC draws "
        "some of them in a plane other than the one it then believes to be in",
        _about(r"refused.*(GS170|GS150) G5", r"G\s*0*5"),
    ),
    Explanation(
        "the first control point of G5.2 without P gets the weight -1 in LinuxCNC; here P has to be given",
        _about(r"refused.*GS170 G5.2 needs the word P", r"G\s*5\s*\.\s*2"),
    ),
    Explanation(
        "the standalone interpreter keeps the number of a tool offset when G20 or G21 changes its unit; on a machine "
        "the offset is asked for anew in the new unit, as here",
        _about(r"event|(refused|accepted).*", r"G\s*0*43(?!\d)(.|\n)*G\s*0*2\s*[01](?!\d)"),
    ),
    Explanation(
        "the standalone interpreter keeps the number of the feed when G20 or G21 changes its unit, so that M72 brings "
        "another F back; on a machine the feed is asked for anew in the new unit, as here",
        _about(r"differs in feed", r"M\s*0*7\s*[023](?!\d)(.|\n)*G\s*0*2\s*[01]|G\s*0*2\s*[01](.|\n)*M\s*0*7\s*[023]"),
    ),
    Explanation(
        "the standalone interpreter begins with pocket 1 and no tool, so that what G10 says of tool 1 counts for the "
        "spindle; on a machine there is no pocket in use",
        _about(
            r"differs in (end|offset|text)",
            r"_current_pocket|G\s*1\s*0(?![0-9]).*P\s*0*1(?![0-9])|P\s*0*1(?![0-9]).*G\s*1\s*0(?![0-9])",
        ),
    ),
    Explanation(
        "the standalone interpreter stops a probe short of its end and yet stores the end in #5061 and on; here what "
        "is stored is where it stopped",
        _about(r"differs in (end|text|value|feed)", r"G\s*3\s*8\s*\.(.|\n)*#\s*506"),
    ),
    Explanation(
        "T0 M6 leaves the standalone interpreter with the tool it had",
        _about(r"differs|accepted|refused", r"T\s*0+(\.0*)?(?![0-9.])"),
    ),
    Explanation(
        "LinuxCNC cannot take an inside corner behind a stop or another code in compensation: it looks at a move "
        "that no longer waits",
        _about(r"differs in (end|kind|sweep)", r"G\s*4\s*[12](.|\n)*(M\s*0*[01](?![0-9])|M\s*0*6(?![0-9])|M\s*60)"),
    ),
    Explanation(
        "what stands behind the O-word at which a skip ends, and the label of an O-word that is skipped, are read "
        "by LinuxCNC only so far as it needs them; a line that is broken there is refused here",
        _about(r"refused.*GS008", r"^[\s/]*(N\s*\d*\s*)?O"),
    ),
    Explanation(
        "labels that are broken expressions are found by their look here, and by computing them in LinuxCNC",
        _about(r"refused.*GS13", r"O\s*\["),
    ),
    Explanation(
        "an index of an output above 63 overflows in LinuxCNC",
        _about(r"differs in index", r"\d{9}"),
    ),
    Explanation(
        "a lone carriage return ends a line here, as in old files; LinuxCNC passes over it",
        _about(r".", r"\r(?!\n)"),
    ),
    Explanation(
        "control points that no G5.3 ended join the next G5 or G5.1 in LinuxCNC; here they are dropped with a warning",
        _about(r"spline|GS170", r"G\s*0*5\s*\.\s*2(.|\n)*G\s*0*5(?!\d)(?!\s*\.\s*[23])"),
    ),
)


def explanation(program: bytes, verdict: Verdict, difference: str) -> str:
    """Why this difference is meant; empty when nothing explains it."""
    text = re.sub(r"\([^)]*\)", "", program.decode("latin-1"))
    return next((e.reason for e in EXPLAINED if e.applies(text, verdict, difference)), "")
