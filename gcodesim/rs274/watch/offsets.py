"""Shifts of the origin that outlive the program."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from gcodesim.diagnostics import Diagnostic, Span
from gcodesim.rs274.dialects.linuxcnc import NON_MODAL, SHIFT
from gcodesim.rs274.state import LINEAR, ZERO, Vector
from gcodesim.rs274.watch.watch import Watch, word_span
from gcodesim.rs274.words import Words

if TYPE_CHECKING:
    from gcodesim.rs274.control import Control

_SHIFTS = {520: ("G52", "G52 X0 Y0 Z0"), 920: ("G92", "G92.1"), 923: ("G92.3", "G92.1")}
_LETTERS = "XYZABCUVW"


class OffsetsLeftOn(Watch):
    """GS187: a shift (G52, G92) or a figure, such as a turn or mirror image, is in force when the program ends.

    A control keeps them for the next program. G54 comes back by itself, so the work system does not matter.
    """

    def __init__(self) -> None:
        self._control: Control | None = None
        self._shift: tuple[str, Span] | None = None
        self._figures: dict[int, Span] = {}

    def block(self, words: Words, control: Control) -> None:
        self._control = control
        code = 923 if words.g.get(SHIFT) == 923 else words.g.get(NON_MODAL)
        if (code in _SHIFTS and words.has_axes()) or code == 923:
            assert code is not None
            name = _SHIFTS[code][0]
            self._shift = (name, word_span(words, name.lower(), control))
        for group, figure in control.dialect.figures.items():
            if group in words.g:
                self._figures.pop(group, None)
                if words.g[group] == figure.on:
                    self._figures[group] = word_span(words, figure.name.lower(), control)

    def findings(self, *, finished: bool) -> Iterable[Diagnostic]:
        control = self._control
        if not finished or control is None:
            return
        shift = control.shift()
        if self._shift is not None and shift != ZERO:
            name, span = self._shift
            unit = "in" if control.state.unit > 2e-3 else "mm"
            off = control.dialect.shift_off or next(cancel for known, cancel in _SHIFTS.values() if known == name)
            yield self._left(
                f"{name}: the next program would be off by {_shown(shift, unit)}", span, f"cancel it by {off}"
            )
        for group, span in self._figures.items():
            _, name, off = control.dialect.figures[group]
            yield self._left(f"{name}: the next program would be drawn the same way", span, f"cancel it by {off}")

    @staticmethod
    def _left(what: str, span: Span, hint: str) -> Diagnostic:
        return Diagnostic(
            code="GS187", message=f"left in force at the end of the program, {what}", span=span, hint=hint
        )


def _shown(shift: Vector, unit: str) -> str:
    """`X20 Y5 mm, A10 deg`."""
    parts = []
    for is_linear, its_unit in ((True, unit), (False, "deg")):
        words = [
            f"{letter}{value:g}"
            for letter, value, linear in zip(_LETTERS, shift, LINEAR, strict=True)
            if value and linear is is_linear
        ]
        parts += [f"{' '.join(words)} {its_unit}"] * bool(words)
    return ", ".join(parts)
