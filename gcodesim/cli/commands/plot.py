"""`gcodesim plot LOG -o FIGURE`: charts of a run over time and program line."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from gcodesim.cli.exits import UsageError
from gcodesim.cli.moments import add_range, chosen_range, open_recording, reads_logs, status_of_reading
from gcodesim.cli.nearest import no_such
from gcodesim.cli.overwriting import refuse_foreign
from gcodesim.extras import require_extra

_USUAL = ("force", "power", "removal", "feed", "error")


def add_parser(commands: Any) -> None:
    parser = commands.add_parser(
        "plot",
        help="charts of force, power, feed, joints … as SVG or PNG",
        description="Draw numbers of a log over time, with the program lines along the top.",
        epilog="quantities: force, torque, power, removal, removed, spindle, feed, error, joints, speed, effort,"
        " and what the processes of a run log besides, by the names in its topic /process",
    )
    parser.add_argument("log", type=Path, metavar="LOG", help="a run.mcap, or the folder of a run")
    parser.add_argument(
        "--what", metavar="A,B", help=f"the quantities (default: those of {', '.join(_USUAL)} that are not all zero)"
    )
    add_range(parser)
    parser.add_argument(
        "-o", "--out", type=Path, metavar="FILE", help="a .svg, .png or .pdf (default: the program's name with .svg)"
    )
    parser.set_defaults(run=reads_logs(run))


def run(arguments: argparse.Namespace) -> int:
    require_extra("plot", "a chart")
    from gcodesim.files.whole_file import write_whole
    from gcodesim.playback.columns import own_fields
    from gcodesim.playback.quantities import charts_of, quantities_of
    from gcodesim.report.plot import FORMATS, NoPlotError, draw

    recording = open_recording(arguments.log)
    what = [name.strip() for name in (arguments.what or "").split(",") if name.strip()]
    known = quantities_of(recording)
    for name in what:
        if name not in known:
            raise UsageError(no_such("quantity", name, known))
    out = arguments.out if arguments.out is not None else Path(f"{Path(recording.name).stem}.svg")
    kind = out.suffix.lower().lstrip(".")
    if kind not in FORMATS:
        raise UsageError(f"{out.name}: a picture ends in .svg, .png or .pdf")
    if arguments.out is None:
        refuse_foreign(out)
    first_ns, last_ns = chosen_range(arguments, recording)
    usual = (*_USUAL, *own_fields(recording))
    charts = charts_of(recording, what) or [chart for chart in charts_of(recording, usual) if chart.speaks]
    try:
        picture = draw(recording, charts, kind, first_ns=first_ns, last_ns=last_ns)
    except NoPlotError as reason:
        raise UsageError(str(reason)) from None
    try:
        write_whole(out, picture)
    except OSError as error:
        raise UsageError(f"{out} cannot be written: {error.strerror}") from None
    print(f"wrote {out}")
    return status_of_reading(recording)
