"""Least increments: lengths and angles are whole numbers of them, and a control may be set to read X10 as ten."""

from __future__ import annotations

import re
from collections.abc import Set as AbstractSet
from dataclasses import replace

from gcodesim.rs274.arcs import PLANE_AXES
from gcodesim.rs274.block import Block
from gcodesim.rs274.fanuc.control import FanucControl
from gcodesim.rs274.fanuc.vectors import BY_VECTOR
from gcodesim.rs274.functions import nearest
from gcodesim.units import INCH, MM

_LENGTHS = frozenset((*"xyzuvwijkr", ",c", ",r"))
_ANGLES = frozenset("abc")
_CENTRES = frozenset("ijk")
_TILTED = 68.2
_MM, _INCH, _DEGREE, _SECOND = 1e-3, 1e-4, 1e-3, 1e-3  # IS-B
_REPEATS_OR_MODES = frozenset((73.0, 74.0, 76.0, *(float(n) for n in range(81, 90))))


_PER_MM, _PER_INCH, _PER_DEGREE = 1000.0, 10000.0, 1000.0  # increments, IS-B
_FINER = {MM: re.compile(r"\.[0-9]{3}0*[1-9]"), INCH: re.compile(r"\.[0-9]{3}[0-9]*[1-9]")}


def rounded(block: Block, control: FanucControl) -> Block:
    """The block with lengths and angles to the least increment, halves away from zero, as a control takes them in.

    Factors, times, feeds, directions and the arguments of macros stay as they are.
    """
    if block.plain and _FINER[control.state.unit].search(block.text) is None:
        return block
    codes = {value for letter, value in block.words if letter == "g"}
    if 4.0 in codes:
        return block
    inch = 20.0 in codes or (control.state.unit == INCH and 21.0 not in codes)
    turned = _letters_of_angles(codes, control)
    exact = _CENTRES if 51.0 in codes or _TILTED in codes or _gives_vector(codes, control) else frozenset()
    words: list[tuple[str, float]] = []
    changed = False
    for letter, value in block.words:
        fits = value
        if letter in turned:
            fits = nearest(value * _PER_DEGREE) / _PER_DEGREE  # type: ignore[operator]
        elif letter in _LENGTHS and letter not in exact:
            per = _PER_INCH if inch else _PER_MM
            fits = nearest(value * per) / per  # type: ignore[operator]
        changed = changed or fits != value
        words.append((letter, fits))  # type: ignore[arg-type]
    return replace(block, words=words, plain=False, _places=list(block.places)) if changed else block


def _gives_vector(codes: AbstractSet[object], control: FanucControl) -> bool:
    """Whether I J K are the direction of the tool: under G43.5, and not the centre of an arc."""
    by_vector = 43.5 in codes or (control.state.length_mode == BY_VECTOR and codes.isdisjoint((43.0, 43.4, 44.0, 49.0)))
    motion = next((code for code in codes if code in (0.0, 1.0, 2.0, 3.0)), control.state.motion / 10.0)
    return by_vector and motion in (0.0, 1.0)


def _letters_of_angles(codes: AbstractSet[object], control: FanucControl) -> frozenset[str]:
    polar = 16.0 in codes or (control.state.polar is not None and 15.0 not in codes)
    more = {"xyz"[PLANE_AXES[control.state.plane][1]]} if polar else set()
    return _ANGLES | more | ({"r"} if 68.0 in codes else set())


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
            elif letter == polar_angle or (_TILTED in codes and letter in _CENTRES):
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
