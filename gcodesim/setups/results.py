"""The results of all set-ups of a job, as `setups.json` has them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final

from gcodesim.numbers import rounded
from gcodesim.setups.running import SetupRun

SCHEMA: Final = "gcodesim-setups/1"
_ORDER: Final = ("ok", "findings", "failed")
_SUMMED: Final = ("time", "distance")


def setups_as_json(done: Sequence[SetupRun]) -> dict[str, Any]:
    """The worst status, times and distances of all together, and the `results.json` of each by name."""
    return {
        "schema": SCHEMA,
        "status": max((str(one.results["status"]) for one in done), key=_ORDER.index, default=_ORDER[0]),
        **{what: _sum([one.results[what] for one in done]) for what in _SUMMED},
        "setups": {one.setup.name: dict(one.results) for one in done},
    }


def _sum(each: Sequence[Mapping[str, float]]) -> dict[str, float]:
    names = dict.fromkeys(name for one in each for name in one)
    return {name: rounded(sum(one.get(name, 0.0) for one in each)) for name in names}


def setup_rows(done: Sequence[SetupRun]) -> list[list[str]]:
    """A row for each set-up: time, volumes, deviation from the target; and one for all."""
    rows = [["set-up", "time", "removed", "remaining", "deviation", ""]]
    for one in done:
        rows.append([one.setup.name, f"{one.results['time']['total_s']:.1f} s", *_volumes(one.results), one.state])
    total = sum(one.results["time"]["total_s"] for one in done)
    return [*rows, ["all", f"{total:.1f} s", "", "", "", ""]]


def _volumes(results: Mapping[str, Any]) -> list[str]:
    stocks = list(results["stocks"].values())
    if not stocks:
        return ["-", "-", "-"]
    volumes = [f"{sum(stock[what] for stock in stocks):.1f} mm³" for what in ("removed_mm3", "remaining_mm3")]
    target = results.get("target")
    if not target:
        return [*volumes, "-"]
    return [*volumes, f"{target['least_deviation_mm']:+.3f} to {target['most_deviation_mm']:+.3f} mm"]
