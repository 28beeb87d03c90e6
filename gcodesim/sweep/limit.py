"""Limits of a study, `force > 400 N`: what a run must not be."""

from __future__ import annotations

import re
from typing import Any, Final

from gcodesim.declarations.kind import Json, Kind, scalar, short
from gcodesim.declarations.nodes import Node, Scalar
from gcodesim.declarations.quantity import Quantity
from gcodesim.declarations.reading import UNREAD, Path, Reading, Unread, suggestion
from gcodesim.declarations.scalars import measured
from gcodesim.declarations.units import find, in_unit
from gcodesim.frozen import frozen
from gcodesim.sweep.measure import Figures, dimension_of, figure, names

_FORM: Final = re.compile(r"\s*(?P<what>[A-Za-z_][\w./ -]*?)\s*(?P<sign><=|>=|<|>)\s*(?P<value>\S.*)")
_WORDS: Final = {">": "above", ">=": "at or above", "<": "below", "<=": "at or below"}


@frozen
class StudyLimit:
    """A run fails if the figure `what` (a name, or a path of the results) is on the wrong side of `value` [`unit`]."""

    what: str
    sign: str
    value: float
    unit: str
    text: str

    def excess(self, figures: Figures) -> float | None:
        """By how much the limit is broken, as a share of it (of 1 where it is 0): at most 0 where it is not.

        None if the run has no such figure.
        """
        value = figure(self.what, figures)
        if value is None:
            return None
        beyond = value - self.value if self.sign[0] == ">" else self.value - value
        return beyond / (abs(self.value) or 1.0)

    def is_broken(self, figures: Figures) -> bool:
        """Whether a run breaks the limit; one without the figure does not."""
        excess = self.excess(figures)
        return excess is not None and (excess > 0.0 or (excess == 0.0 and self.sign.endswith("=")))

    def broken_text(self, figures: Figures) -> str:
        value = figure(self.what, figures)
        shown = "" if value is None else f"{value:.6g}"
        unit = f" {self.unit}" if self.unit else ""
        return f"{self.what} is {shown}{unit}, {_WORDS[self.sign]} {self.value:.6g}{unit}"


@frozen(kw_only=False)
class LimitKind(Kind):
    """A figure, a sign and a value."""

    @property
    def expected(self) -> str:
        return "a limit such as `force > 400 N`"

    def read(self, node: Node, to: Reading, path: Path) -> StudyLimit | Unread:
        text = scalar(self, node, to, path)
        if isinstance(text, Unread):
            return UNREAD
        match = _FORM.fullmatch(text.text)
        if match is None:
            return to.fault("GS711", text.span, f"`{short(text.text)}` is no limit; {self.expected} is expected")
        what = match["what"]
        if "." not in what and what not in names():
            return to.fault("GS711", text.span, f"there is no figure `{short(what)}`", figure_hint(what))
        return self._with_value(what, match["sign"], match["value"], text, to, path)

    def _with_value(
        self, what: str, sign: str, written: str, text: Scalar, to: Reading, path: Path
    ) -> StudyLimit | Unread:
        value = Scalar(span=text.span, text=written)
        if "." in what:  # a path, whose name says the unit
            number = measured(written)
            if number is None or number.unit:
                message = f"`{short(written)}` is no number; a path of the results has its unit in its name"
                return to.fault("GS707", text.span, message, f"such as `{what} {sign} 400`")
            return StudyLimit(what=what, sign=sign, value=number.value, unit="", text=text.text.strip())
        dimension, unit = dimension_of(what)
        read = Quantity(dimension).read(value, to, (*path[:-1], what))
        if isinstance(read, Unread):
            return UNREAD
        shown = find(unit, dimension) if unit else None
        in_shown = read if shown is None else in_unit(read, shown)
        return StudyLimit(what=what, sign=sign, value=in_shown, unit=unit, text=text.text.strip())

    def schema(self, definitions: dict[str, Json]) -> Json:
        return {"type": "string", "pattern": "^.+(<|>)=?.+$", "examples": ["force > 400 N"]}

    def show(self, value: Any) -> Any:
        return value.text


@frozen(kw_only=False)
class FigureKind(Kind):
    """The name of a figure, or a path of the results."""

    @property
    def expected(self) -> str:
        return "a figure such as `force`, or a path of `results.json` such as `tools.1.max_power_W`"

    def read(self, node: Node, to: Reading, path: Path) -> str | Unread:
        text = scalar(self, node, to, path)
        if isinstance(text, Unread):
            return UNREAD
        if "." not in text.text and text.text not in names():
            return to.fault("GS711", text.span, f"there is no figure `{short(text.text)}`", figure_hint(text.text))
        return text.text

    def schema(self, definitions: dict[str, Json]) -> Json:
        return {"type": "string"}


def figure_hint(what: str) -> str:
    """What a figure that is not known may be meant to be."""
    near = suggestion(what, names())
    return f"figures are {', '.join(names())}" if near.startswith("known") else near
