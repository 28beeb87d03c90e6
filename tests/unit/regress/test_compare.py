"""Comparison of results by quantity and tolerance."""

from copy import deepcopy

import pytest

from gcodesim.regress import compare_results

OLD = {
    "schema": "gcodesim-results/1",
    "status": "ok",
    "inputs": {"program": {"sha256": "a"}},
    "findings": [{"code": "GS195", "severity": "note", "message": "no G43", "line": 2}],
    "time": {"total_s": 10.0},
    "stocks": {"stock": {"removed_mm3": 656.5, "error_bound_mm3": 3.0}},
    "tools": [{"number": 1, "max_force_N": 80.0, "line_of_max_force": 7}],
}


def changed(*path: object, to: object) -> dict[str, object]:
    new = deepcopy(OLD)
    place: object = new
    for key in path[:-1]:
        place = place[key]  # type: ignore[index]
    place[path[-1]] = to  # type: ignore[index]
    return new


def test_a_run_equals_itself() -> None:
    assert compare_results(OLD, deepcopy(OLD)) == []


@pytest.mark.parametrize(
    "new",
    [
        changed("inputs", "program", "sha256", to="b"),
        changed("tools", 0, "line_of_max_force", to=8),
        changed("time", "total_s", to=10.009),
        changed("stocks", "stock", "removed_mm3", to=656.9),
    ],
)
def test_what_does_not_count(new: dict[str, object]) -> None:
    assert compare_results(OLD, new) == []


@pytest.mark.parametrize(
    ("new", "quantity"),
    [
        (changed("time", "total_s", to=10.02), "time.total_s"),
        (changed("stocks", "stock", "removed_mm3", to=687.9), "stocks.stock.removed_mm3"),
        (changed("tools", 0, "max_force_N", to=82.0), "tools.1.max_force_N"),
        (changed("status", to="failed"), "status"),
        (changed("tools", to=[]), "tools.1"),
    ],
)
def test_what_counts_is_named(new: dict[str, object], quantity: str) -> None:
    (change,) = compare_results(OLD, new)
    assert change.quantity == quantity
    assert change.text.startswith(quantity)


def test_an_entry_more_does_not_shift_the_others() -> None:
    new = deepcopy(OLD)
    new["tools"] = [{"number": 2, "max_force_N": 5.0}, *OLD["tools"]]  # type: ignore[misc]
    assert [change.quantity for change in compare_results(OLD, new)] == ["tools.2"]


@pytest.mark.parametrize(
    ("unit", "units"), [("deg", ["deg", "deg/s", "deg/s²", "N·m"]), ("mm", ["mm", "mm/s", "mm/s²", "N"])]
)
def test_numbers_of_joints_have_the_units_of_their_motion(unit: str, units: list[str]) -> None:
    joint = {"name": "arm/j", "unit": unit, "least": 0, "max_speed": 10, "max_acceleration": 100, "max_effort": 50}
    new = {**joint, "least": -5, "max_speed": 20, "max_acceleration": 200, "max_effort": 90}
    changes = compare_results({"joints": [joint]}, {"joints": [new]})
    assert [change.unit for change in changes] == units
    assert [change.unit for change in compare_results(OLD, changed("time", "total_s", to=20.0))] == ["s"]
