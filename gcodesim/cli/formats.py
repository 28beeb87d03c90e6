"""Options for machine-readable verdicts, the same for all commands that judge: on stdout, or in additional files."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Final

from gcodesim.cli.exits import UsageError
from gcodesim.diagnostics.plain import raw

if TYPE_CHECKING:
    from gcodesim.regress import SuiteVerdict

_CHOICES: Final = ("text", "json", "sarif", "junit", "github", "gitlab")
_FILES: Final = ("junit", "sarif", "gitlab")


def add_verdict_formats(parser: argparse.ArgumentParser) -> None:
    group = parser.add_argument_group(
        "formats", "what is printed, and what is written besides; the exit status is the same for all"
    )
    group.add_argument(
        "--format",
        choices=_CHOICES,
        default="text",
        help="what stdout gets: text for people (default), JSON, or one of the formats below",
    )
    group.add_argument("--junit", type=Path, metavar="FILE", help="write JUnit XML: a test case a program")
    group.add_argument("--sarif", type=Path, metavar="FILE", help="write SARIF 2.1.0, for code scanning and editors")
    group.add_argument("--gitlab", type=Path, metavar="FILE", help="write a GitLab code quality report")
    group.add_argument("--github", action="store_true", help="print annotations of GitHub workflows after the text")


def _files(arguments: argparse.Namespace) -> list[tuple[str, Path]]:
    return [(name, getattr(arguments, name)) for name in _FILES if getattr(arguments, name) is not None]


def wants_formats(arguments: argparse.Namespace) -> bool:
    """Whether anything other than text and JSON is requested."""
    return arguments.format not in ("text", "json") or arguments.github or bool(_files(arguments))


def write_formats(verdict: SuiteVerdict | None, arguments: argparse.Namespace) -> None:
    """Write the files, and print the format or the annotations that are asked for; UsageError when a file cannot be.

    `verdict` may be None where `wants_formats` says no.
    """
    if verdict is None or not wants_formats(arguments):
        return
    from gcodesim.files.whole_file import write_whole
    from gcodesim.formats import FilePlaces, writer_of

    places = FilePlaces.of(Path.cwd())
    for name, path in _files(arguments):
        text = writer_of(name)(verdict, places)
        try:
            write_whole(path, text.encode("utf-8", "replace"))
        except OSError as error:
            raise UsageError(f"{path} cannot be written: {error.strerror or error}") from None
    if arguments.format not in ("text", "json"):
        stream = raw(sys.stdout) if arguments.format == "github" else sys.stdout
        stream.write(writer_of(arguments.format)(verdict, places))
    if arguments.github and arguments.format != "github":
        # other formats need stdout for themselves; runners read both streams
        stream = raw(sys.stdout if arguments.format == "text" else sys.stderr)
        stream.write(writer_of("github")(verdict, places))
