"""Parameters that have a value before the program begins, named by whoever starts it: `#100`, `#<depth>`."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping

from gcodesim.diagnostics import Diagnostic, SourceText, Span
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.parameters import Parameters

_WRITTEN = re.compile(
    r"#?\s*(?:<\s*(?P<named>[^<>]+)>|(?P<number>[0-9]+)|(?P<bare>[A-Za-z_][A-Za-z0-9_ ]*(?:\[[^\[\]<>]+\])?))\s*"
)
_NOTES = re.compile(r"\((?!\s*(?:debug|print|log|msg)\s*,)[^)]*\)?|;.*", re.IGNORECASE)
_COMPUTED = re.compile(r"#\s*[\[#]")
Parameter = int | str
"""The number of a parameter, or its name as controls compare it: small letters, no blanks."""


def parameter_of(text: str) -> Parameter | None:
    """The parameter that `#100`, `100`, `#<depth>`, `depth` or `_hal[pin]` means; None for any other text."""
    match = _WRITTEN.fullmatch(text.strip())
    if match is None:
        return None
    if match["number"]:
        return int(match["number"])
    return re.sub(r"\s", "", match["named"] or match["bare"]).lower()


def as_written(parameter: Parameter) -> str:
    """`#100` or `#<depth>`."""
    return f"#{parameter}" if isinstance(parameter, int) else f"#<{parameter}>"


def preset(parameters: Parameters, values: Mapping[Parameter, float]) -> list[Fault]:
    """Give parameters their values before the first block; the faults of those that cannot have one."""
    faults = []
    for parameter, value in values.items():
        try:
            parameters.preset(parameter, value)
        except Fault as fault:
            faults.append(fault)
    parameters.commit()
    return faults


def unused_presets(
    source: SourceText, others: Iterable[SourceText], values: Mapping[Parameter, float]
) -> list[Diagnostic]:
    """GS144 for each value that cannot have an effect, as far as the texts of a program and its subprograms tell.

    Either no text names the parameter, or the program itself gives it a value in the line that names it first. A number
    that is computed (`#[…]`, `##…`) may be any.
    """
    texts = [_code(source), *(_code(other) for other in others if other.name != source.name)]
    computed = any(_COMPUTED.search(line) for text in texts for line in text)
    found = []
    for parameter in values:
        if isinstance(parameter, int) and computed:
            continue
        named = _named(parameter)
        line = next((number for number, text in enumerate(texts[0], 1) if named.search(text)), None)
        if line is None:
            if not any(named.search(text) for other in texts[1:] for text in other):
                message = f"no line reads {as_written(parameter)}, which was given a value before the program began"
                hint = "a program takes it as it takes any parameter: G1 Z-#<depth>"
                found.append(Diagnostic(code="GS144", span=Span(source.name), message=message, hint=hint))
        elif _is_set_first(named, texts[0][line - 1]):
            found.append(
                Diagnostic(
                    code="GS144",
                    span=Span.of_line(source.name, line, source.lines[line - 1]),
                    message=f"the program itself sets {as_written(parameter)} before it reads what was given",
                    hint=_how_to_keep(parameter),
                )
            )
    return found


def _code(source: SourceText) -> list[str]:
    """The lines without comments; messages stay, because they show values."""
    return [_NOTES.sub("", line) for line in source.lines]


def _named(parameter: Parameter) -> re.Pattern[str]:
    if isinstance(parameter, int):
        return re.compile(rf"#\s*0*{parameter}(?![0-9.])")
    letters = r"\s*".join(re.escape(letter) for letter in parameter)
    return re.compile(rf"#\s*<\s*{letters}\s*>", re.IGNORECASE)


def _is_set_first(named: re.Pattern[str], text: str) -> bool:
    """Whether a line gives the parameter a value and does not read it; values are read before any is set."""
    places = list(named.finditer(text))
    return bool(places) and all(re.match(r"\s*=(?!=)", text[place.end() :]) for place in places)


def _how_to_keep(parameter: Parameter) -> str:
    if isinstance(parameter, int):
        return "delete that line, or let it depend on another parameter"
    written = as_written(parameter)
    return f"delete that line, or set it only where it has no value: `O1 IF [EXISTS[{written}] EQ 0]` before it"
