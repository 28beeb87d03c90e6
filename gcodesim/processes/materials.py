"""The library of cutting-force constants: ids and aliases of both laws in one name space.

Tables disagree by a factor of two (42CrMo4 at h = 0.1 mm: 2500 to 4500 N/mm²),
so every material carries its source and condition. Corrections that tables may
leave out, and that a user may have to apply, once, to constants that do not contain them:

- wear: 1.2 for a used edge to 1.5 for a dull one;
- milling with constants from turning: 1.2 (Tabellenbuch).

None of these is applied here. Rake is: a tool that says its own gets a law corrected by what that differs from the
rake of the table (`laws.with_rake`), where the source tells it (Tabellenbuch: 6 degrees steel, 2 cast iron, 12
aluminium; Seco: 0).
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from difflib import get_close_matches
from functools import cached_property
from pathlib import Path
from typing import Any, Final

from gcodesim.family import Family
from gcodesim.frozen import frozen
from gcodesim.processes.laws import DEFAULT_AXIAL_RATIO, DEFAULT_NORMAL_RATIO, Kienzle, LinearEdge, with_rake
from gcodesim.units import DEG

_FILE: Final = Path(__file__).parent.parent / "data" / "materials.json"


@frozen
class Material:
    """A work material with its force law.

    Without a `law` no source is known for its constants: it is cut without force.
    `assumed` says what was filled in because the source does not give it; `usable` False: its source is in doubt.
    """

    id: str
    name: str
    law: Kienzle | LinearEdge | None
    source: str
    condition: str = ""
    iso: str = ""
    note: str = ""
    assumed: tuple[str, ...] = ()
    usable: bool = True
    aliases: tuple[str, ...] = ()
    rake: float | None = None
    """Of the edges [rad] that its constants hold for; None: the source does not say."""

    def law_for(self, rake: float | None) -> Kienzle | LinearEdge | None:
        """The law of edges with a `rake` [rad]; None: as the table has them."""
        return None if self.law is None else with_rake(self.law, rake, self.rake)


MATERIALS: Final = Family("materials", of="gcodesim.processes.materials:Material", called="id")
"""Materials that other packages and own files add; their names are written as `plain` does."""


def plain(name: str) -> str:
    """A material name as the library compares it: lower case, blanks and hyphens as underscores."""
    return "_".join(name.lower().replace("-", " ").replace("_", " ").split())


class Library(Mapping[str, Material]):
    """Materials by id or alias, spelling of case, blanks and hyphens ignored; iterating gives ids only."""

    @cached_property
    def _materials(self) -> dict[str, Material]:
        table = json.loads(_FILE.read_text(encoding="utf-8"))
        found = [_kienzle(row, table) for row in table["kienzle"]]
        found += [_linear_edge(row, table) for row in table["linear_edge"]]
        found += [_without_force(row) for row in table["without_force"]]
        return {material.id: material for material in found}

    @cached_property
    def _names(self) -> dict[str, str]:
        names = {plain(id): id for id in self._materials}
        for material in self._materials.values():
            for alias in material.aliases:
                if plain(alias) in names:
                    raise ValueError(f"materials.json: `{alias}` names two materials")
                names[plain(alias)] = material.id
        return names

    def __getitem__(self, name: str) -> Material:
        own = self._names.get(plain(name))
        if own is None and plain(name) in MATERIALS:
            found: Material = MATERIALS[plain(name)]
            return found
        return self._materials[self._names[plain(name)]]

    def __iter__(self) -> Iterator[str]:
        yield from self._materials
        yield from (name for name in MATERIALS if name not in self._names)

    def __len__(self) -> int:
        return sum(1 for _ in self)

    def suggest(self, name: str, count: int = 4) -> list[str]:
        """Names in the library close to `name`, nearest first: by spelling, then by words of the description."""
        wanted = plain(name)
        found = get_close_matches(wanted, self._names, n=count, cutoff=0.6)
        words = [word for word in wanted.split("_") if len(word) > 2]
        for material in self._materials.values():
            if any(word in plain(material.name) or word in plain(material.id) for word in words):
                found.append(material.aliases[0] if material.aliases else material.id)
        return list(dict.fromkeys(found))[:count]


def _note(row: dict[str, Any], table: dict[str, Any]) -> str:
    return str(table["notes"][row["note"]]) if "note" in row else ""


def _kienzle(row: dict[str, Any], table: dict[str, Any]) -> Material:
    assumed = [f"normal force {DEFAULT_NORMAL_RATIO:g} and axial force {DEFAULT_AXIAL_RATIO:g} of the tangential"]
    if row.get("note") == "no_exponent":
        assumed.append(f"exponent {row['mc']:g}")
    return Material(
        id=row["id"],
        name=row["name"],
        law=Kienzle.from_table(row["kc11_N_mm2"], row["mc"]),
        source=table["sources"][row["source"]],
        condition=row.get("condition", ""),
        iso=row["iso"],
        note=_note(row, table),
        assumed=tuple(assumed),
        usable=row.get("usable", True),
        aliases=tuple(row.get("aliases", ())),
        rake=row["rake_deg"] * DEG if "rake_deg" in row else None,
    )


def _without_force(row: dict[str, Any]) -> Material:
    """A material that is named, so that nobody takes another one's constants for it."""
    return Material(
        id=row["id"],
        name=f"{row['name']}, no force data",
        law=None,
        source="none that states its specific force with the thickness of the chip",
        aliases=tuple(row.get("aliases", ())),
    )


def _linear_edge(row: dict[str, Any], table: dict[str, Any]) -> Material:
    axial = row["Kac_N_mm2"] is not None
    return Material(
        id=row["id"],
        name=row["name"],
        law=LinearEdge.from_table(
            row["Ktc_N_mm2"],
            row["Kte_N_mm"],
            row["Krc_N_mm2"],
            row["Kre_N_mm"],
            row["Kac_N_mm2"] or 0.0,
            row["Kae_N_mm"] or 0.0,
        ),
        source=f"{table['sources'][row['source']]}, its reference {row['reference']}",
        condition=row["condition"],
        iso=row["iso"],
        note=_note(row, table),
        assumed=() if axial else ("no axial force",),
        usable=row.get("usable", True),
        aliases=tuple(row.get("aliases", ())),
    )


LIBRARY: Final = Library()
