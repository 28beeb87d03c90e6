"""G and M codes that a user of RepRapFirmware has made: `M1234` runs `M1234.g`, where the firmware has none itself."""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path
from typing import Final

_FILE: Final = re.compile(r"([GM])(0|[1-9][0-9]{0,3})(?:\.([1-9]))?\.g", re.IGNORECASE)
_CODE: Final = re.compile(r"[ \t]*(?:[Nn][ \t]*[0-9]+[ \t]*)?([GMgm])[ \t]*([0-9]+)(?:\.([0-9]))?(?![0-9.])", re.ASCII)
_SYSTEM: Final = "sys"

# codes that RepRapFirmware 3.5 carries out itself, whatever files there are (GCodes2.cpp, HandleGcode and HandleMcode)
_G: Final = frozenset((*range(5), 10, 11, *range(17, 22), *range(28, 33), 38, *range(53, 61), 68, 69, *range(90, 95)))
_M: Final = frozenset(
    (
        *(*range(6), 17, 18, *range(20, 31), 32, 36, 37, 38, 39, 42, 73, *range(80, 86), 92, 98, 99),
        *(*range(101, 113), *range(114, 123), 140, 141, 143, 144, 150, 190, 191),
        *(200, 201, *range(203, 209), 220, 221, 226, 260, 261, 280, 290, 291, 292),
        *(*range(300, 306), 307, 308, 309, 350, 374, 375, 376, 400, 401, 402, 404, 407, 408, 409, 425),
        *(*range(450, 454), 470, 471, 472, 486, 500, 501, 502, 503, 505, 540),
        *(*range(550, 565), *range(566, 573), *range(574, 578), 579, 581, 582),
        *(*range(584, 590), *range(591, 602), 606),
        *(665, 666, 667, *range(669, 676), 701, 702, 703, *range(750, 757), 851),
        *(905, 906, 911, 912, 913, *range(915, 919), 929, *range(950, 958), 997, 998, 999),
    )
)
_WITH_FRACTIONS: Final = {"G": frozenset((38, 59)), "M": frozenset((36, 201, 558, 569, 586, 587))}
"""Numbers whose codes with a point behind are the firmware's, too."""


def codes_in(folders: Iterable[Path]) -> dict[str, str]:
    """The files of codes beside a program or in the folder of system files, by the code: M1234, G38.9."""
    found: dict[str, str] = {}
    for folder in folders:
        for within in ("", _SYSTEM):
            try:
                names = sorted(path.name for path in (folder / within).iterdir())
            except OSError:
                continue
            for name in names:
                if (made := _FILE.fullmatch(name)) is not None:
                    code = _name(made[1], made[2], made[3])
                    if not _is_built_in(code):
                        found.setdefault(code, f"{within}/{name}" if within else name)
    return found


def own_code(text: str) -> tuple[str, int] | None:
    """The code of a line, as M1234, and where its letters begin; None where it has none."""
    found = _CODE.match(text)
    return None if found is None else (_name(*found.groups()), found.end())


def _name(letter: str, number: str, fraction: str | None) -> str:
    return f"{letter.upper()}{int(number)}" + (f".{fraction}" if fraction not in (None, "0") else "")


def _is_built_in(code: str) -> bool:
    letter, number = code[0], int(code[1:].partition(".")[0])
    if "." in code:
        return number in _WITH_FRACTIONS[letter]
    return number in (_G if letter == "G" else _M)
