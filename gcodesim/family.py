"""A family is a table of variants that load on first use.

A variant is one file and one line in its family's table. Third parties add
theirs by an entry point of group ``gcodesim.<family>``, or by a file that a cell
names and the command line allows; contract tests run over the whole table and so find every newcomer.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING, Any, Final

from gcodesim.installed import may_extend

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

_GROUP: Final = "gcodesim."

_LENT: Final[dict[str, dict[str, Any]]] = {}
"""What own files have added, by family and name."""

_LENDERS: Final[dict[tuple[str, str], str]] = {}
"""The module that added it, by family and name."""

_FILES: Final[dict[str, str]] = {}
"""Own files by the names of their modules."""


class ExtensionError(Exception):
    """What another package adds cannot be used; the text names the package and says why."""


class Family(Mapping[str, Any]):
    """Names of variants and where they live; `family[name]` imports and returns the variant.

    What ships is given by place (`module:attribute`) or, in `members`, as it is. `of` is the place of the class that
    every variant of another package has as its base or type, and `called` the attribute in which it has its own name.
    A name of ours stays ours, whoever else takes it.
    """

    def __init__(
        self, name: str, members: Mapping[str, Any] | None = None, *, of: str = "", called: str = "", **entries: str
    ) -> None:
        self.name = name
        self._of = of
        self._called = called
        self._entries = dict(entries)
        self._loaded: dict[str, Any] = dict(members or {})
        self._own = (*self._loaded, *entries)

    @property
    def _others(self) -> dict[str, list[EntryPoint]]:
        """Entry points of other packages by name."""
        return {name: points for name, points in _added(self.name).items() if name not in self._own}

    @property
    def _of_files(self) -> dict[str, Any]:
        """What own files have added, by name."""
        return {name: variant for name, variant in _LENT.get(self.name, {}).items() if name not in self._own}

    def in_order(self, names: Iterable[str]) -> tuple[str, ...]:
        """These names in the order of the table, then those of third parties in alphabetical order."""
        wanted = set(names)
        return (*(name for name in self._own if name in wanted), *sorted(wanted.difference(self._own)))

    def own(self) -> tuple[str, ...]:
        """The names of what ships, as the table has them."""
        return self._own

    def __getitem__(self, key: str) -> Any:
        if key in _LENT.get(self.name, ()) and key not in self._own:
            return _LENT[self.name][key]
        if key not in self._loaded:
            place = self._entries.get(key)
            self._loaded[key] = object_at(place) if place is not None else self._from(key, self._others[key])
        return self._loaded[key]

    def lend(self, key: str, variant: Any, module: str, file: str, beside: Iterable[str] = ()) -> None:
        """Add a variant of an own file, whose code is in `module`; it takes the place of one that a file added before.

        ExtensionError for a name that ships, that a package has, or that another of the modules `beside` it has added.
        Whoever calls has been allowed to run the file.
        """
        other = _LENDERS.get((self.name, key), module)
        if other != module and other in beside:
            raise ExtensionError(f"the file {_FILES[other]} beside it adds `{key}` too; one of them has to go")
        if key in self._own or key in self._others:
            whose = "gcodesim" if key in self._own else _owner(self._others[key][0])
            raise ExtensionError(f"`{key}` is a name that {whose} has in `{self.name}`; choose another")
        _LENT.setdefault(self.name, {})[key] = variant
        _LENDERS[self.name, key] = module
        _FILES[module] = file

    def _from(self, key: str, points: list[EntryPoint]) -> Any:
        """What another package adds under the name `key`."""
        if len(points) > 1:
            owners = " and ".join(sorted(map(_owner, points)))
            raise ExtensionError(f"{owners} both add `{key}` to `{_GROUP}{self.name}`; one of them has to go")
        (point,) = points
        said = f"{_owner(point)} adds `{key}` to `{_GROUP}{self.name}` as `{point.value}`"
        try:
            found = point.load()
        except Exception as error:  # whatever the module of a stranger does when it is imported
            reason = " ".join(str(error).split())
            raise ExtensionError(f"{said}, which cannot be loaded: {type(error).__name__}: {reason}") from error
        if self._of:
            base = object_at(self._of)
            if not (issubclass(found, base) if isinstance(found, type) else isinstance(found, base)):
                raise ExtensionError(f"{said}, which is no {base.__name__}")
        if self._called and getattr(found, self._called) != key:
            raise ExtensionError(f"{said}, whose `{self._called}` is `{getattr(found, self._called)}`")
        return found

    def __contains__(self, key: object) -> bool:
        """Whether there is a variant of that name; nothing is imported for the answer."""
        return key in self._own or key in self._entries or key in self._of_files or key in self._others

    def __iter__(self) -> Iterator[str]:
        return iter(sorted({*self._own, *self._entries, *self._of_files, *self._others}))

    def __len__(self) -> int:
        return sum(1 for _ in self)


def take_back() -> None:
    """Forget what own files have added: each command begins with what is installed."""
    _LENT.clear()
    _LENDERS.clear()
    _FILES.clear()


def extensions() -> list[EntryPoint]:
    """All that other packages add to families, in the order of their groups and names."""
    found = [point for points in _all_added().values() for point in points]
    return sorted(found, key=lambda point: (point.group, point.name, _owner(point)))


def package_at_fault(error: BaseException) -> str:
    """The package whose code failed, as people call it; empty when the fault is in nobody's code but ours."""
    owners = {point.module.partition(".")[0]: _owner(point) for point in extensions()}
    owners |= {module: f"the file {file}" for module, file in _FILES.items()}
    found = ""
    trace = error.__traceback__
    while trace is not None:  # the innermost counts
        found = owners.get(str(trace.tb_frame.f_globals.get("__name__", "")).partition(".")[0], found)
        trace = trace.tb_next
    return found


def _added(family: str) -> dict[str, list[EntryPoint]]:
    by_name: dict[str, list[EntryPoint]] = {}
    for point in _all_added().get(_GROUP + family, ()):
        by_name.setdefault(point.name, []).append(point)
    return by_name


@cache
def _all_added() -> dict[str, list[EntryPoint]]:
    """Entry points of our groups, by group; found once and only when needed."""
    if not may_extend():
        return {}
    from importlib.metadata import entry_points

    found = entry_points()
    return {group: list(found.select(group=group)) for group in found.groups if group.startswith(_GROUP)}


def object_at(place: str) -> Any:
    """What stands at `module:attribute`."""
    module, _, attribute = place.partition(":")
    return getattr(import_module(module), attribute)


def _owner(point: EntryPoint) -> str:
    """The package that has an entry point, as people call it."""
    return "a package" if point.dist is None else f"the package {point.dist.name} {point.dist.version}"
