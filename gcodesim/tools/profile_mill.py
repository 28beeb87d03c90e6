"""Profile mill: any body of revolution by its outline."""

from __future__ import annotations

from itertools import pairwise
from math import dist
from typing import ClassVar

from gcodesim.declarations.keys import key
from gcodesim.frozen import frozen
from gcodesim.solids.turned import Outline, OutlineArc, end_of, steps_of
from gcodesim.tools.cutter import usual_length
from gcodesim.tools.form_cutter import FormCutter
from gcodesim.tools.outline_kind import OUTLINE
from gcodesim.units import MM


def _top(cutter: ProfileMill) -> float:
    return end_of(cutter.form_outline[-1])[1] if cutter.form_outline else 0.0


@frozen
class ProfileMill(FormCutter):
    """A mill of any outline: points `[r, h]` from the tip outwards and up, and arcs `{arc: [r, h], centre: [r, h]}`.

    The name of a DXF or SVG file stands for its lines and arcs: the axis is x = 0, what is left of it does not count.
    """

    kind: ClassVar[str] = "profile_mill"

    form_outline: tuple[tuple[float, float] | OutlineArc, ...] = key(
        OUTLINE, "half section of the cutting part from the tip `[0, 0]` to its top", name="outline"
    )
    diameter: float = key(
        "length",
        "greatest cutting diameter",
        derive=lambda cutter: 2.0 * cutter.widest,
        rule="that of `outline`",
        example="10 mm",
        quiet=True,
    )
    length: float = key(
        "length",
        "from the tip to the holder",
        derive=lambda cutter: max(usual_length(2.0 * cutter.widest), _top(cutter)),
        rule="4 times the diameter, at least 40 mm",
        example="60 mm",
    )
    flute_length: float = key(
        "length",
        "length of the cutting edges from the tip",
        derive=_top,
        rule="the top of `outline`",
        example="25 mm",
        quiet=True,
    )
    plain_shank: float = key(
        "length",
        "diameter between the edges and the holder",
        derive=lambda cutter: 2.0 * end_of(cutter.form_outline[-1])[0],
        rule="that of the top of `outline`",
        example="6 mm",
        name="shank_diameter",
    )

    @property
    def outline(self) -> Outline:
        return self.form_outline

    @property
    def shank_diameter(self) -> float:
        return self.plain_shank

    def problems(self) -> list[tuple[str, str]]:
        outline = self.form_outline
        if len(outline) < 2 or dist(end_of(outline[0]), (0.0, 0.0)) > 1e-9:
            return [("outline", "`outline` begins at the tip, `[0, 0]`, and goes on from there")]
        low = 0.0
        for start, piece in steps_of(outline):
            r, h = end_of(piece)
            if r < 0.0:
                return [("outline", f"`outline` crosses the axis at a radius of {r / MM:g} mm")]
            if h < low - 1e-9:
                return [("outline", f"`outline` comes back down to {h / MM:g} mm; hollow faces are not known")]
            if isinstance(piece, OutlineArc):
                if abs(dist(start, piece.centre) - piece.radius) > 1e-5:
                    return [
                        (
                            "outline",
                            f"the centre of an arc of `outline` is not as far from {_text(start)} as "
                            f"from {_text(piece.to)}",
                        )
                    ]
                if _dips(start, piece):
                    return [("outline", f"an arc of `outline` to {_text(piece.to)} comes back down on its way")]
            low = h
        if not low > 0.0:
            return [("outline", "`outline` has no height")]
        return FormCutter.problems(self)


def _text(point: tuple[float, float]) -> str:
    return f"[{point[0] / MM:g}, {point[1] / MM:g}]"


def _dips(start: tuple[float, float], arc: OutlineArc) -> bool:
    """Whether an arc passes below its start or above its end."""
    from gcodesim.arithmetic.elementary import sin

    begin, turn = arc.angles(start)
    heights = [arc.centre[1] + arc.radius * float(sin(begin + turn * k / 64)) for k in range(65)]
    return any(b < a - 1e-9 for a, b in pairwise(heights))
