"""Results from a log or a folder, which anybody may have edited since."""

from __future__ import annotations

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
    "findings": (list,),
    "time": (dict,),
    "distance": (dict,),
    "stocks": (dict,),
    "tools": (list,),
    "joints": (list,),
    "not_simulated": (list,),
}
_ENTRIES: Final[Mapping[str, Mapping[str, tuple[type, ...]]]] = {
    "findings": {"code": _TEXT, "severity": _TEXT, "message": _TEXT, "file": _TEXT, "line": (int,)},
    "tools": {"number": (int,), "time_s": _NUMBER, "removed_mm3": _NUMBER},
    "joints": {"name": _TEXT, "unit": _TEXT},
    "not_simulated": {"word": _TEXT, "count": (int,)},
}
_OPTIONAL: Final = (*_NUMBER, type(None))
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
        for entry in value[key]:
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
    return value


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
