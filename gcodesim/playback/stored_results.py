"""Results from a log or a folder, which anybody may have edited since."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any, Final

from gcodesim.files.output_folder import RESULTS_NAME
from gcodesim.log.event import LogEvent
from gcodesim.log.logfile import LogFile
from gcodesim.numbers import read_json

_NUMBER: Final = (int, float)
_TEXT: Final = (str,)
_PARTS: Final[Mapping[str, tuple[type, ...]]] = {
    "status": _TEXT,
    "inputs": (dict,),
    "findings": (list,),
    "time": (dict,),
    "distance": (dict,),
    "stocks": (dict,),
    "tools": (list,),
    "joints": (list,),
    "not_simulated": (list,),
}
_OPTIONAL: Final = (*_NUMBER, type(None))
_OF_JOINTS: Final = ("least", "most", "margin", "max_speed", "max_acceleration", "max_effort")
_OF_OPERATIONS: Final = (
    *("tool", "first_line", "last_line", "time_s", "feed_mm"),
    *("mean_feed_mm_min", "least_feed_mm_min", "share_at_feed"),
)
_ENTRIES: Final[Mapping[str, Mapping[str, tuple[type, ...]]]] = {
    "findings": {"code": _TEXT, "severity": _TEXT, "message": _TEXT, "file": _TEXT, "line": (int,)},
    "tools": {"number": (int,), "time_s": _NUMBER, "removed_mm3": _NUMBER, "feed_mm": _OPTIONAL},
    "joints": {"name": _TEXT, "unit": _TEXT, **dict.fromkeys(_OF_JOINTS, _OPTIONAL)},
    "not_simulated": {"word": _TEXT, "count": (int,)},
    "operations": {"name": _TEXT, **dict.fromkeys(_OF_OPERATIONS, _NUMBER)},
}
_WITH_UNIT: Final = re.compile(r".*_(?:s|mm[23]?|mm_min|um|deg|N|Nm|W|J|J_m2?)")
_LISTED: Final = ("_mm", "inertia_kg_mm2")
"""How names of quantities end that are lists: places, outlines, tensors."""
_MOST: Final = 1e15
"""No quantity of a run is as large as this in its unit."""
_SEVERITIES: Final = ("note", "warning", "error")


class NoResultsError(ValueError):
    """The content is not a set of results of gcodesim; the text says why."""


def results_from(data: bytes) -> dict[str, Any]:
    """The results in the bytes of a `results.json`; NoResultsError if a part is missing or of the wrong kind."""
    try:
        value = read_json(data)
    except ValueError as error:
        raise NoResultsError(f"it is no JSON: {error}") from None
    if not isinstance(value, dict):
        raise NoResultsError("it is no object")
    for key, kinds in _PARTS.items():
        if not isinstance(value.get(key), kinds):
            raise NoResultsError(f"there is no proper `{key}`")
    for key, fields in _ENTRIES.items():
        for entry in _list_of(value, key):
            if not isinstance(entry, dict):
                raise NoResultsError(f"an entry of `{key}` is none")
            for name, kinds in fields.items():
                if not isinstance(entry.get(name), kinds):
                    raise NoResultsError(f"an entry of `{key}` has no proper `{name}`")
    for finding in value["findings"]:
        if finding["severity"] not in _SEVERITIES or not isinstance(finding.get("time_s"), _OPTIONAL):
            raise NoResultsError("an entry of `findings` has no proper severity or time")
    if not all(isinstance(seconds, _NUMBER) for seconds in value["time"].values()):
        raise NoResultsError("there is no proper `time`")
    _check_quantities(value)
    return value


def _list_of(value: dict[str, Any], key: str) -> list[Any]:
    """A list of the results, empty if there is none."""
    found = value.get(key, [])
    if not isinstance(found, list):
        raise NoResultsError(f"there is no proper `{key}`")
    return found


def _check_quantities(value: Any, key: str = "") -> None:
    """NoResultsError where a name has a unit and no number, and where a list has an empty entry."""
    if isinstance(value, dict) and not _WITH_UNIT.fullmatch(key):
        for name, inner in value.items():
            _check_quantities(inner, name)
    elif isinstance(value, list):
        no_list = bool(_WITH_UNIT.fullmatch(key)) and not key.endswith(_LISTED)
        for inner in value:
            if inner is None or no_list:
                raise NoResultsError(f"an entry of `{key}` is none")
            _check_quantities(inner, key)
    elif _WITH_UNIT.fullmatch(key) and value is not None and not (isinstance(value, _NUMBER) and abs(value) < _MOST):
        raise NoResultsError(f"`{key}` is no number")


def final_findings(log: LogFile, told: tuple[LogEvent, ...]) -> tuple[LogEvent, ...]:
    """The findings of the results in the log; if it has none, `told`, which are those of its events.

    A finding without a time of its own gets that of its event.
    """
    data = log.attached(RESULTS_NAME)
    try:
        findings = results_from(data)["findings"] if data is not None else None
    except NoResultsError:
        findings = None
    if findings is None:
        return told
    times = {(event.code, event.file, event.line): event.t_ns for event in told}
    values = {(event.code, event.file, event.line): event.value for event in told}
    found = []
    for one in findings:
        place = (one["code"], one["file"], one["line"])
        seconds = one.get("time_s")
        found.append(
            LogEvent(
                t_ns=times.get(place, 0) if seconds is None else round(seconds * 1e9),
                code=one["code"],
                severity=one["severity"],
                file=one["file"],
                line=one["line"],
                message=one["message"],
                value=values.get(place, 0.0),
            )
        )
    return tuple(found)
