"""`gcodesim export LOG --to FORMAT`: a log in the formats of other programs."""

from __future__ import annotations

import argparse
import sys
from io import BytesIO, StringIO
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from gcodesim.cli.exits import UsageError
from gcodesim.cli.moments import add_range, chosen_range, nanoseconds, open_recording, reads_logs, status_of_reading
from gcodesim.cli.overwriting import refuse_foreign

if TYPE_CHECKING:
    from gcodesim.export.select import TimeRange
    from gcodesim.playback import Recording

_SUFFIX: Final = {"csv": ".csv", "jsonl": ".jsonl", "stl": ".stl", "glb": ".glb", "rosbag2": "_bag"}
_TEXT: Final = ("csv", "jsonl")
_MOMENTS: Final = ("stl", "glb")

_HELP = """formats:
  csv      a table: one row an instant, the program line beside the numbers; names end in units
  jsonl    every message as logged, one JSON object a line
  stl      the part at a moment, in mm, in its own frame
  glb      the whole cell at a moment: robot or machine, tool, stock, path; in m
  rosbag2  a folder that ROS 2 tools read: /tf, /joint_states, /wrench, /robot_description …

examples:
  gcodesim export out --to csv -o run.csv --units mm --period 0.1
  gcodesim export out/run.mcap --to csv --topics /event
  gcodesim export out --to stl --at 12.5 -o half.stl
"""


def add_parser(commands: Any) -> None:
    parser = commands.add_parser(
        "export",
        help="a log as CSV, JSON lines, STL, GLB or ROS 2 bag",
        description="Write what a log holds in a format of other programs.",
        epilog=_HELP,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("log", type=Path, metavar="LOG", help="a run.mcap, or the folder of a run")
    parser.add_argument("--to", choices=tuple(_SUFFIX), required=True, help="the format")
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
    parser.add_argument("--at", type=nanoseconds, metavar="T", help="stl, glb: the moment; without it the end")
    parser.add_argument("--stock", metavar="NAME", help="stl: which stock, when there are several")
    parser.add_argument(
        "--world", action="store_true", help="stl: where the part stands in the world, not its own frame"
    )
    parser.set_defaults(run=reads_logs(run))


def run(arguments: argparse.Namespace) -> int:
    from gcodesim.export.select import TimeRange

    recording = open_recording(arguments.log)
    _refuse_useless(arguments)
    first_ns, last_ns = chosen_range(arguments, recording)
    part = TimeRange(first_ns=first_ns, last_ns=last_ns, period_ns=arguments.period)
    topics = [name if name.startswith("/") else f"/{name}" for name in arguments.topics.split(",") if name]
    if arguments.at is not None and arguments.at > recording.end_ns:
        raise UsageError(f"the run ends at {recording.end_ns * 1e-9:g} s, before {arguments.at * 1e-9:g} s")
    if arguments.to in _TEXT:
        _text(arguments, recording, topics, part)
    elif arguments.to in _MOMENTS:
        _moment(arguments, recording)
    else:
        _bag(arguments, recording, topics, part)
    return status_of_reading(recording)


def _refuse_useless(arguments: argparse.Namespace) -> None:
    """Options that the chosen format would ignore."""
    moment = arguments.to in _MOMENTS
    useless = {
        "--at": arguments.at is not None and not moment,
        "--topics": bool(arguments.topics) and moment,
        "--period": bool(arguments.period) and moment,
        "--time": arguments.time is not None and moment,
        "--lines": arguments.lines is not None and moment,
        "--stock": arguments.stock is not None and arguments.to != "stl",
        "--world": arguments.world and arguments.to != "stl",
        "--units": arguments.units != "si" and arguments.to != "csv",
    }
    for option, wrong in useless.items():
        if wrong:
            raise UsageError(f"{option} means nothing for {arguments.to}")


def _text(arguments: argparse.Namespace, recording: Recording, topics: list[str], part: TimeRange) -> None:
    from gcodesim.export.lines import write_lines
    from gcodesim.export.table import NoTableError, write_table

    stream = sys.stdout if arguments.out is None else StringIO()
    try:
        if arguments.to == "csv":
            count = write_table(recording, stream, topics, part, arguments.units)
        else:
            count = write_lines(recording, stream, topics, part)
    except NoTableError as reason:
        raise UsageError(str(reason)) from None
    if isinstance(stream, StringIO):
        _write(arguments.out, stream.getvalue().encode())
        what = "row" if arguments.to == "csv" else "message"
        print(f"wrote {count} {what}{'' if count == 1 else 's'} into {arguments.out}")


def _moment(arguments: argparse.Namespace, recording: Recording) -> None:
    from gcodesim.export.model import scene_glb
    from gcodesim.export.part import NoPartError, write_part

    out = _target(arguments, recording)
    moment = recording.end_ns if arguments.at is None else arguments.at
    if arguments.to == "glb":
        _write(out, scene_glb(recording, moment))
        print(f"wrote the cell at {moment * 1e-9:g} s into {out}")
        return
    file = BytesIO()
    try:
        written = write_part(recording, file, t_ns=arguments.at, stock=arguments.stock, world=arguments.world)
    except NoPartError as reason:
        status_of_reading(recording)  # damage may be the reason
        raise UsageError(str(reason)) from None
    _write(out, file.getvalue())
    how = "as computed" if written.exact else "as the log draws it"
    print(f"wrote the part at {moment * 1e-9:g} s, {how}, {written.triangles} triangles, into {out}")


def _bag(arguments: argparse.Namespace, recording: Recording, topics: list[str], part: TimeRange) -> None:
    from gcodesim.export.rosbag import NoRosError, write_bag
    from gcodesim.export.table import NoTableError

    out = _target(arguments, recording)
    try:
        count = write_bag(recording, out, topics, part)
    except (NoTableError, NoRosError, FileExistsError) as reason:
        raise UsageError(str(reason)) from None
    except OSError as error:
        raise UsageError(f"{out} cannot be written: {error.strerror}") from None
    print(f"wrote {count} messages into {out}")


def _target(arguments: argparse.Namespace, recording: Recording) -> Path:
    given: Path | None = arguments.out
    if given is not None:
        return given
    usual = Path(Path(recording.name).stem + _SUFFIX[arguments.to])
    refuse_foreign(usual)
    return usual


def _write(path: Path, data: bytes) -> None:
    from gcodesim.files.whole_file import write_whole

    try:
        write_whole(path, data)
    except OSError as error:
        raise UsageError(f"{path} cannot be written: {error.strerror}") from None
