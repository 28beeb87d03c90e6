"""The command line as data, read from its parser: for completion in shells and for the page of commands."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, Final, TypeVar

from gcodesim.frozen import frozen

Named = TypeVar("Named", bound=argparse.Action)

PROGRAMS: Final = ("nc", "ngc", "tap", "cnc", "gcode", "mpf", "min", "NC", "TAP")
CELLS: Final = ("yaml", "yml")
LOGS: Final = ("mcap", "part")
ANY: Final = ("*",)

# what a value is, by the name that the help gives it; other paths may be any file
_FILES: Final[Mapping[str, tuple[str, ...]]] = {"PROGRAM": PROGRAMS, "CELL": CELLS, "LOG": LOGS, "OTHER": LOGS}


@frozen
class Value:
    """What may stand in a place: a file that ends in one of `files` (`*`: any), a folder, one of `words`.

    `name` is how the help calls it, `counts` as argparse has it: `?`, `*`, `+`, or nothing for exactly one.
    """

    name: str
    says: str = ""
    files: tuple[str, ...] = ()
    folders: bool = False
    words: tuple[str, ...] = ()
    counts: str = ""


@frozen
class Option:
    """An option by all its names. `value` is None for a switch."""

    names: tuple[str, ...]
    says: str
    value: Value | None
    repeats: bool
    required: bool


@frozen
class Command:
    """A command, or one of its actions. `path` are the words that call it; none for the whole command line."""

    path: tuple[str, ...]
    says: str
    description: str
    options: tuple[Option, ...]
    places: tuple[Value, ...]
    actions: tuple[Command, ...]

    @property
    def name(self) -> str:
        """`run`, `cell validate`."""
        return " ".join(self.path)

    def takes(self, name: str) -> bool:
        """Whether it has an option of this name."""
        return any(name in option.names for option in self.options)

    def leaves(self) -> Iterator[Command]:
        """Everything that can be called: this one, or its actions."""
        if not self.actions:
            yield self
        for action in self.actions:
            yield from action.leaves()


def may_be(argument: Named, words: Callable[[], Sequence[str]]) -> Named:
    """Note what an argument may be where argparse does not check it; asked for only when somebody wants to know."""
    argument.words = words  # type: ignore[attr-defined]
    return argument


def outline(parser: argparse.ArgumentParser, path: tuple[str, ...] = (), says: str = "") -> Command:
    """Everything that the parser takes."""
    options, places, actions = list[Option](), list[Value](), list[Command]()
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            helps = {choice.dest: choice.help or "" for choice in action._choices_actions}
            actions += [outline(of, (*path, name), helps.get(name, "")) for name, of in action.choices.items()]
        elif action.option_strings:
            options.append(_option(action))
        else:
            places.append(_value(action))
    return Command(
        path=path,
        says=says,
        description=" ".join((parser.description or says).split()),
        options=tuple(options),
        places=tuple(places),
        actions=tuple(actions),
    )


def _option(action: argparse.Action) -> Option:
    return Option(
        names=tuple(action.option_strings),
        says=_says(action),
        value=None if action.nargs == 0 else _value(action),
        repeats=isinstance(action, argparse._AppendAction),
        required=action.required,
    )


def _value(action: argparse.Action) -> Value:
    words: Any = getattr(action, "words", None)
    given = tuple(words()) if words is not None else tuple(str(choice) for choice in action.choices or ())
    name = action.metavar if isinstance(action.metavar, str) else "|".join(given) or action.dest.upper()
    is_path = action.type is Path or name in _FILES
    folders = is_path and name == "DIR"
    return Value(
        name=name,
        says=_says(action),
        files=() if folders or not is_path else _FILES.get(name, ANY),
        folders=folders,
        words=given,
        counts=action.nargs if isinstance(action.nargs, str) else "",
    )


def _says(action: argparse.Action) -> str:
    return (action.help or "").replace("%%", "%")
