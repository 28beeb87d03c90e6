"""Axes of a machine as lines of a cell file."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from gcodesim.importers.importer import written

_ENOUGH = 0.02  # share of its travel that an axis keeps on both sides of zero where programs can begin at zero


@dataclass(slots=True)
class ImportedAxis:
    """An axis [mm or deg, and per s]; None where a control does not say it. `lower` and `upper` None: unlimited."""

    letter: str
    lower: float | None
    upper: float | None
    speed: float
    acceleration: float | None = None
    jerk: float | None = None
    home: float | None = None
    remark: str = ""

    @property
    def turns(self) -> bool:
        return self.letter in "ABC"

    def line(self) -> str:
        """Its line in a cell."""
        unit = "deg" if self.turns else "mm"
        travel = (
            "unlimited"
            if self.lower is None or self.upper is None
            else f"[{written(self.lower)}, {written(self.upper)} {unit}]"
        )
        keys = [f"travel: {travel}", f"speed: {written(self.speed)} {unit}/s"]
        if self.acceleration is not None:
            keys.append(f"acceleration: {written(self.acceleration)} {unit}/s^2")
        if self.jerk is not None:
            keys.append(f"jerk: {written(self.jerk)} {unit}/s^3")
        if self.home is not None:
            keys.append(f"home: {written(self.home)} {unit}")
        remark = f"  # {self.remark}" if self.remark else ""
        return f"    {self.letter}: {{{', '.join(keys)}}}{remark}"


def machine_lines(axes: Mapping[str, ImportedAxis], keys: tuple[str, ...] = ()) -> Iterator[str]:
    """`machine:` with its axes; `keys` are further lines of it."""
    yield "machine:"
    for key in keys:
        yield f"  {key}"
    yield "  axes:"
    for axis in axes.values():
        yield axis.line()


def zero_lines(axes: Mapping[str, ImportedAxis]) -> Iterator[str]:
    """G54 where a program has room: at machine zero, if that lies well inside the travel of X, Y and Z, else in the
    middle of X and Y and high up in Z."""
    linear = [axes[letter] for letter in "XYZ" if letter in axes]
    if all(_inside(axis) for axis in linear):
        return
    places = []
    for letter in "XYZ":
        axis = axes.get(letter)
        if axis is None or axis.lower is None or axis.upper is None:
            places.append(0.0)
        else:
            share = 0.6 if letter == "Z" else 0.5
            places.append(axis.lower + share * (axis.upper - axis.lower))
    yield "# where the work lies is not known: put the zero of yours"
    yield f"work_offsets: {{G54: {{xyz: [{', '.join(written(round(p, 3)) for p in places)} mm]}}}}"


def _inside(axis: ImportedAxis) -> bool:
    if axis.lower is None or axis.upper is None:
        return True
    room = _ENOUGH * (axis.upper - axis.lower)
    return axis.lower + room < 0.0 < axis.upper - room
