"""`gcodesim ros RUN --to HOST:PORT`: an arm of ROS 2 follows a run, and is compared with it."""

from __future__ import annotations

import argparse
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gcodesim.cli.exits import FINDINGS, OK, UsageError
from gcodesim.cli.moments import add_range, chosen_range, nanoseconds, open_recording, reads_logs
from gcodesim.cli.options import add_format
from gcodesim.cli.output import note, print_findings, print_json
from gcodesim.diagnostics import Diagnostic, Span

if TYPE_CHECKING:
    from gcodesim.export.joint_trajectory import JointDeviation, JointTrajectory, StateRecord


def add_parser(commands: Any) -> None:
    parser = commands.add_parser(
        "ros",
        help="an arm of ROS 2 follows a run; its joint states are compared with the run",
        description="Send the commanded joints of a run as a trajectory_msgs/JointTrajectory over rosbridge, so that "
        "an arm of ros2_control follows it, listen to its joint states, and say how far each joint was off. Or compare "
        "joint states that a bag has, or a CSV file (time_s and the joints by name, in rad or m). Nothing checks what "
        "the arm does while it moves: stand at its stop button.",
        epilog="example: gcodesim ros out --to 127.0.0.1:9090 --listen 60 --tolerance 0.5",
    )
    parser.add_argument("log", type=Path, metavar="RUN", help="the folder of a run, or its run.mcap")
    parser.add_argument("--to", metavar="HOST:PORT", help="where rosbridge listens, such as 127.0.0.1:9090")
    parser.add_argument(
        "--states", type=Path, metavar="BAG|CSV", help="compare with the joint states of this bag, or table, instead"
    )
    parser.add_argument(
        "--topic",
        metavar="NAME",
        default="/joint_trajectory_controller/joint_trajectory",
        help="where the controller listens (default: /joint_trajectory_controller/joint_trajectory)",
    )
    parser.add_argument(
        "--states-topic",
        metavar="NAME",
        default="/joint_states",
        help="where states come from (default: /joint_states)",
    )
    parser.add_argument(
        "--listen",
        type=_seconds,
        metavar="S",
        help="how long to listen for joint states (default: as long as the run, and two seconds)",
    )
    parser.add_argument(
        "--wait", type=_seconds, default=3.0, metavar="S", help="how long to wait for rosbridge to answer (default: 3)"
    )
    parser.add_argument(
        "--tolerance",
        type=_seconds,
        default=1.0,
        metavar="DEG",
        help="how far a joint may be off, in deg, or mm of one that slides (default: 1)",
    )
    add_range(parser)
    parser.add_argument(
        "--period", type=nanoseconds, default=0, metavar="T", help="at most one point in this time: `0.1`, `100 ms`"
    )
    add_format(parser)
    parser.set_defaults(run=reads_logs(run))


def run(arguments: argparse.Namespace) -> int:
    from gcodesim.export.joint_trajectory import JointTrajectory, deviations
    from gcodesim.export.select import TimeRange

    if (arguments.to is None) == (arguments.states is None):
        raise UsageError("name either rosbridge by --to HOST:PORT, or a bag by --states BAG")
    recording = open_recording(arguments.log)
    first_ns, last_ns = chosen_range(arguments, recording)
    part = TimeRange(first_ns=first_ns, last_ns=last_ns, period_ns=arguments.period)
    trajectory = JointTrajectory.of(recording, part)
    if not len(trajectory.t_ns):
        raise UsageError("the log does not say where the joints were told to be")
    states = _followed(arguments, trajectory) if arguments.states is None else _of_bag(arguments)
    if states is None:
        print(f"sent {len(trajectory.t_ns)} points of {len(trajectory.names)} joints to {arguments.topic}")
        return OK
    try:
        shift, found = deviations(trajectory, states)
    except ValueError as reason:
        raise UsageError(str(reason)) from None
    from gcodesim.playback.columns import joint_kinds

    slides = [kind == "prismatic" for kind in joint_kinds(recording).values()]
    return _told(arguments, recording.name, shift, found, slides, len(states.t))


def _followed(arguments: argparse.Namespace, trajectory: JointTrajectory) -> StateRecord | None:
    """What an arm said while it followed; None where nobody listens."""
    from gcodesim.export.joint_trajectory import StateRecord
    from gcodesim.export.rosbridge import NoBridgeError, follow
    from gcodesim.units import NS_PER_SECOND

    host, colon, port = arguments.to.rpartition(":")
    if not (colon and host and port.isdigit() and 0 < int(port) < 65536):
        raise UsageError(f"--to {arguments.to}: HOST:PORT is expected, such as 127.0.0.1:9090")
    duration = float(trajectory.t_ns[-1]) / NS_PER_SECOND
    seconds = duration + 2.0 if arguments.listen is None else arguments.listen
    try:
        told = follow(
            trajectory,
            host,
            int(port),
            topic=arguments.topic,
            states=arguments.states_topic,
            seconds=seconds,
            wait=arguments.wait,
        )
    except NoBridgeError as reason:
        raise UsageError(str(reason)) from None
    if seconds <= 0.0:
        return None
    if not told:
        raise UsageError(f"no joint states came on {arguments.states_topic} within {seconds:g} s")
    return StateRecord.of(told)


def _of_bag(arguments: argparse.Namespace) -> StateRecord:
    """The joint states of a bag, or of a table."""
    from gcodesim.export.joint_trajectory import StateRecord, read_state_table
    from gcodesim.export.rosbag import read_states

    try:
        if arguments.states.suffix.lower() == ".csv":
            return read_state_table(arguments.states)
        messages = read_states(arguments.states, arguments.states_topic)
    except (OSError, ValueError) as reason:
        raise UsageError(f"{arguments.states} cannot be read: {reason}") from None
    if not messages:
        raise UsageError(f"{arguments.states} has no joint states on {arguments.states_topic}")
    return StateRecord.of(messages)


def _told(
    arguments: argparse.Namespace,
    name: str,
    shift: float,
    found: list[JointDeviation],
    slides: list[bool],
    count: int,
) -> int:
    from gcodesim.units import DEG, MM

    units = [("mm", MM) if sliding else ("deg", DEG) for sliding in slides]
    findings = [
        Diagnostic(
            code="GS805",
            span=Span(name),
            message=f"joint {joint.name} was {joint.most / size:.3f} {unit} off the run",
            time=joint.at,
            value=joint.most / size,
            limit=arguments.tolerance,
            unit=unit,
            hint=f"more than {arguments.tolerance:g} {unit}: slow the program down, or look at the controller's gains",
        )
        for joint, (unit, size) in zip(found, units, strict=True)
        if joint.most / size > arguments.tolerance
    ]
    if arguments.format == "json":
        rows = [
            {
                "joint": joint.name,
                "unit": unit,
                "greatest": joint.most / size,
                "time_s": joint.at,
                "root_mean_square": joint.mean / size,
            }
            for joint, (unit, size) in zip(found, units, strict=True)
        ]
        print_json(
            {"schema": "gcodesim-ros/1", "states": count, "shift_s": shift, "joints": rows, "same": not findings}
        )
        return FINDINGS if findings else OK
    print_findings(findings, {})
    for joint, (unit, size) in zip(found, units, strict=True):
        print(f"{joint.name}: at most {joint.most / size:.3f} {unit} off, at {joint.at:.3f} s")
    note(f"{count} joint states compared; their clock is {shift:.3f} s ahead of the run's")
    return FINDINGS if findings else OK


def _seconds(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 0.0 <= value <= 1e6:
        raise argparse.ArgumentTypeError(f"{text} is no number from 0 on")
    return value
