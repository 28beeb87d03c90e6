"""Stocks that stand in another one: which of them a beam or a nozzle meets together with it."""

from __future__ import annotations

from collections.abc import Mapping

from gcodesim.frames import Pose
from gcodesim.shop.shop import PlacedStock

Part = tuple[PlacedStock, Pose]
"""A part and its frame in that of the whole."""


def assembled(stocks: Mapping[str, PlacedStock]) -> dict[str, list[Part]]:
    """The parts of each stock that has some, by its name."""
    found: dict[str, list[Part]] = {}
    for part in stocks.values():
        whole = _whole_of(part, stocks)
        if whole is not None:
            found.setdefault(whole.name, []).append((part, part.seen_from(whole)))
    return found


def _whole_of(part: PlacedStock, stocks: Mapping[str, PlacedStock]) -> PlacedStock | None:
    """The stock in which a part stands; None of what stands in none, or turns in a lathe."""
    whole = part
    while whole.spec.inside is not None:
        around = stocks.get(whole.spec.inside)
        if around is None:
            return None
        whole = around
    return None if whole is part or part.revolved or whole.revolved else whole
