"""T of RepRapFirmware: macros before the old tool is given up, before the new one is taken, and behind that."""

from __future__ import annotations

from typing import Final, NamedTuple

_FREE, _BEFORE, _BEHIND = 1, 2, 4  # bits of P (Tool.h: TFreeBit, TPreBit, TPostBit)
_ALL: Final = _FREE | _BEFORE | _BEHIND


class ChangeStep(NamedTuple):
    """A macro by its names, of which the first counts that there is, or, without names, `tool` in use; -1: none."""

    macros: tuple[str, ...] = ()
    tool: int = -1


def steps_of(old: int, new: int, which: int | None) -> tuple[ChangeStep, ...]:
    """What is done, in order, where tool `new` takes the place of `old` (-1: none); `which` are the bits of P.

    Nothing where it is in use. A macro without a number is for tools that have none of their own (RepRapFirmware 3.5,
    GCodes4.cpp, toolChange0 to toolChange2).
    """
    if old == new:
        return ()
    bits = _ALL if which is None else which
    steps = [_macro("tfree", old), ChangeStep()] if old >= 0 and bits & _FREE else [ChangeStep()]
    if new >= 0:
        steps += [_macro("tpre", new)] if bits & _BEFORE else []
        steps += [ChangeStep(tool=new)]
        steps += [_macro("tpost", new)] if bits & _BEHIND else []
    return tuple(steps)


def _macro(name: str, tool: int) -> ChangeStep:
    return ChangeStep(macros=(f"{name}{tool}.g", f"{name}.g"))
