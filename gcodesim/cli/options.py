"""Options that several commands share, each declared once."""

from __future__ import annotations

import argparse
import sys
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gcodesim.cli.exits import FAIL_ON, UsageError
from gcodesim.cli.outline import may_be
from gcodesim.diagnostics import SourceText

if TYPE_CHECKING:
    from gcodesim.regress.tolerance import Tolerances


STDIN = Path("-")
AUTO = Path("auto")
"""In place of a cell: the one that is made from the program. A file of that name is `./auto`."""


def add_format(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--format", choices=("text", "json"), default="text", help="text for people (default), JSON for programs"
    )


def add_fail_on(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--fail-on",
        choices=FAIL_ON,
        default="error",
        help="exit with status 1 when a finding is this severe or more (default: error)",
    )


def add_tolerances(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--tolerance",
        action="append",
        default=[],
        metavar="NAME=VALUE",
        help="how much of a quantity may differ, such as volume='2 mm^3, 1 %%' or force=5%%; may be given several "
        "times; `gcodesim list tolerances` names all",
    )


def read_tolerances(arguments: argparse.Namespace) -> Tolerances:
    """The default tolerances, changed by the command line; UsageError for those that cannot be read."""
    from gcodesim.regress.tolerance import DEFAULTS, QUANTITIES
    from gcodesim.regress.tolerance_kind import tolerance_from

    tolerances = dict(DEFAULTS)
    for text in arguments.tolerance:
        name, equals, value = text.partition("=")
        if not equals or name.strip() not in QUANTITIES:
            raise UsageError(f"--tolerance {text}: NAME=VALUE is expected, with a name of {', '.join(QUANTITIES)}")
        tolerance = tolerance_from(name.strip(), value)
        if isinstance(tolerance, str):
            raise UsageError(f"--tolerance {text}: {tolerance}")
        tolerances[name.strip()] = tolerance
    return tolerances


def add_program(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "program", type=Path, metavar="PROGRAM", help="the G-code program (.nc, .ngc, any name; - for stdin)"
    )


def add_programs(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "programs", type=Path, nargs="+", metavar="PROGRAM", help="G-code programs (.nc, .ngc, any name; - for stdin)"
    )


class _Channels(argparse.Action):
    """Collects NAME=PROGRAM; a name comes once."""

    def __call__(self, parser: argparse.ArgumentParser, namespace: argparse.Namespace, values: Any, *_: object) -> None:
        name, equals, path = str(values).partition("=")
        known = getattr(namespace, self.dest)
        if not (equals and name.strip() and path):
            raise argparse.ArgumentError(self, f"NAME=PROGRAM is expected, not {values}")
        if name.strip() in known:
            raise argparse.ArgumentError(self, f"channel {name.strip()} has two programs")
        setattr(namespace, self.dest, {**known, name.strip(): Path(path)})


class _Presets(argparse.Action):
    """Collects NAME=VALUE; a parameter comes once."""

    def __call__(self, parser: argparse.ArgumentParser, namespace: argparse.Namespace, values: Any, *_: object) -> None:
        from gcodesim.declarations.scalars import measured
        from gcodesim.rs274.presets import as_written, parameter_of

        name, _equals, text = str(values).partition("=")
        parameter, number = parameter_of(name), measured(text)
        if parameter is None or number is None or number.unit or not isfinite(number.value):
            what = "NAME=VALUE is expected, such as depth=2 or 100=2.5"
            raise argparse.ArgumentError(self, f"{what}, not {values}")
        known = getattr(namespace, self.dest)
        if parameter in known:
            raise argparse.ArgumentError(self, f"{as_written(parameter)} has two values")
        setattr(namespace, self.dest, {**known, parameter: number.value})


def add_channels(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--channel",
        action=_Channels,
        default={},
        metavar="NAME=PROGRAM",
        help="a program that runs at the same time in another channel of the cell; may be given several times",
    )


def add_cell(parser: argparse.ArgumentParser, *, required: bool) -> None:
    says = "the cell file (YAML); `gcodesim init` writes one"
    if required:
        says += "; auto: the one that `init --from` would write for this program"
    argument = parser.add_argument("--cell", type=_cell if required else Path, metavar="CELL", help=says)
    if required:  # but not by argparse: who has none is told what the program needs
        may_be(argument, lambda: (str(AUTO),))
    add_allow_path(parser)


def _cell(text: str) -> Path:
    return AUTO if text == str(AUTO) else Path(text)


def is_auto(cell: Path) -> bool:
    """Whether the cell is to be made from the program. `./auto` is a file, so this is about the very object."""
    return cell is AUTO


def add_allow_path(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--allow-path",
        type=Path,
        action="append",
        default=[],
        metavar="DIR",
        help="a folder besides the cell's own from which the cell may take files; may be given several times",
    )
    add_allow_code(parser)


def add_allow_code(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--allow-code",
        action="store_true",
        help="run the Python files that the cell names under `code`; they may do whatever you may, so read them first",
    )


def add_language(parser: argparse.ArgumentParser) -> None:
    """Options of the language reader; they override the keys of a cell."""
    group = parser.add_argument_group("language", "how the program is read; these come before what the cell says")
    dialect = group.add_argument(
        "--dialect", metavar="NAME", help="linuxcnc (default), rs274 …; see `gcodesim list dialects`"
    )
    may_be(dialect, dialects)
    group.add_argument("--tools", type=Path, metavar="FILE", help="tool table of the control (tool.tbl)")
    group.add_argument(
        "--subs",
        type=Path,
        action="append",
        default=[],
        metavar="DIR",
        help="folder with subroutine files; may be given several times",
    )
    group.add_argument("--parameters", type=Path, metavar="FILE", help="parameter file of the control (.var)")
    group.add_argument(
        "--set",
        dest="presets",
        action=_Presets,
        default={},
        metavar="NAME=VALUE",
        help="a parameter's value before the program begins, such as depth=2 for #<depth> or 100=2 for #100, in units "
        "of the program; may be given several times",
    )
    group.add_argument(
        "--block-delete",
        nargs="?",
        const=True,
        default=None,
        type=_switch,
        metavar="0|1",
        help="1 (or no value): skip blocks that begin with /; 0: run them",
    )
    group.add_argument(
        "--decimal-point",
        choices=("calculator", "increments"),
        help="what X10 is to a Fanuc program: 10 mm (calculator, default), or 10 increments of 0.001 mm",
    )
    group.add_argument("--max-blocks", type=int, metavar="N", help="stop a program after N executed blocks")
    group.add_argument("--time-limit", type=float, metavar="S", help="stop reading a program after S seconds")


def dialects() -> list[str]:
    """The names of all dialects."""
    from gcodesim.rs274.dialects import DIALECTS

    return list(DIALECTS)


def add_from_line(parser: argparse.ArgumentParser, *, required: bool, says: str) -> None:
    parser.add_argument("--from-line", type=_line, required=required, metavar="N", help=says)


def _line(text: str) -> int:
    if not (text.isascii() and text.isdigit() and int(text) > 0):
        raise argparse.ArgumentTypeError(f"'{text}' is no line number; the first line is 1")
    return int(text)


def add_parameter_output(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--write-parameters",
        type=Path,
        metavar="FILE",
        help="write what a control keeps when the program has ended (offsets, stored positions) as a parameter file, "
        "which --parameters reads",
    )


def _switch(text: str) -> bool:
    if text not in ("0", "1"):
        raise argparse.ArgumentTypeError("0 or 1 is expected")
    return text == "1"


def read_source(path: Path, what: str) -> SourceText:
    """The bytes of a file named on the command line; UsageError when it cannot be read. `-` is the program on stdin."""
    from gcodesim.rs274 import as_text, read_program

    if path == STDIN and what == "program":
        return as_text(SourceText(str(path), sys.stdin.buffer.read()))
    try:
        if path.is_dir():
            raise UsageError(f"{what} {path} is a folder, not a file")
        return read_program(path) if what == "program" else SourceText.read(path)
    except FileNotFoundError:
        raise UsageError(f"{what} {path} is not there") from None
    except OSError as error:
        raise UsageError(f"{what} {path} cannot be read: {error.strerror or error}") from None
    except ValueError as error:  # a name with a null character
        raise UsageError(f"{what} {str(path)!r} cannot be read: {error}") from None
