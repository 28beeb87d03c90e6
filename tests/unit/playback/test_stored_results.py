"""Results that somebody has edited are refused as a whole; nothing behind them meets a value of a wrong kind."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from gcodesim.playback.stored_results import NoResultsError, results_from
from gcodesim.regress.compare import paths_of


def results() -> dict[str, Any]:
    """What a short run leaves, with an entry of each kind."""
    return {
        "status": "ok",
        "inputs": {"gcodesim": "0.1.0", "seed": 1},
        "findings": [],
        "time": {"total_s": 9.1, "feed_s": 8.0},
        "distance": {"feed_mm": 57},
        "stocks": {"stock": {"material": "pom", "removed_mm3": 656.5, "remaining_mm3": 1.0}},
        "tools": [{"number": 1, "time_s": 9.1, "removed_mm3": 656.5, "max_power_W": 532.5, "max_force_N": None}],
        "operations": [
            {"name": "slot", "tool": 1, "first_line": 8, "last_line": 12, "time_s": 9.1, "feed_mm": 57, "rapid_mm": 8}
            | {"mean_feed_mm_min": 482.4, "least_feed_mm_min": 0, "share_at_feed": 0.999}
        ],
        "joints": [{"name": "machine/X", "unit": "mm", "least": 0, "most": 1, "margin": None}],
        "not_simulated": [{"word": "M8", "count": 2}],
        "target": {"high_mm": [1.0, 2.0, 3.0], "profiles_z_r_mm": [[[0.0, 1.0]]]},
    }


def edited(path: str, value: Any) -> bytes:
    """The results with another value at a path."""
    whole = results()
    *way, last = [int(step) if step.isdigit() else step for step in path.split(".")]
    inner: Any = whole
    for step in way:
        inner = inner[step]
    inner[last] = value
    return json.dumps(whole).encode()


def test_results_of_a_run_are_taken_as_they_are() -> None:
    assert results_from(json.dumps(results()).encode()) == results()


def test_what_a_run_writes_is_taken(slot_folder: Path) -> None:
    data = (slot_folder / "results.json").read_bytes()
    assert results_from(data) == json.loads(data)


@pytest.mark.parametrize(
    ("path", "value"),
    [
        ("inputs", "x"),
        ("stocks.stock.remaining_mm3", [None]),
        ("stocks.stock.removed_mm3", {"a": [1]}),
        ("time.total_s", 1e308),
        ("time.total_s", "x"),
        ("tools.0.max_power_W", "x"),
        ("tools.0.max_power_W", [[]]),
        ("tools.0.feed_mm", []),
        ("tools.0", None),
        ("operations", 3),
        ("operations.0", []),
        ("operations.0.least_feed_mm_min", None),
        ("operations.0.name", 5),
        ("joints.0.margin", "x"),
        ("target.high_mm", [1.0, None]),
    ],
)
def test_a_value_of_a_wrong_kind_is_refused(path: str, value: Any) -> None:
    with pytest.raises(NoResultsError):
        results_from(edited(path, value))


def test_empty_entries_of_lists_have_no_path() -> None:
    assert paths_of({"tools": [None, {"name": "T1", "time_s": 1.0}]}) == ["tools.T1.name", "tools.T1.time_s"]
