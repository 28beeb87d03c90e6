"""`gcodesim post RUN --for krl`: what was checked, as a program of the control that will run it."""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from gcodesim.cli.exits import FINDINGS, OK, UsageError, status_of
from gcodesim.cli.language import Language
from gcodesim.cli.moments import open_recording, reads_logs
from gcodesim.cli.nearest import no_such
from gcodesim.cli.options import add_cell, add_channels, add_fail_on, add_format, add_language, read_source
from gcodesim.cli.outline import may_be
from gcodesim.cli.output import print_count, print_findings, print_json
from gcodesim.cli.overwriting import refuse_foreign
from gcodesim.diagnostics import Diagnostic, Severity, SourceText
from gcodesim.files.output_folder import LOG_NAME
from gcodesim.post import LANGUAGES

if TYPE_CHECKING:
    from gcodesim.jobs.job import Job
    from gcodesim.post.from_plan import Wish
    from gcodesim.post.meeting import MeetingLines

_TOLERANCE: Final = 0.01  # mm
_HELP: Final = """languages of robots:
  krl       KUKA: NAME.src and NAME.dat
  rapid     ABB: NAME.mod
  urscript  Universal Robots: NAME.script
  fanuc-ls  Fanuc: NAME.ls
`gcodesim list posts` names those of other packages too.

controls that read G-code, for a program (`gcodesim list dialects`): fanuc, grbl, linuxcnc, marlin, rs274 …
  the program with loops, calls, parameters and cycles unrolled, proven to give the same canonical events

examples:
  gcodesim post out --for krl
  gcodesim post out --for rapid --motion joint --tolerance 0.05
  gcodesim post part.nc --cell arm.yaml --for urscript --signal spindle=3
  gcodesim post part.ngc --for grbl
"""


def add_parser(commands: Any) -> None:
    parser = commands.add_parser(
        "post",
        help="what was checked, as a program of a robot's own control; G-code for another control",
        description="Write the path of a finished run, or of a program that is checked now, as a program of the robot's"
        " own control: points, speeds, rounded corners, frames, tools, external axes, outputs. What cannot be said"
        " there is told. Or write a G-code program for another control that reads G-code.",
        epilog=_HELP,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "program", type=Path, metavar="RUN", help="the folder of a run or its run.mcap; or a program, with --cell"
    )
    may_be(
        parser.add_argument("--for", dest="target", metavar="LANGUAGE", required=True, help="one of those below"),
        lambda: (*LANGUAGES, *_dialects()),
    )
    parser.add_argument("-o", "--out", type=Path, metavar="DIR", help="the folder for the files (default: this one)")
    parser.add_argument(
        "--motion",
        choices=("linear", "joint"),
        default="linear",
        help="lines and circles of the tip (default), or joints, in as many short moves as it takes",
    )
    parser.add_argument(
        "--tolerance",
        type=_length,
        default=_TOLERANCE,
        metavar="MM",
        help="how far the tip may be off between two points (default: 0.01 mm)",
    )
    parser.add_argument(
        "--signal",
        action="append",
        default=[],
        metavar="NAME=OUTPUT",
        help="the output of the control for P1 (M62 to M65), E0 (M67, M68), spindle, reverse, speed, flood, mist, or an"
        " M-code such as M10; with a fixed value as M11=7:0; may be given several times",
    )
    parser.add_argument(
        "--tool-change",
        default="",
        metavar="PROGRAM",
        help="the control's own program that changes tools, called with the number (default: stop for the new tool)",
    )
    parser.add_argument(
        "--meet",
        action="append",
        default=[],
        metavar="CHANNEL/OTHER=OUTPUT:INPUT",
        help="the lines over which the control of CHANNEL meets that of OTHER where programs wait for each other:"
        " its output there, and its input from there; may be given several times",
    )
    parser.add_argument("--only", metavar="CHANNEL", help="post the program of this channel alone")
    add_channels(parser)
    add_cell(parser, required=False)
    add_language(parser)
    add_format(parser)
    add_fail_on(parser)
    parser.set_defaults(run=reads_logs(run))


def run(arguments: argparse.Namespace) -> int:
    from gcodesim.post.from_plan import Wish
    from gcodesim.units import MM

    if arguments.target in _dialects():
        return _translate(arguments)
    if arguments.target not in LANGUAGES:
        raise UsageError(no_such("language", arguments.target, (*LANGUAGES, *_dialects())))
    signals = dict(_signal(text) for text in arguments.signal)
    wish = Wish(
        motion=arguments.motion,
        tolerance=arguments.tolerance * MM,
        signals=signals,
        tool_change=_program_name(arguments.tool_change),
        meet=dict(_lines(text) for text in arguments.meet),
    )
    if arguments.program.is_dir() or arguments.program.suffix == Path(LOG_NAME).suffix:
        if arguments.channel:
            raise UsageError("--channel names a program, and a run has all of its own; --only NAME posts one")
        with tempfile.TemporaryDirectory(prefix="gcodesim-") as scratch:
            return _write(arguments, _job_of_run(arguments, Path(scratch)), wish)
    return _write(arguments, _job_of_program(arguments), wish)


def _dialects() -> tuple[str, ...]:
    from gcodesim.rs274.dialects import DIALECTS

    return tuple(DIALECTS)


def _translate(arguments: argparse.Namespace) -> int:
    """The program for another control that reads G-code."""
    from dataclasses import replace

    from gcodesim.cli.language import reading_of
    from gcodesim.post.gcode_program import PRINTERS
    from gcodesim.post.translation import translated
    from gcodesim.rs274 import ToolTable

    given = {
        "--signal": bool(arguments.signal),
        "--motion": arguments.motion != "linear",
        "--tolerance": arguments.tolerance != _TOLERANCE,
        "--tool-change": bool(arguments.tool_change),
        "--meet": bool(arguments.meet),
        "--only": arguments.only is not None,
        "--channel": bool(arguments.channel),
    }
    for option, wanted in given.items():
        if wanted:
            raise UsageError(f"{option} means nothing for {arguments.target}, which reads G-code")
    if arguments.program.is_dir() or arguments.program.suffix == Path(LOG_NAME).suffix:
        raise UsageError(f"for {arguments.target}, give the program, not its run")
    reading = reading_of(arguments, arguments.program)
    if reading.run is None:
        print_findings(reading.findings(), reading.sources)
        return FINDINGS
    settings = reading.run.settings
    if arguments.cell is None and arguments.tools is None:
        settings = replace(settings, tool_table=ToolTable())  # those that were only assumed
    found = translated(reading.program, settings, arguments.target)
    suffix = ".gcode" if arguments.target in PRINTERS else ".nc"
    name = f"{Path(reading.program.name).stem}.{arguments.target}{suffix}"
    files = {} if found.text is None else {name: found.text}
    return _finish(arguments, reading.program.name, files, list(found.findings), reading.sources)


def _job_of_run(arguments: argparse.Namespace, scratch: Path) -> Job:
    """The job of a run without errors."""
    from gcodesim.post.checked import OtherInputsError, job_of

    recording = open_recording(arguments.program)
    results = recording.results
    if not results:
        raise UsageError(f"{arguments.program} is no finished run: it has no results")
    errors = [finding for finding in results.get("findings", ()) if finding["severity"] == "error"]
    if errors or results["status"] == "failed":
        first = f": {errors[0]['code']}: {errors[0]['message']}" if errors else ""
        raise UsageError(f"the run has errors, so there is no checked path to post{first}")
    language = Language.of(arguments)
    try:
        return job_of(
            recording,
            arguments.cell,
            scratch,
            allow_paths=arguments.allow_path,
            allow_code=arguments.allow_code,
            settings=language.over,
        )
    except OtherInputsError as reason:
        raise UsageError(str(reason)) from None


def _job_of_program(arguments: argparse.Namespace) -> Job:
    """A program that is checked now; UsageError where that finds an error."""
    from gcodesim.cell import load_cell
    from gcodesim.cli.simulate import further_programs
    from gcodesim.jobs.job import Options
    from gcodesim.simulation import check, prepare

    program = read_source(arguments.program, "program")
    if arguments.cell is None:
        raise UsageError("name the cell by --cell, or give the folder of a run")
    read_source(arguments.cell, "cell")
    language = Language.of(arguments)
    loaded = load_cell(arguments.cell, arguments.allow_path, allow_code=arguments.allow_code)
    options = Options(settings=language.over, sources=language.sources, channels=further_programs(arguments, loaded))
    job = prepare(program, loaded, options)
    errors = [finding for finding in check(job).findings if finding.level >= Severity.ERROR]
    if errors:
        print_findings(errors, job.sources)
        raise UsageError("the check finds errors, so there is no path to post")
    return job


def _write(arguments: argparse.Namespace, job: Job, wish: Wish) -> int:
    from gcodesim.diagnostics import Span
    from gcodesim.post.from_plan import NotPostedError, program_of

    language = LANGUAGES[arguments.target]()
    files: dict[str, str] = {}
    findings: list[Diagnostic] = []
    for one in _chosen(arguments, job, wish):
        try:
            program, unsaid = program_of(one, language, wish, job.all)
            written = language.write(program)
            if twice := sorted(files.keys() & written.files.keys()):
                raise NotPostedError(f"another channel has {twice[0]} already; post this one by --only {one.channel}")
            files |= written.files
            findings += [*unsaid, *written.findings]
        except NotPostedError as reason:
            findings.append(Diagnostic(code="GS801", span=Span(one.program.name), message=f"not posted: {reason}"))
    shown = job.shown(sorted(findings, key=lambda finding: finding.order))
    return _finish(arguments, job.program.name, files, shown, job.sources)


def _chosen(arguments: argparse.Namespace, job: Job, wish: Wish) -> tuple[Job, ...]:
    """The channels that are posted."""
    known = [one.channel for one in job.all]
    for name in (*([] if arguments.only is None else [arguments.only]), *(name for pair in wish.meet for name in pair)):
        if name not in known:
            raise UsageError(no_such("channel", name, known))
    return tuple(one for one in job.all if arguments.only in (None, one.channel))


def _finish(
    arguments: argparse.Namespace,
    name: str,
    files: dict[str, str],
    findings: list[Diagnostic],
    sources: Mapping[str, SourceText],
) -> int:
    """Write the files and say what there is to say."""
    from gcodesim.files.whole_file import write_whole

    folder: Path = arguments.out or Path()
    paths = [folder / file for file in files]
    for path in paths:
        refuse_foreign(path)
    try:
        if paths:
            folder.mkdir(parents=True, exist_ok=True)
        for path, text in zip(paths, files.values(), strict=True):
            write_whole(path, text.encode("ascii"))
    except OSError as error:
        raise UsageError(f"{folder} cannot be written: {error.strerror}") from None
    if arguments.format == "json":
        from gcodesim.diagnostics.show import as_json

        print_json({"schema": "gcodesim-post/1", "files": sorted(files), "findings": [as_json(f) for f in findings]})
    else:
        print_findings(findings, sources)
        print_count(name, findings)
        for path in paths:
            print(f"wrote {path}")
    return status_of(findings, arguments.fail_on) if findings else OK


def _signal(text: str) -> tuple[str, str]:
    name, equals, output = text.partition("=")
    if not (equals and name and output):
        raise UsageError(f"--signal {text}: NAME=OUTPUT is expected, such as spindle=3")
    _, colon, value = output.partition(":")
    if colon:
        try:
            float(value)
        except ValueError:
            raise UsageError(f"--signal {text}: {value} is no number") from None
    return name, output


def _lines(text: str) -> tuple[tuple[str, str], MeetingLines]:
    from gcodesim.post.meeting import MeetingLines

    channels, equals, lines = text.partition("=")
    own, slash, other = channels.partition("/")
    output, colon, read = lines.partition(":")
    if not (equals and slash and colon and own and other and output and read):
        raise UsageError(f"--meet {text}: CHANNEL/OTHER=OUTPUT:INPUT is expected, such as main/right=5:6")
    return (own, other), MeetingLines(output=output, input=read)


def _program_name(text: str) -> str:
    if text and not (text.isascii() and text.isidentifier()):
        raise UsageError(f"--tool-change {text}: the name of a program is expected, such as TOOLCHANGE")
    return text


def _length(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 1e-4 <= value <= 10.0:
        raise argparse.ArgumentTypeError(f"{text} is no length in mm from 0.0001 to 10")
    return value
