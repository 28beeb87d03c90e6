"""Settings that a printer keeps until others are said: what has to be said again where a print is taken up."""

from __future__ import annotations

from typing import Final

from gcodesim.rs274.marlin.line import MarlinLine

Key = tuple[str, frozenset[str], float]
"""What a line sets: the command, the letters or names that say which of its settings, and the tool or fan."""

HEATERS: Final = {"M104": "M109", "M140": "M190", "M141": "M191"}
"""Commands that heat a nozzle, the bed and the chamber, and those that wait for it."""

_SAME: Final = {**{wait: heat for heat, wait in HEATERS.items()}, "M107": "M106", "G21": "G20"}
_SWITCHES: Final = frozenset((*HEATERS, "M106", "G20"))
"""Of these the last one counts, whatever its letters are."""

_KEPT: Final = frozenset(
    (
        *_SWITCHES,
        *_SAME,
        *("M200", "M201", "M203", "M204", "M205", "M207", "M208", "M218", "M220", "M221", "M566"),
        *("G10", "M116"),
        *("M302", "M420", "M425", "M572", "M593", "M900"),
        *("SET_VELOCITY_LIMIT", "SET_RETRACTION", "SET_PRESSURE_ADVANCE", "SET_FAN_SPEED", "SET_INPUT_SHAPER"),
        *("SET_HEATER_TEMPERATURE", "TEMPERATURE_WAIT"),
    )
)
_WHICH: Final = frozenset(("EXTRUDER", "FAN", "HEATER", "SENSOR"))
"""Names of macros that say which one is meant."""
_BY_P: Final = frozenset(("M106", "G10"))
_OF_A_TOOL: Final = frozenset(("M104", "M200", "M221"))


def is_said_again(word: str) -> bool:
    """Whether a word that is not simulated, as `M104` or `macro SET_FAN_SPEED`, is said again."""
    return word.removeprefix("macro ").partition(" ")[0] in _KEPT


def remember(said: dict[Key, str], line: MarlinLine, tool: int) -> None:
    """Keep what `line` sets while nozzle `tool` is chosen; `said` has the lines in their order."""
    if line.name not in _KEPT or (
        line.name == "G10" and (line.get("l") in (2.0, 20.0) or not line.has("psrxyzl"))
    ):  # work systems are in the names of places, and a retraction is said apart
        return
    group = _SAME.get(line.name, line.name)
    values = {letter: value for letter, value in line.values.items() if value is not None}
    index = values.get("t", values.get("p", 0.0) if group in _BY_P else 0.0)
    if group in _OF_A_TOOL and "t" not in values:
        index = float(tool)
        values |= {"t": index} if tool else {}
    named = (name if name not in _WHICH else f"{name}={value}" for name, value in line.settings.items())
    letters = frozenset() if group in _SWITCHES else frozenset((*line.values, *named))
    key = (group, letters, index)
    said.pop(key, None)
    words = " ".join(
        letter.upper() + ":".join(map(_shown, line.lists.get(letter, (value,)))) for letter, value in values.items()
    )
    if group in HEATERS:
        said[key] = words
    else:
        said[key] = f"{line.name} {line.text if line.is_macro else words}".strip()


def _shown(value: float) -> str:
    return f"{value:.6f}".rstrip("0").rstrip(".")
