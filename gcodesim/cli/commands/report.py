"""`gcodesim report LOG`: one HTML file with replay, findings, charts and tables; or where the time goes, as text."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from gcodesim.cli.exits import UsageError
from gcodesim.cli.moments import open_recording, reads_logs, status_of_reading
from gcodesim.cli.options import add_format
from gcodesim.cli.overwriting import refuse_foreign
from gcodesim.extras import require_extra
from gcodesim.files.output_folder import SETUPS_NAME

if TYPE_CHECKING:
    from gcodesim.playback import Recording
    from gcodesim.report.page import SetupRow
    from gcodesim.report.times import TimeReport

_SLOWEST: Final = 20
_FEW_LAYERS: Final = 30


def add_parser(commands: Any) -> None:
    parser = commands.add_parser(
        "report",
        help="one HTML file with replay, findings, charts and tables; or where the time goes",
        description="Write one HTML file that shows a run without a network: 3D replay with a time bar, program, "
        "findings, charts, tables. With --times print where the time goes instead.",
    )
    parser.add_argument("log", type=Path, metavar="LOG", help="a run.mcap, or the folder of a run or a job")
    parser.add_argument("other", type=Path, metavar="OTHER", nargs="?", help="a second run, shown beside the first")
    parser.add_argument("-o", "--out", type=Path, metavar="FILE", help="the page (default: report.html)")
    parser.add_argument(
        "--times",
        action="store_true",
        help="print the time by tool, operation, layer and line; the parts add up to the total",
    )
    add_format(parser)
    parser.set_defaults(run=reads_logs(run))


def run(arguments: argparse.Namespace) -> int:
    if not arguments.times and arguments.format != "json":
        require_extra("report", "a page")
    if arguments.other is None and (arguments.log / SETUPS_NAME).is_file() and not arguments.times:
        return _write(arguments, *_setups(arguments.log))
    recordings = [open_recording(path) for path in (arguments.log, arguments.other) if path is not None]
    if arguments.times:
        from gcodesim.cli.output import print_json
        from gcodesim.report.times import time_report

        if len(recordings) > 1:
            raise UsageError("--times is about one run")
        report = time_report(recordings[0])
        if arguments.format == "json":
            print_json(report.as_json())
        else:
            _print_times(report)
        return status_of_reading(*recordings)
    return _write(arguments, recordings)


def _setups(folder: Path) -> tuple[Sequence[Recording], Sequence[str], Sequence[SetupRow]]:
    """The runs of a job."""
    from gcodesim.playback import RecordingError
    from gcodesim.report.setups import stored_setups

    try:
        stored = stored_setups(folder)
    except RecordingError as error:
        raise UsageError(str(error)) from None
    return stored.recordings, stored.names, stored.rows


def _write(
    arguments: argparse.Namespace,
    recordings: Sequence[Recording],
    names: Sequence[str] = (),
    setups: Sequence[SetupRow] = (),
) -> int:
    """Write the page."""
    if arguments.format == "json":
        raise UsageError("--format json means nothing for a page; --times has numbers")
    from gcodesim.files.whole_file import write_whole
    from gcodesim.report.libraries import LibraryMissingError
    from gcodesim.report.page import write_page

    out = arguments.out
    if out is None:
        out = Path("report.html")
        refuse_foreign(out)
    try:
        page = write_page(recordings, names, setups=setups).encode()
    except LibraryMissingError as reason:
        raise UsageError(str(reason)) from None
    try:
        write_whole(out, page)
    except OSError as error:
        raise UsageError(f"{out} cannot be written: {error.strerror}") from None
    print(f"wrote {out}, {len(page) / 1e6:.1f} MB; open it in a browser")
    return status_of_reading(*recordings)


def _print_times(report: TimeReport) -> None:
    from gcodesim.cli.output import print_table
    from gcodesim.report.times import slowest
    from gcodesim.units import MM, MM3

    total = max(report.total, 1e-9)

    def share(seconds: float) -> str:
        return f"{100.0 * seconds / total:.1f} %"

    print(f"{report.total:.1f} s in all")
    print("\nby tool: moves, dwells and its change")
    rows = [["tool", "time", "", "in material", "removed"]]
    for tool in report.tools:
        name = tool.name if tool.name in ("no tool", f"T{tool.number}") else f"T{tool.number} {tool.name}"
        volume = f"{tool.removed / MM3:.0f} mm³"
        rows.append([name, f"{tool.seconds:.1f} s", share(tool.seconds), f"{tool.engaged:.1f} s", volume])
    print_table(rows)
    if report.operations:
        print("\nby operation: from one tool change, or one comment that stands alone, to the next")
        head = [
            "operation",
            "tool",
            "lines",
            "time",
            "",
            "removed",
            "at feed",
            "mean",
            "least",
            "share at the feed",
            "in the air",
        ]
        rows = [head]
        for one in report.operations:
            rows.append(
                [
                    str(one["name"]),
                    f"T{one['tool']}",
                    f"{one['first_line']} to {one['last_line']}",
                    f"{one['time_s']:.1f} s",
                    share(one["time_s"]),
                    "" if one.get("removed_mm3") is None else f"{one['removed_mm3']:.0f} mm³",
                    f"{one['feed_mm']:.0f} mm",
                    f"{one['mean_feed_mm_min']:.0f} mm/min",
                    f"{one['least_feed_mm_min']:.0f} mm/min",
                    f"{100.0 * one['share_at_feed']:.0f} %",
                    "" if one.get("air_share") is None else f"{100.0 * one['air_share']:.0f} %",
                ]
            )
        print_table(rows)
    if report.layers:
        print("\nby layer: with the moves that lead to it")
        rows = [["Z", "time", "", "at work"]]
        shown = report.layers[:_FEW_LAYERS]
        for layer in shown:
            z = "-" if layer.z is None else f"{layer.z / MM:.3f} mm"
            rows.append([z, f"{layer.seconds:.1f} s", share(layer.seconds), f"{layer.engaged:.1f} s"])
        if len(report.layers) > len(shown):
            others = report.layers[len(shown) :]
            seconds = sum(layer.seconds for layer in others)
            work = sum(layer.engaged for layer in others)
            rows.append([f"{len(others)} others", f"{seconds:.1f} s", share(seconds), f"{work:.1f} s"])
        print_table(rows)
    print("\nby line: the slowest")
    top = slowest(report.lines, _SLOWEST)
    rows = [["line", "time", "", "times", "program"]]
    rows += [
        [f"{line.file}:{line.line}", f"{line.seconds:.2f} s", share(line.seconds), str(line.count), line.text]
        for line in top
    ]
    rest = report.total - sum(line.seconds for line in top)
    if len(report.lines) > len(top):
        rows.append([f"{len(report.lines) - len(top)} others", f"{rest:.2f} s", share(rest)])
    print_table(rows, texts=(4,))
