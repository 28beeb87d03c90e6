"""`gcodesim fmt FILES…`: programs in one style."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gcodesim.cli.exits import FINDINGS, OK, UsageError
from gcodesim.cli.formats import add_verdict_formats
from gcodesim.cli.judging import Met, add_today, print_findings_of, settle
from gcodesim.cli.options import STDIN, add_cell, add_language

if TYPE_CHECKING:
    from gcodesim.cli.language import ProgramReading
    from gcodesim.diagnostics import Diagnostic
    from gcodesim.formatting import Formatted, Style

_HEAD = 16  # bytes that show whether a file is binary

_EPILOG = """what is written: one blank between words, none inside; capitals, but small letters for O-words of LinuxCNC,
whose bodies are indented; numbers without zeros that say nothing, so G01 X.50 is G1 X0.5; points of Fanuc numbers
stay. Comments, names and the number of lines stay. Before a file is written, each line of the new text is proven to say
the same and the whole to give the same canonical events; a program with errors is left alone."""


def add_parser(commands: Any) -> None:
    parser = commands.add_parser(
        "fmt",
        help="write programs in one style: spacing, case, numbers, line numbers",
        description="Write programs in one style. Nothing that they do changes, and that is proven before a file is "
        "written.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "programs",
        type=Path,
        nargs="+",
        metavar="FILE",
        help="programs, or folders of them (.nc .ngc .gcode .tap …); - for stdin, which goes to stdout",
    )
    parser.add_argument("--check", action="store_true", help="write nothing; status 1 if a program would change")
    parser.add_argument("--diff", action="store_true", help="write nothing; show what would change, line by line")
    style = parser.add_argument_group(
        "style",
        "What is not given here stands under `format` in the nearest gcodesim.yaml, in the program's folder or "
        "above up to the top of the repository.",
    )
    style.add_argument(
        "--renumber",
        type=_step,
        nargs="?",
        const=10,
        metavar="STEP",
        help="number the blocks that have an N anew, in steps of 10 or STEP; GOTO, M99 P and G71 P Q follow",
    )
    style.add_argument("--compact", action="store_true", help="no blanks, for controls with little memory")
    style.add_argument("--case", choices=("upper", "lower"), help="of letters (default: upper)")
    style.add_argument("--code-digits", type=int, choices=(1, 2), help="2 writes G01 and M06, 1 (default) G1 and M6")
    style.add_argument(
        "--decimals",
        type=_decimals,
        metavar="N",
        help="at least so many digits behind the point of positions, which then all have one: 3 writes X10.500, 0 X10.",
    )
    style.add_argument("--indent", type=_indent, metavar="N", help="blanks before bodies of O-words (default: 2)")
    add_cell(parser, required=False)
    add_language(parser)
    add_verdict_formats(parser)
    add_today(parser)
    parser.set_defaults(run=run, fail_on="warning", baseline=None, write_baseline=None)


def _step(text: str) -> int:
    if not text.isdecimal() or not 1 <= int(text) <= 1000:
        raise argparse.ArgumentTypeError(f"a step from 1 to 1000 is expected, not {text}; files come before it")
    return int(text)


def _indent(text: str) -> int:
    if not text.isdecimal() or int(text) > 16:
        raise argparse.ArgumentTypeError("a number from 0 to 16 is expected")
    return int(text)


def _decimals(text: str) -> int:
    if not text.isdecimal() or int(text) > 6:
        raise argparse.ArgumentTypeError("a number from 0 to 6 is expected")
    return int(text)


@dataclass
class _Done:
    """What became of one program: in the style, or the findings for which it is left alone."""

    path: Path
    reading: ProgramReading
    found: Formatted | None
    findings: list[Diagnostic]

    @property
    def changes(self) -> bool:
        return self.found is not None and self.found.program.raw != self.reading.program.raw


def run(arguments: argparse.Namespace) -> int:
    paths = _programs(arguments.programs)
    if arguments.format == "json" and STDIN in paths and not (arguments.check or arguments.diff):
        raise UsageError("the program of stdin goes to stdout, so that no JSON can; use --check")
    done = [_formatted(arguments, path) for path in paths]
    if arguments.diff:
        for one in done:
            sys.stdout.writelines(_difference(one))
        return FINDINGS if any(one.found is None or one.changes for one in done) else OK
    if arguments.check:
        return _checked(arguments, done)
    return _written(arguments, done)


def _programs(paths: list[Path]) -> list[Path]:
    """The files that are meant; in folders no hidden ones, and none that are links, which lead who knows where."""
    from gcodesim.regress.programs import PROGRAMS, programs_in

    found: dict[Path, None] = {}
    for path in paths:
        if not path.is_dir():
            _refuse_binary(path)
            found[path] = None
            continue
        inside = [one for one in programs_in(path) if _may_be_written(one) and not _is_hidden(one.relative_to(path))]
        if not inside:
            raise UsageError(f"there is no program in {path} ({' '.join(PROGRAMS)})")
        found |= dict.fromkeys(inside)
    if STDIN in found and len(found) > 1:
        raise UsageError("- is the one program of stdin; name the others in another call")
    return list(found)


def _refuse_binary(path: Path) -> None:
    if path != STDIN and path.is_file() and _is_binary_file(path):
        text = path.with_suffix(".gcode")
        raise UsageError(f"{path} is binary G-code, and what is written is text: gcodesim fmt - < {path} > {text}")


def _may_be_written(path: Path) -> bool:
    return not path.is_symlink() and not _is_binary_file(path)


def _is_binary_file(path: Path) -> bool:
    from gcodesim.rs274 import is_binary

    try:
        with path.open("rb") as file:
            return is_binary(file.read(_HEAD))
    except OSError:
        return False  # it cannot be read either, which is told where that is tried


def _is_hidden(path: Path) -> bool:
    return any(part.startswith(".") for part in path.parts)


def _style(arguments: argparse.Namespace, settings: Style) -> Style:
    """The style of the settings, in which the command line has the last word."""
    said = {
        "spaces": False if arguments.compact else None,
        "case": arguments.case,
        "indent": arguments.indent,
        "code_digits": arguments.code_digits,
        "decimals": arguments.decimals,
        "step": arguments.renumber,
    }
    return replace(settings, **{name: value for name, value in said.items() if value is not None})


def _formatted(arguments: argparse.Namespace, path: Path) -> _Done:
    from gcodesim.cli.language import reading_of
    from gcodesim.diagnostics import Severity
    from gcodesim.formatting import CannotFormatError, formatted
    from gcodesim.formatting.style_file import style_for

    reading = reading_of(arguments, path)
    settings = style_for(path)
    if settings.source is not None:
        reading.sources[settings.source.name] = settings.source
    if settings.style is None:
        return _Done(path, reading, None, list(settings.findings))
    if reading.run is None:
        return _Done(path, reading, None, [one for one in reading.before if one.level >= Severity.ERROR])
    try:
        return _Done(
            path, reading, formatted(reading.program, reading.run.settings, _style(arguments, settings.style)), []
        )
    except CannotFormatError as error:
        return _Done(path, reading, None, list(error.findings))


def _checked(arguments: argparse.Namespace, done: list[_Done]) -> int:
    """A finding for each program that would change, in the formats of `lint`."""
    from gcodesim.formatting.program import not_formatted

    for one in done:
        if one.found is not None and one.changes:
            one.findings.append(not_formatted(one.reading.program, one.found))
    settled = settle([_met(arguments, one) for one in done], arguments)
    print_findings_of(settled, arguments)
    return settled.status


def _met(arguments: argparse.Namespace, one: _Done) -> Met:
    from gcodesim.cli.language import files_of

    reading = one.reading
    return Met(
        program=one.path,
        cell=arguments.cell,
        findings=one.findings,
        sources=reading.sources,
        files=lambda: files_of(arguments, one.path, reading.sources, reading.folders, reading.loaded),
    )


def _written(arguments: argparse.Namespace, done: list[_Done]) -> int:
    """Write what changes; findings of programs that are left alone go where they do not mix with a program."""
    from gcodesim.cli.output import findings_as_json, note, print_findings, print_json

    left = [one for one in done if one.found is None]
    as_json = arguments.format == "json"
    for one in done:
        if one.found is None:
            if not as_json:
                print_findings(one.findings, one.reading.sources, sys.stderr if one.path == STDIN else None)
            note(f"{one.path} is left alone: it has errors")
            continue
        if one.path == STDIN:
            sys.stdout.flush()
            _raw_stdout(one.found.program.raw)
        elif one.changes:
            _write(one.path, one.found.program.raw)
            note(f"{one.path}: {_counted(len(one.found.changed), 'line')} changed")
        if one.found.unread:
            lines = ", ".join(map(str, one.found.unread[:10]))
            note(f"{one.path}: nobody reads what stands in line {lines}, so it stays as it is")
    if as_json:
        changed = [str(one.path) for one in done if one.changes]
        print_json({"changed": changed, "findings": [f for one in left for f in findings_as_json(one.findings)]})
    elif done[0].path != STDIN:
        changes = sum(one.changes for one in done)
        same = len(done) - len(left) - changes
        note(f"{_counted(changes, 'program')} changed, {same} as before, {len(left)} left alone")
    return FINDINGS if left else OK


def _write(path: Path, raw: bytes) -> None:
    """Write a program where its name leads to, with the rights that it had."""
    from gcodesim.files.whole_file import write_whole

    place = path.resolve()
    mode = place.stat().st_mode
    try:
        write_whole(place, raw)
    except OSError as error:
        raise UsageError(f"program {path} cannot be written: {error.strerror or error}") from None
    place.chmod(mode)


def _raw_stdout(raw: bytes) -> None:
    """The program as bytes, in the encoding that it came in."""
    sys.stdout.buffer.write(raw)
    sys.stdout.buffer.flush()


def _difference(one: _Done) -> Iterator[str]:
    """A unified difference; of a program that is left alone, why."""
    from difflib import unified_diff

    from gcodesim.cli.output import note, print_findings

    if one.found is None:
        print_findings(one.findings, one.reading.sources, sys.stderr)
        note(f"{one.path} is left alone: it has errors")
        return
    old, new = ([f"{line}\n" for line in text.lines] for text in (one.reading.program, one.found.program))
    yield from unified_diff(old, new, str(one.path), str(one.path))


def _counted(count: int, what: str) -> str:
    return f"{count} {what}{'' if count == 1 else 's'}"
