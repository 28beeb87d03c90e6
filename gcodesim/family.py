"""A family is a closed table of variants that load on first use.

A variant is one file and one line in its family's table. Third parties add
theirs by an entry point of group ``gcodesim.<family>``; contract tests run over
the whole table and so find every newcomer.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from importlib import import_module
from typing import Any


class Family(Mapping[str, Any]):
    """Names of variants and where they live; `family[name]` imports and returns the variant."""

    def __init__(self, name: str, **entries: str) -> None:
        self.name = name
        self._entries = dict(entries)
        self._own = tuple(entries)
        self._loaded: dict[str, Any] = {}
        self._searched = False

    def _table(self) -> dict[str, str]:
        if not self._searched:
            from importlib.metadata import entry_points  # costs 20 ms, so only when somebody asks for a family

            for point in entry_points(group=f"gcodesim.{self.name}"):
                self._entries.setdefault(point.name, point.value)
            self._searched = True
        return self._entries

    def in_order(self, names: Iterable[str]) -> tuple[str, ...]:
        """These names in the order of the table, then those of third parties in alphabetical order."""
        wanted = set(names)
        return (*(name for name in self._own if name in wanted), *sorted(wanted.difference(self._own)))

    def __getitem__(self, key: str) -> Any:
        if key not in self._loaded:
            place = self._entries.get(key) or self._table()[key]
            module, _, attribute = place.partition(":")
            self._loaded[key] = getattr(import_module(module), attribute)
        return self._loaded[key]

    def __iter__(self) -> Iterator[str]:
        return iter(sorted(self._table()))

    def __len__(self) -> int:
        return len(self._table())
