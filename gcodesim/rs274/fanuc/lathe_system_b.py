"""Fanuc's lathes with G-code system B, by those with system A: the same cycles, other numbers, G90 and G91.

The list of codes of the 0i-TF's operator's manual has them side by side: G77, G78, G79 are the single cycles, G94 and
G95 the feeds, G92 limits the spindle or sets coordinates, G33 cuts a thread; G90 and G91 say whether X and Z are places
or steps. G98 and G99 choose to which level drilling cycles return, which here is always the first.
"""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Final

from gcodesim.diagnostics import SourceText
from gcodesim.rs274.block import Block, Word
from gcodesim.rs274.fanuc.lathe import FanucLatheExecutor

_OF_SYSTEM_A: Final = {77.0: 90.0, 78.0: 92.0, 79.0: 94.0, 94.0: 98.0, 95.0: 99.0, 92.0: 50.0, 33.0: 32.0}
_NOTES = re.compile(rb"\([^)\r\n]*\)?|;[^\r\n]*")
_OWN = re.compile(rb"(?<![A-Z])G0*(?:92[ \t]*S|7[789][ \t]*[XZ]|33(?![0-9.])|9[01](?![0-9.])[ \t]*G0*[0123](?![0-9.]))")
_OTHERS = re.compile(rb"(?<![A-Z])(?:G0*(?:50[ \t]*[SXZ]|32(?![0-9.]))|[UW][ \t]*[-+]?[0-9.]+[^\r\n]*[XZ])")
_DROPPED: Final = frozenset((90.0, 91.0, 98.0, 99.0))
_STEPS: Final = {"x": "u", "z": "w"}
_NO_STEPS: Final = frozenset((4.0, 10.0, 53.0, 65.0, 66.0, 92.0))  # X and Z are times, settings, places or arguments


def is_in_system_b(lathe: SourceText) -> bool:
    """Whether a program of a lathe has codes of system B and none that system A alone has."""
    words = _NOTES.sub(b" ", lathe.raw.upper())
    return _OWN.search(words) is not None and _OTHERS.search(words) is None


class FanucLatheSystemBExecutor(FanucLatheExecutor):
    """Executes blocks of system B as those of system A."""

    steps: bool = False  # G91

    def in_system_a(self, block: Block) -> Block:
        """A block as system A writes it; whether X and Z are steps goes on from block to block."""
        codes = [value for letter, value in block.words if letter == "g"]
        if modes := [code for code in codes if code in (90.0, 91.0)]:
            self.steps = modes[-1] == 91.0
        letters = _STEPS if self.steps and _NO_STEPS.isdisjoint(codes) else {}
        words, places = [], []
        for (letter, value), place in zip(block.words, block.places, strict=True):
            if letter == "g" and value in _DROPPED:
                continue
            own = _OF_SYSTEM_A.get(value, value) if letter == "g" else value  # type: ignore[arg-type]
            words.append(Word(letters.get(letter, letter), own))
            places.append(place)
        return replace(block, words=words, plain=False, _places=places)
