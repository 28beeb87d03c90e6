"""`gcodesim export LOG --to FORMAT`: a log in the formats of other programs."""

from __future__ import annotations

import argparse
import os
import shutil
import sys
from collections.abc import Sequence
from io import BytesIO, StringIO
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from gcodesim.cli.exits import UsageError
from gcodesim.cli.moments import add_range, chosen_range, nanoseconds, open_recording, reads_logs, status_of_reading
from gcodesim.cli.nearest import no_such
from gcodesim.cli.options import read_source
from gcodesim.cli.outline import may_be
from gcodesim.cli.overwriting import refuse_foreign
from gcodesim.declarations.scalars import measured
from gcodesim.declarations.units import find
from gcodesim.export import EXPORTERS
from gcodesim.extras import require_extra
from gcodesim.family import ExtensionError

if TYPE_CHECKING:
    from gcodesim.export.exporter import Exporter, Request
    from gcodesim.playback import Recording

_OWN_FORMATS: Final = ("gcodesim.export:EXPORTERS", "gcodesim.export.exporter:Exporter")

_HELP = """formats:
  csv      a table: one row an instant, the program line beside the numbers; names end in units
  jsonl    every message as logged, one JSON object a line
  stl      the part at a moment, in mm, in its own frame
  ply      the part in colours: how far from its target, by tool or by line (--by); at a moment without colours
  3mf      the same as 3MF, for programs that print and show parts
  glb      the whole cell at a moment: robot or machine, tool, stock, path; in m
  svg      a section of the part (--section z=-2), in mm
  png      heights of the part as a picture: 16 bit grey, white is high, black nothing; Y upwards
  npz      heights of the part for numpy: x_mm (n), y_mm (m), z_mm (n, m), NaN where nothing is left
  rosbag2  a folder that ROS 2 tools read: /tf, /joint_states, /wrench, /robot_description …
  usd      an OpenUSD stage with animation: links, tool, path, stock before and after; in m, Z up
`gcodesim list exporters` names those of other packages too.

examples:
  gcodesim export out --to csv -o run.csv --units mm --period 0.1
  gcodesim export out/run.mcap --to csv --topics /event
  gcodesim export out --to stl --at 12.5 -o half.stl
  gcodesim export out --to 3mf --simplify 0.02 -o light.3mf
"""


def add_parser(commands: Any) -> None:
    parser = commands.add_parser(
        "export",
        help="a log as CSV, JSON lines, STL, PLY, 3MF, GLB, OpenUSD or ROS 2 bag",
        description="Write what a log holds in a format of other programs.",
        epilog=_HELP,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("log", type=Path, metavar="LOG", help="a run.mcap, or the folder of a run")
    may_be(
        parser.add_argument(
            "--to", metavar="FORMAT", required=True, help="the format, one of those above the examples"
        ),
        lambda: tuple(EXPORTERS),
    )
    parser.add_argument(
        "--code",
        type=Path,
        action="append",
        default=[],
        metavar="FILE",
        help="run this Python file first, which adds a format of your own; may be given several times",
    )
    parser.add_argument(
        "-o",
        "--out",
        type=Path,
        metavar="FILE",
        help="where to; csv and jsonl go to the standard output without it, the others beside you",
    )
    parser.add_argument(
        "--topics",
        metavar="A,B",
        default="",
        help="only these topics of the log (csv, jsonl, rosbag2), such as `/process,/tcp`",
    )
    add_range(parser)
    parser.add_argument(
        "--period", type=nanoseconds, default=0, metavar="T", help="at most one sample in this time: `0.1`, `100 ms`"
    )
    parser.add_argument(
        "--units", choices=("si", "mm"), default="si", help="csv: m, rad, s (default) or mm, deg, mm/min"
    )
    parser.add_argument(
        "--at", type=nanoseconds, metavar="T", help="stl, ply, 3mf, glb: the moment; without it the end"
    )
    parser.add_argument(
        "--by",
        choices=("deviation", "tool", "line"),
        help="ply, 3mf: what the colours of the finished part mean; a run with a target has them (default: deviation)",
    )
    parser.add_argument(
        "--section",
        type=_section,
        metavar="AXIS=PLACE",
        help="svg: the plane, such as z=-2, in mm of the part's own frame",
    )
    parser.add_argument(
        "--stock", metavar="NAME", help="stl, ply, 3mf, svg, png, npz: which stock, when there are several"
    )
    parser.add_argument(
        "--world", action="store_true", help="stl, ply, 3mf: where the part stands in the world, not its own frame"
    )
    parser.add_argument(
        "--simplify",
        type=_distance,
        metavar="DISTANCE",
        help="stl, ply, 3mf: fewer triangles, no point of the surface farther off than this: `0.02` mm, `0.001 in`; "
        "closed, with the same volume, without colours",
    )
    parser.set_defaults(run=reads_logs(run))


def _section(text: str) -> tuple[str, float]:
    axis, _, place = text.strip().lower().partition("=")
    value = measured(place)
    unit = None if value is None else find(value.unit or "mm", "length")
    if axis not in ("x", "y", "z") or value is None or unit is None:
        raise argparse.ArgumentTypeError(f"a plane such as z=-2 or x='1 in' is expected, not {text}")
    return axis, value.value * unit.factor


def _distance(text: str) -> float:
    value = measured(text)
    unit = None if value is None else find(value.unit or "mm", "length")
    if value is None or unit is None or not 0.0 < value.value < inf:
        raise argparse.ArgumentTypeError(f"a distance above 0 such as 0.02 or '0.001 in' is expected, not {text}")
    return value.value * unit.factor


def run(arguments: argparse.Namespace) -> int:
    from gcodesim.export.exporter import NoExportError, Request
    from gcodesim.export.select import TimeRange

    _run_code(arguments.code)
    if arguments.to not in EXPORTERS:
        raise UsageError(no_such("format", arguments.to, EXPORTERS))
    exporter: Exporter = EXPORTERS[arguments.to]()
    if exporter.extra:
        require_extra(exporter.extra, f"--to {arguments.to}")
    recording = open_recording(arguments.log)
    _refuse_useless(arguments, exporter)
    first_ns, last_ns = chosen_range(arguments, recording)
    if arguments.at is not None and arguments.at > recording.end_ns:
        raise UsageError(f"the run ends at {recording.end_ns * 1e-9:g} s, before {arguments.at * 1e-9:g} s")
    request = Request(
        topics=tuple(name if name.startswith("/") else f"/{name}" for name in arguments.topics.split(",") if name),
        part=TimeRange(first_ns=first_ns, last_ns=last_ns, period_ns=arguments.period),
        units=arguments.units,
        at_ns=arguments.at,
        stock=arguments.stock,
        world=arguments.world,
        by=arguments.by,
        section=arguments.section,
        simplify=arguments.simplify or 0.0,
    )
    try:
        _WRITERS[exporter.writes](arguments, recording, exporter, request)
    except NoExportError as reason:
        status_of_reading(recording)  # damage may be the reason
        raise UsageError(str(reason)) from None
    return status_of_reading(recording)


def _run_code(files: Sequence[Path]) -> None:
    """Run Python files of the user, who names them here, for the formats that they add."""
    from gcodesim.cell.own_code import run_code

    modules: list[str] = []
    for file in files:
        try:
            run_code(read_source(file, "Python file"), (_OWN_FORMATS,), modules)
        except ExtensionError as error:
            raise UsageError(f"{file} cannot be used: {error}") from None


def _refuse_useless(arguments: argparse.Namespace, exporter: Exporter) -> None:
    """Options that the chosen format would ignore."""
    given = {
        "at": arguments.at is not None,
        "topics": bool(arguments.topics),
        "period": bool(arguments.period),
        "time": arguments.time is not None,
        "lines": arguments.lines is not None,
        "stock": arguments.stock is not None,
        "world": arguments.world,
        "by": arguments.by is not None,
        "section": arguments.section is not None,
        "simplify": arguments.simplify is not None,
        "units": arguments.units != "si",
    }
    for option, wanted in given.items():
        if wanted and option not in exporter.takes:
            raise UsageError(f"--{option} means nothing for {arguments.to}")


def _text(arguments: argparse.Namespace, recording: Recording, exporter: Exporter, request: Request) -> None:
    if arguments.out is None:
        exporter.write(recording, sys.stdout, request)
        return
    stream = StringIO()
    written = exporter.write(recording, stream, request)
    _write(arguments.out, stream.getvalue().encode())
    print(f"wrote {written} into {arguments.out}")


def _bytes(arguments: argparse.Namespace, recording: Recording, exporter: Exporter, request: Request) -> None:
    out = _target(arguments, recording, exporter)
    stream = BytesIO()
    written = exporter.write(recording, stream, request)
    _write(out, stream.getvalue())
    print(f"wrote {written} into {out}")


def _folder(arguments: argparse.Namespace, recording: Recording, exporter: Exporter, request: Request) -> None:
    out = _target(arguments, recording, exporter)
    is_new = not os.path.lexists(out)
    try:
        written = exporter.write(recording, out, request)
    except OSError as error:
        if is_new:
            shutil.rmtree(out, ignore_errors=True)  # what is in it is cut off
        raise UsageError(f"{out} cannot be written: {error.strerror}") from None
    print(f"wrote {written} into {out}")


_WRITERS: Final = {"text": _text, "bytes": _bytes, "folder": _folder}


def _target(arguments: argparse.Namespace, recording: Recording, exporter: Exporter) -> Path:
    given: Path | None = arguments.out
    if given is not None:
        return given
    usual = Path(Path(recording.name).stem + exporter.suffix)
    refuse_foreign(usual)
    return usual


def _write(path: Path, data: bytes) -> None:
    from gcodesim.files.whole_file import write_whole

    try:
        write_whole(path, data)
    except OSError as error:
        raise UsageError(f"{path} cannot be written: {error.strerror}") from None
