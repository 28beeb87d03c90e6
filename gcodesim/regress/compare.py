"""Compares two results, quantity by quantity."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Final

from gcodesim.regress.changes import Change
from gcodesim.regress.tolerance import DEFAULTS, QUANTITIES, Tolerances, quantity_of

TOOL_PACES: Final = ("mean_feed_mm_min", "least_feed_mm_min", "share_at_feed", "air_share")
"""How fast feed moves of a tool ran."""

# keys that identify a run or place a number, but are not results; findings are compared separately
_NOT_COMPARED: Final = frozenset(
    {
        "operations",  # as their comments call them; what they are made of is compared
        "body",  # it follows from the surface
        *TOOL_PACES,  # they follow from the time law, as the times do
        *("inputs", "schema", "findings", "stopped_at"),
        *("line_of_max_force", "line_of_margin", "first_line", "error_bound_mm3"),
        *("file", "line"),  # of a probing move, or a mark
        *("program", "blocks"),  # of one of several programs
        *("line_of_AT", "time_of_AT_s"),
    }
)
INCOMPLETE: Final = "incomplete"
"""The status of a run whose log ends before its results."""

_BROKEN: Final = ("failed", INCOMPLETE)
_NAMES: Final = ("number", "name", "word")


def compare_results(old: Mapping[str, Any], new: Mapping[str, Any], tolerances: Tolerances = DEFAULTS) -> list[Change]:
    """What differs in meaning between two contents of `results.json` besides findings, in the order of the file.

    Hashes, names of inputs and line numbers do not count.
    """
    return list(_compare("", old, new, tolerances))


def _compare(path: str, old: Any, new: Any, tolerances: Tolerances, of_joint: str = "") -> Iterator[Change]:
    """`of_joint`: the unit of the joint that the values are of."""
    if isinstance(old, Mapping) and isinstance(new, Mapping):
        of_joint = str(new.get("unit", of_joint))
        for key in [*old, *(key for key in new if key not in old)]:
            if key not in _NOT_COMPARED:
                yield from _compare(f"{path}.{key}" if path else key, old.get(key), new.get(key), tolerances, of_joint)
    elif isinstance(old, list) and isinstance(new, list):
        yield from _compare(path, _by_name(old), _by_name(new), tolerances)
    elif is_number(old) and is_number(new):
        if not tolerances[quantity_of(path)].allows(old, new):
            yield change_of(path, old, new, tolerances, of_joint)
    elif path == "status":
        # whether findings count depends on the options of a run; the findings themselves are compared
        if (old in _BROKEN) != (new in _BROKEN) or (old != new and INCOMPLETE in (old, new)):
            yield Change(quantity=path, old=old, new=new)
    elif old != new:
        yield Change(quantity=path, old=old, new=new)


def change_of(path: str, old: float, new: float, tolerances: Tolerances, of_joint: str = "") -> Change:
    """The change of a number, with what its tolerance allows and its unit."""
    name = quantity_of(path)
    unit = QUANTITIES[name].unit or _joint_unit(name, of_joint)
    return Change(quantity=path, old=old, new=new, allowed=tolerances[name].limit(old), tolerance=name, unit=unit)


def _joint_unit(quantity: str, unit: str) -> str:
    """The unit of a quantity of a joint that moves in `unit`, deg or mm."""
    match quantity:
        case "joint":
            return unit
        case "joint_speed":
            return f"{unit}/s"
        case "joint_acceleration":
            return f"{unit}/s²"
        case "joint_effort":
            return "N" if unit == "mm" else "N·m"
        case _:
            return ""


def is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _by_name(entries: Sequence[Any]) -> dict[str, Mapping[str, Any]]:
    """List entries by their own names, so that an additional entry does not shift all others.

    Entries without names, as the points of an outline, are left out: surfaces are compared by themselves.
    """
    named = [(i, entry) for i, entry in enumerate(entries) if isinstance(entry, Mapping)]
    return {entry_name(entry, i): entry for i, entry in named}


def entry_name(entry: Mapping[str, Any], index: int) -> str:
    """The name of an entry in a list: its own, after that of its channel if it has one; else its place."""
    name = next((entry[name] for name in _NAMES if name in entry), None)
    if name is None:
        return str(index)
    return f"{entry['channel']}/{name}" if "channel" in entry else str(name)


def value_at(results: Mapping[str, Any], path: str) -> Any:
    """The value at a path such as ``tools.1.max_force_N``; KeyError when there is none.

    Names may contain dots (`stocks.my.stock.removed_mm3`): the longest key that fits is taken.
    """
    if not path:
        return results
    inner = {key: _by_name(value) if isinstance(value, list) else value for key, value in results.items()}
    for key in sorted(inner, key=len, reverse=True):
        if path == key:
            return inner[key]
        if path.startswith(f"{key}.") and isinstance(inner[key], Mapping):
            return value_at(inner[key], path[len(key) + 1 :])
    raise KeyError(path)


def paths_of(results: Mapping[str, Any], prefix: str = "") -> list[str]:
    """The paths of all numbers and words of the results."""
    found: list[str] = []
    for key, value in results.items():
        path = f"{prefix}{key}"
        inner = _by_name(value) if isinstance(value, list) else value
        if isinstance(inner, Mapping):
            found += [] if key in _NOT_COMPARED else paths_of(inner, f"{path}.")
        elif key not in _NOT_COMPARED:
            found.append(path)
    return found
