"""A parser of command lines that says what somebody may have meant."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any, NoReturn

from gcodesim.cli.exits import USAGE
from gcodesim.cli.nearest import did_you_mean, nearest
from gcodesim.cli.outline import outline
from gcodesim.diagnostics.plain import one_line


class Parser(argparse.ArgumentParser):
    """Like argparse's, but an option or word that does not exist is told first, with the nearest that does.

    `whole` makes the parser of the whole command line; None for that one itself.
    """

    whole: Callable[[], argparse.ArgumentParser] | None = None

    def parse_known_args(self, args: Iterable[str] | None = None, namespace: Any = None) -> Any:
        """As argparse; nothing is left over, since what nobody knows is an error here."""
        given = sys.argv[1:] if args is None else list(args)
        if not given and self._actions_of() is not None:
            self.print_help(sys.stderr)
            self.exit(USAGE)
        self._refuse_unknown_options(given)
        namespace, rest = super().parse_known_args(given, namespace)
        if rest and self._takes(rest, namespace):
            rest = []
        if rest:
            self._refuse(rest[0])
        return namespace, rest

    def _takes(self, rest: list[str], namespace: Any) -> bool:
        """Give words that stand behind an option to the argument that takes any number: argparse leaves them over."""
        many = next((one for one in self._actions if not one.option_strings and one.nargs in ("*", "+")), None)
        if many is None or any(word.startswith("-") for word in rest):
            return False
        before = getattr(namespace, many.dest, None)
        if before is None or before is many.default:
            before = []
        setattr(namespace, many.dest, [*before, *self._get_values(many, rest)])
        return True

    def error(self, message: str) -> NoReturn:
        """Say what is wrong and where the right form is told; ends with status 2."""
        print(f"{self.prog}: {one_line(message)} (`{self.prog} --help` shows more)", file=sys.stderr)
        sys.exit(USAGE)

    def _print_message(self, message: str, file: Any = None) -> None:
        """Write help or version; argparse's own takes no notice of what cannot be written."""
        stream = sys.stderr if file is None else file
        stream.write(message)
        stream.flush()

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        if action.choices is None or value in action.choices:
            return
        known, word = [str(choice) for choice in action.choices], str(value)
        if isinstance(action, argparse._SubParsersAction):
            self.error(self._no_such_action(word, known, str(action.metavar).lower()))
        name = action.option_strings[0] if action.option_strings else action.metavar or action.dest
        self.error(f"{name} cannot be {word}, only {', '.join(known)}{did_you_mean(nearest(word, known))}")

    def _no_such_action(self, word: str, known: Sequence[str], kind: str) -> str:
        near = nearest(word, known)
        for command in () if self.whole is not None else outline(self).leaves():
            if command.path[-1] == word:
                near = [command.name]
        path = Path(word)
        if not near and (path.suffix or path.is_file()):
            return f"{word} is no {kind}; did you mean {self.prog} {'run' if 'run' in known else known[0]} {word}?"
        return f"there is no {kind} {word}{did_you_mean(near)}"

    def _actions_of(self) -> argparse._SubParsersAction[Any] | None:
        return next((one for one in self._actions if isinstance(one, argparse._SubParsersAction)), None)

    def _refuse_unknown_options(self, given: Sequence[str]) -> None:
        """Argparse would first ask for whatever is missing, though a slip in its name is the reason."""
        for word in given:
            if word == "--" or (self._actions_of() is not None and not word.startswith("-")):
                return
            name = word.partition("=")[0]
            if name.startswith("--") and not any(own.startswith(name) for own in self._option_string_actions):
                self._refuse(name)

    def _refuse(self, word: str) -> NoReturn:
        if not word.startswith("-"):
            self.error(f"{word} is one too many")
        whole = self if self.whole is None else self.whole()
        others = [command.name for command in outline(whole).leaves() if command.takes(word)]
        near = nearest(word, [own for own in self._option_string_actions if own.startswith("--")])
        told = f"; it is one of {', '.join(others)}" if others else did_you_mean(near)
        self.error(f"there is no option {word}{told}")
