"""Cutter compensation (first cut: G40 only)."""

from __future__ import annotations

from gcodesim.rs274.control import Control
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.state import Vector
from gcodesim.rs274.words import Words


def switch(words: Words, control: Control) -> None:
    code = words.g.get(7)
    if code is None or code == 400:
        return
    raise Fault("GS150", "not there yet")


def straight(words: Words, control: Control, end: Vector, *, rapid: bool) -> None:
    raise Fault("GS150", "not there yet")


def arc(words: Words, control: Control, end: Vector, code: int) -> None:
    raise Fault("GS150", "not there yet")
