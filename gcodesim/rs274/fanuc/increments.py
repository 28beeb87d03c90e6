"""Numbers without a decimal point as least increments: X10 is 0.01 mm, where the control is set so."""

from __future__ import annotations

from gcodesim.rs274.arcs import PLANE_AXES
from gcodesim.rs274.block import Block
from gcodesim.rs274.fanuc.control import FanucControl
from gcodesim.units import INCH

_LENGTHS = frozenset((*"xyzuvwijkr", ",c", ",r"))
_ANGLES = frozenset("abc")
_MM, _INCH, _DEGREE, _SECOND = 1e-3, 1e-4, 1e-3, 1e-3  # IS-B
_REPEATS_OR_MODES = frozenset((73.0, 74.0, 76.0, *(float(n) for n in range(81, 90))))


def in_increments(block: Block, control: FanucControl) -> Block:
    """The block with lengths, angles and feeds as meant; numbers with a point and computed ones are as written."""
    codes = {value for letter, value in block.words if letter == "g"}
    drilling = bool(_REPEATS_OR_MODES & codes) or control.state.motion >= 730
    inch = 20.0 in codes or (control.state.unit == INCH and 21.0 not in codes)
    length = _INCH if inch else _MM
    per_turn = 95.0 in codes or (control.state.feed_mode == 950 and 94.0 not in codes)
    polar = 16.0 in codes or (control.state.polar is not None and 15.0 not in codes)
    polar_angle = "xyz"[PLANE_AXES[control.state.plane][1]] if polar else ""
    words = []
    for (letter, value), (first, last) in zip(block.words, block.places, strict=True):
        factor = 1.0
        if not any(char in block.text[first:last] for char in ".#["):
            if 4.0 in codes:
                factor = _SECOND if letter in "xu" else 1.0
            elif 68.0 in codes and letter == "r":
                factor = _DEGREE
            elif 51.0 in codes and letter in "ijk":
                factor = 1.0  # thousandths of the size anyway
            elif letter == polar_angle:
                factor = _DEGREE
            elif letter in _LENGTHS or (letter == "q" and drilling):
                factor = 1.0 if letter == "k" and drilling else length
            elif letter in _ANGLES:
                factor = _DEGREE
            elif letter == "f" and per_turn:
                factor = 1e-4 if inch else 1e-2
            elif letter == "f" and inch:
                factor = 1e-2
        words.append((letter, value * factor))  # type: ignore[operator]
    return Block(block.line, block.text, words, _places=list(block.places))
