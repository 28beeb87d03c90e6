"""Round sections one above the other, cylinders and cones: what shanks, necks, collets and holders are made of."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, NamedTuple

from gcodesim.declarations.composed import ListOf
from gcodesim.declarations.keys import key
from gcodesim.declarations.record import Record
from gcodesim.frozen import frozen
from gcodesim.tools.body import Primitive, cone, cylinder

if TYPE_CHECKING:
    from gcodesim.material.sweep_kernels import Shape


@frozen
class StackedSection:
    """A cylinder, or a cone from `diameter` at its lower end to `upper_diameter`; lengths [m]."""

    diameter: float = key("length", "diameter at its lower end", example="32 mm")
    upper_diameter: float | None = key(
        "length",
        "at its upper end, where it is a cone; one that narrows upwards meets stock as 16 steps",
        default=None,
        rule="as `diameter`",
        example="44 mm",
    )
    length: float = key("length", "its height", example="60 mm")

    @property
    def upper(self) -> float:
        """The diameter at its upper end [m]."""
        return self.diameter if self.upper_diameter is None else self.upper_diameter


_ABOVE = ListOf(Record(StackedSection, "a section"))
_ABOVE_DOC = "further sections above it, each with `diameter`, `upper_diameter`, `length`"


@frozen
class Holder(StackedSection):
    """What grips a tool, from the tool up: one section, or several with those `above`."""

    diameter: float = key("length", "diameter of the holder, of a cone at its lower end", example="32 mm")
    length: float = key("length", "height of the holder, from the spindle nose or flange to the tool", example="60 mm")
    above: tuple[StackedSection, ...] = key(_ABOVE, _ABOVE_DOC, default=(), quiet=True)

    @property
    def sections(self) -> tuple[StackedSection, ...]:
        """All of it from the tool up."""
        return (self, *self.above)

    @property
    def height(self) -> float:
        """Of all sections [m]."""
        return sum(section.length for section in self.sections)


@frozen
class Shank:
    """What is between the edges of a cutter and its holder: neck and shank, from the edges up; lengths [m]."""

    diameter: float = key("length", "diameter above the edges", example="6 mm")
    upper_diameter: float | None = key(
        "length",
        "at its upper end, where it is a cone; one that narrows upwards meets stock as 16 steps",
        default=None,
        rule="as `diameter`",
        example="10 mm",
    )
    length: float | None = key("length", "its height", default=None, rule="up to the holder", example="20 mm")
    above: tuple[StackedSection, ...] = key(_ABOVE, _ABOVE_DOC, default=(), quiet=True)

    def sections(self, room: float) -> tuple[StackedSection, ...]:
        """All of it from the edges up; the last diameter goes on up to the holder, `room` [m] above the edges."""
        first = room if self.length is None else self.length
        found = [StackedSection(diameter=self.diameter, upper_diameter=self.upper_diameter, length=first), *self.above]
        left = room - sum(section.length for section in found)
        if left > 1e-9:
            found.append(StackedSection(diameter=found[-1].upper, length=left))
        return tuple(found)

    @property
    def height(self) -> float:
        """Of the sections whose length is given [m]."""
        return (self.length or 0.0) + sum(section.length for section in self.above)


class Frustum(NamedTuple):
    """A section where it stands: radii at its lower and upper end, and heights above the tip [m]."""

    lower: float
    upper: float
    bottom: float
    top: float


def stacked(sections: Iterable[StackedSection], bottom: float) -> tuple[Frustum, ...]:
    """Sections one above the other from the height `bottom` [m] above the tip on."""
    found: list[Frustum] = []
    for section in sections:
        top = bottom + section.length
        found.append(Frustum(0.5 * section.diameter, 0.5 * section.upper, bottom, top))
        bottom = top
    return tuple(found)


def bodies_of(part: str, frusta: Iterable[Frustum]) -> list[Primitive]:
    """The same as bodies of a `part`."""
    return [
        cylinder(part, lower, bottom, top) if lower == upper else cone(part, lower, upper, bottom, top)
        for lower, upper, bottom, top in frusta
    ]


def shapes_of(frusta: Iterable[Frustum]) -> tuple[Shape, ...]:
    """The same as shapes of the stock's kernels."""
    from gcodesim.material.shape import frustum

    return tuple(shape for part in frusta for shape in frustum(*part))


def sizes_of(name: str, sections: Iterable[StackedSection]) -> Iterator[tuple[str, float]]:
    """The sizes of the parts of `name` that only make sense above zero, by their keys."""
    for number, section in enumerate(sections):
        at = f"{name}." if number == 0 else f"{name}.above.{number - 1}."
        yield f"{at}diameter", section.diameter
        yield f"{at}length", section.length
        if section.upper_diameter is not None:
            yield f"{at}upper_diameter", section.upper_diameter
