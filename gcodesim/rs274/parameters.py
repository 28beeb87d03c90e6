"""Numbered and named parameters: the control's memory, and its file form."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from math import isfinite
from typing import Any

from gcodesim.diagnostics import Diagnostic, SourceText, Span
from gcodesim.rs274.fault import Fault

LAST_NUMBER = 5601
_LAST_OF_ANY = 19_999  # of any dialect
MOST_ARGUMENTS = 30
_OF_CALL = tuple(range(1, MOST_ARGUMENTS + 1))
NO_ARGUMENTS = (0.0,) * MOST_ARGUMENTS

PROBE = 5061  # trip point of the latest probing, 9 numbers
PROBE_RESULT = 5070
G28_HOME = 5161  # stored positions [mm, deg], 9 numbers each
G30_HOME = 5181
G92_ON = 5210
G92_OFFSET = 5211
ACTIVE_SYSTEM = 5220
FIRST_SYSTEM = 5221  # nine systems of 20 numbers: 9 offsets, then the rotation
INPUT_RESULT = 5399
TOOL = 5400
POSITION = 5420
DEBUG_ON = 5599  # 1 from the start; at 0 DEBUG comments are silent

# parameters that LinuxCNC keeps from run to run, besides those listed in its parameter file
KEPT = (
    *(number for first in (G28_HOME, G30_HOME) for number in range(first, first + 9)),
    *range(G92_ON, ACTIVE_SYSTEM + 1),
    *(FIRST_SYSTEM + 20 * system + axis for system in range(9) for axis in range(10)),
)


_READ_ONLY = frozenset([*range(5400, 5414), *range(5420, 5429)])


_SET_IT = "set it before it is used, or ask with EXISTS[#<…>]"
_WHERE_FROM = {
    "_hal": "it is a pin of the running machine: say with `--set '{name}=VALUE'` what it has, "
    "or ask with EXISTS[#<_hal[…]>]",
    "_ini": "it stands in the machine's INI file, which is not read: say with `--set '{name}=VALUE'` what it has",
}


_OF_MACHINE = {"_hal": "a pin of the running machine", "_ini": "a value of the machine's INI file"}


class Parameters:
    """Numbered parameters of the program and named ones of the running subroutine and of all.

    `position` gives #5400… and #5420…; `predefined` gives names such as _x,
    or None when there is no such name.
    """

    def __init__(self, position: Callable[[int], float], predefined: Callable[[str], float | None]) -> None:
        self.numbers: dict[int, float] = {}
        self.globals: dict[str, float] = {}
        self.locals: dict[str, float] = {}
        self._position = position
        self._predefined = predefined
        self.undo: list[tuple[dict[int, float] | dict[str, float], int | str, float | None]] = []
        self.changes = 0
        """Counts what may have changed a value, for those who keep a copy."""

    def index(self, value: float) -> int:
        """The number meant by `#value`: a value within 1e-4 of an integer counts as that integer."""
        number = round(value)
        if abs(value - number) > 1e-4:
            raise Fault("GS121", f"#{value:g} is no parameter: the number must be whole")
        if not 1 <= number <= LAST_NUMBER:
            raise Fault("GS121", f"#{number} is out of range; parameters run from #1 to #{LAST_NUMBER}")
        return number

    def get(self, number: int) -> float:
        """Value of #number; 0 when never set."""
        if number in _READ_ONLY:
            return self._position(number)
        return self.numbers.get(number, 1.0 if number == DEBUG_ON else 0.0)

    def get_named(self, name: str) -> float:
        """Value of #<name>."""
        value = self._named(name)
        if value is None:
            raise Fault(
                "GS120",
                f"#<{name}> has no value",
                hint=self._suggestion(name) or _WHERE_FROM.get(name.partition("[")[0], _SET_IT).format(name=name),
            )
        return value

    def declare(self, name: str) -> bool:
        """Give a name that has none the value 0, as its first setting does before it is computed; whether it did."""
        if self._named(name) is not None:
            return False
        self.set_named(name, 0.0)
        return True

    def exists(self, name: str) -> bool:
        return self._named(name) is not None

    def _named(self, name: str) -> float | None:
        if name.startswith("_"):
            value = self._predefined(name)
            return self.globals.get(name) if value is None else value
        return self.locals.get(name)

    def _suggestion(self, name: str) -> str:
        from difflib import get_close_matches

        near = get_close_matches(name, [*self.locals, *self.globals], n=1)
        return f"did you mean #<{near[0]}>?" if near else ""

    def check_setting(self, name: str) -> None:
        """Raise `Fault` for a #<name> that a program may not set; a cell or a command line may give it a value."""
        place = name.partition("[")[0]
        if place in _OF_MACHINE and "]" in name:
            raise Fault("GS122", f"#<{name}> is {_OF_MACHINE[place]} and cannot be set")

    def set_by_program(self, number: int, value: float) -> None:
        """`#number=value` in a program."""
        if number in _READ_ONLY:
            raise Fault("GS122", f"#{number} shows the state of the machine and cannot be set")
        self.set(number, value)

    def preset(self, parameter: int | str, value: float) -> None:
        """Give a number or a name its value before the program begins."""
        if isinstance(parameter, str):
            self.set_named(parameter, value)
        else:
            self.set_by_program(self.index(float(parameter)), value)

    def set(self, number: int, value: float) -> None:
        """Store a number so that `roll_back` can undo it."""
        self.changes += 1
        self.undo.append((self.numbers, number, self.numbers.get(number)))
        self.numbers[number] = value

    def first(self) -> tuple[float, ...]:
        """Values of the parameters that a call of a subroutine has for itself."""
        return tuple(map(self.numbers.get, _OF_CALL, NO_ARGUMENTS))

    def set_first(self, values: tuple[float, ...]) -> None:
        """Store those, like `set`; most of them are unchanged, down to the object."""
        self.changes += 1
        numbers = self.numbers
        for number, old, value in zip(_OF_CALL, map(numbers.get, _OF_CALL), values, strict=True):
            if old is not value:
                self.undo.append((numbers, number, old))
                numbers[number] = value

    def set_named(self, name: str, value: float) -> None:
        """`#<name>=value` in a program."""
        store = self.globals if name.startswith("_") else self.locals
        if name.startswith("_") and self._predefined(name) is not None:
            raise Fault("GS122", f"#<{name}> shows the state of the machine and cannot be set")
        self.changes += 1
        self.undo.append((store, name, store.get(name)))
        store[name] = value

    def everything(self) -> dict[object, float]:
        """All that is stored, by number or name."""
        stores: tuple[Mapping[Any, float], ...] = (self.numbers, self.globals, self.locals)
        return {name: value for store in stores for name, value in store.items()}

    def kept(self) -> Iterable[int]:
        """The numbers that a control keeps when the program has ended."""
        return KEPT

    def commit(self) -> None:
        """Keep everything that was set."""
        self.undo.clear()

    def roll_back(self) -> None:
        """Undo everything that was set since the last commit."""
        self.changes += 1
        for store, key, value in reversed(self.undo):
            if value is None:
                store.pop(key, None)  # type: ignore[arg-type]
            else:
                store[key] = value  # type: ignore[index]
        self.undo.clear()


def parameter_text(values: Mapping[int, float], numbers: Iterable[int]) -> str:
    """A parameter file of `numbers`; those without a value are 0."""
    return "".join(f"{number}\t{values.get(number, 0.0):.12g}\n" for number in sorted(set(numbers)))


def read_parameters(source: SourceText) -> tuple[dict[int, float], list[Diagnostic]]:
    """Read a parameter file: number and value a line. Lines that cannot be read are named and left out."""
    values: dict[int, float] = {}
    findings: list[Diagnostic] = []
    for line, text in enumerate(source.lines, 1):
        body = re.split(r"[;#(]", text, maxsplit=1)[0]
        words = body.split()
        if not words:
            continue
        problem = ""
        number_ok = re.fullmatch(r"[0-9]{1,6}", words[0]) is not None
        value_ok = len(words) >= 2 and re.fullmatch(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?", words[1])
        if not number_ok or not value_ok:
            problem = "a line is a parameter's number and its value"
        elif not 1 <= int(words[0]) <= _LAST_OF_ANY:
            problem = f"parameter {words[0]} is out of range; they run from 1 to {_LAST_OF_ANY}"
        elif not isfinite(float(words[1])):
            problem = "the value is too large"
        if problem:
            span = Span.of_line(source.name, line, body)
            findings.append(Diagnostic(code="GS021", message=problem, span=span, hint="for example: 5221 100.000000"))
            continue
        values[int(words[0])] = float(words[1])
    return values, findings
