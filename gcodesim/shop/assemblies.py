"""Stocks that stand in another one: which of them a beam or a nozzle meets together with it."""

from __future__ import annotations

from collections.abc import Mapping

from gcodesim.frames import Array
from gcodesim.shop.shop import PlacedStock

Part = tuple[PlacedStock, Array]
"""A part and its origin (3,) [m] in the frame of the whole."""


def assembled(stocks: Mapping[str, PlacedStock]) -> dict[str, list[Part]]:
    """The parts of each stock that has some with its own axes, by its name."""
    found: dict[str, list[Part]] = {}
    for part in stocks.values():
        whole = _whole_of(part, stocks)
        origin = None if whole is None else part.origin_in(whole)
        if whole is not None and origin is not None:
            found.setdefault(whole.name, []).append((part, origin))
    return found


def turned_parts(stocks: Mapping[str, PlacedStock]) -> list[tuple[PlacedStock, PlacedStock]]:
    """The parts whose axes are not those of the stock that they stand in, with that."""
    pairs = [(part, _whole_of(part, stocks)) for part in stocks.values()]
    return [(part, whole) for part, whole in pairs if whole is not None and part.origin_in(whole) is None]


def _whole_of(part: PlacedStock, stocks: Mapping[str, PlacedStock]) -> PlacedStock | None:
    """The stock in which a part stands; None of what stands in none, or turns in a lathe."""
    whole = part
    while whole.spec.inside is not None:
        around = stocks.get(whole.spec.inside)
        if around is None:
            return None
        whole = around
    return None if whole is part or part.revolved or whole.revolved else whole
