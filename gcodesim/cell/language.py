"""What a cell tells the program reader: tools, work offsets, M-codes, path control."""

from __future__ import annotations

from math import degrees
from typing import TYPE_CHECKING, Final

import numpy as np

from gcodesim import canon
from gcodesim.arithmetic.elementary import atan2
from gcodesim.arithmetic.matrices import applied
from gcodesim.canon.systems import name_of_system
from gcodesim.cell import Cell, Placement, place
from gcodesim.cell.arm_point import ArmPoint
from gcodesim.cell.cell import MAIN
from gcodesim.cell.device import Device
from gcodesim.cell.externals import SLIDING, columns_of
from gcodesim.cell.machine import MachineTool, is_lathe
from gcodesim.cell.robot import Robot
from gcodesim.cell.tool_point import MachinePoint
from gcodesim.diagnostics import Diagnostic, Severity, SourceText
from gcodesim.frames import Pose
from gcodesim.processes.signal import SPINDLE, signals_read_by
from gcodesim.rs274 import MappedAction, Settings, ToolEntry, ToolTable, read_parameters
from gcodesim.rs274.dialects import DIALECTS
from gcodesim.rs274.tilt import Tilt
from gcodesim.units import MM

if TYPE_CHECKING:
    from gcodesim.tools.tool import Tool

AXIS_PLACES: Final = ("X", "Y", "Z")

USUAL_PATH_CONTROL: Final = "G64"

KEPT_CORNERS: Final = "G64 P0.01"
"""Of a lathe: with G64 alone a rapid along the work would begin before the tool has left its groove."""

_UNTURNED: Final = 1e-6  # deg


def settings_of_cell(
    cell: Cell, channel: str = MAIN, placement: Placement | None = None
) -> tuple[Settings, list[Diagnostic]]:
    """Reader settings for the program of one channel, and what is wrong with the files that it names.

    Tool lengths are those that the control uses: from `tool_table` where the
    cell names one, else the true ones.
    """
    if channel not in cell.channels:
        channel = next(iter(cell.channels))
    own = cell.channels[channel]
    placement = placement or place(cell, channel)
    findings: list[Diagnostic] = []
    offsets = {number: length_offset(tool, cell.machine_of(channel)) for number, tool in cell.tools.items()}
    lengths = {number: z for number, (_, _, z) in offsets.items()}
    table = ToolTable(
        {
            number: ToolEntry(
                number=number,
                pocket=number,
                offset=(*offsets[number], 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
                diameter=float(getattr(tool, "diameter", 2.0 * getattr(tool, "nose_radius", 0.0))),
                orientation=int(getattr(tool, "orientation", 0)),
                comment=tool.name,
            )
            for number, tool in cell.tools.items()
        }
    )
    if own.tool_table is not None:
        table, problems = ToolTable.read(SourceText.read(own.tool_table.path, own.tool_table.name))
        findings += problems
        findings += _differing(cell, channel, table, lengths)
    parameters: dict[int, float] = {}
    if own.parameters is not None:
        parameters, more = read_parameters(SourceText.read(own.parameters.path, own.parameters.name))
        findings += more
    if own.parameters is None:
        parameters = placement.parameters()
    else:  # the cell's own work offsets override those of the file
        parameters |= placement.parameters(placement.given)
    for number, value in _reference_points(cell.machine_of(channel)).items():
        parameters.setdefault(number, value)
    if not DIALECTS[own.dialect].turned_systems:
        findings += _turned(cell, channel, placement)
    columns = _columns(cell, channel)
    leans = {index: _axes_of(placement.work_offsets[index]) for index in placement.leaning}
    settings = Settings(
        dialect=own.dialect,
        tool_table=table,
        parameters=parameters,
        subroutines=tuple(folder.path for folder in own.subroutines),
        block_delete=own.block_delete,
        optional_stop=own.optional_stop,
        m_codes=_actions(cell, channel),
        wired=_wired(cell, channel),
        has_cell=True,
        unplaced=placement.automatic,
        turns=is_lathe(cell.machine_of(channel)),
        unturned=frozenset(n for n, tool in cell.tools.items() if not _turns(tool)),
        tool_length=own.tool_length,
        loaded_tool=own.loaded_tool or 0,
        auto_length=lengths,
        auto_aside={number: (x, y) for number, (x, y, _) in offsets.items() if x or y},
        path_control=_path_control(cell, channel),
        startup=None if own.startup is None else own.startup.source(),
        tool_point=_tool_point(cell, channel, placement),
        tip_first=cell.machine_of(channel).tip_first,
        c_goes_round=_c_goes_round(cell.machine_of(channel)),
        columns=columns,
        leans=leans,
        length_leans=bool(leans) and _leans_along(cell, channel),
        travel=_travel(cell.machine_of(channel)),
        limits={} if own.firmware is None else own.firmware.limits,
        lane="grammar" if columns or leans else "auto",
        options={
            "decimal_point": own.decimal_point,
            "compensation_start": own.compensation_start,
            "compensation_blocks": str(own.compensation_blocks),
        },
    )
    return settings, findings


def _turns(tool: Tool) -> bool:
    """Whether it works only while a spindle turns it; a drag knife cuts like a mill and does not."""
    return SPINDLE.name in signals_read_by([tool]) and bool(getattr(tool, "turns", True))


def length_offset(tool: Tool, mover: MachineTool | Robot) -> canon.Point:
    """What a control adds to the tip to give its axes [m]: on a machine from the tip to the nose of its spindle, in X,
    Y and Z with all axes at zero; on an arm, whose tip is known in all directions, the length of the tool."""
    if tool.tcp is None or not mover.axes:
        return (0.0, 0.0, tool.true_length)
    from gcodesim.kinematics import kinematics_of

    kinematics = kinematics_of(mover.chain)
    R_MF = kinematics.forward(np.zeros((1, len(kinematics.joints))))[0, :3, :3]
    x, y, z = (-applied(R_MF, tool.X_FT.p) + 0.0).tolist()
    return (x, y, z)


def _tool_point(cell: Cell, channel: str, placement: Placement) -> MachinePoint | ArmPoint | None:
    mover = cell.machine_of(channel)
    return MachinePoint.of(mover) if mover.axes else ArmPoint.of(cell, channel, placement)


def _c_goes_round(mover: MachineTool | Robot) -> float:
    """`Settings.c_goes_round`: an axis that turns the work takes the tool round it the other way."""
    axis = next((axis for axis in mover.axes if axis.letter == "C"), None)
    if axis is None:
        return 1.0
    upward = axis.direction is None or axis.direction[2] >= 0.0
    return 1.0 if upward == (axis.side == "tool") else -1.0


def _axes_of(X_MP: Pose) -> Tilt:
    """The axes of a work system that leans."""
    x, y, z = ((float(a), float(b), float(c)) for a, b, c in X_MP.R)
    return Tilt((0.0, 0.0, 0.0), (x, y, z))


def _leans_along(cell: Cell, channel: str) -> bool:
    """Whether the tool stands upright in whichever work system is in force."""
    own = cell.channels[channel].orientation
    return not cell.machine_of(channel).axes and (own is None or own.tool_axis.frame is None)


def _columns(cell: Cell, channel: str) -> dict[str, int]:
    """Which of A, B, C carries the value of U, V or W, where these move an external axis."""
    mover, own = cell.machine_of(channel), cell.channels[channel].orientation
    words = () if own is None else own.words or ()
    columns = columns_of(mover.externals, [turn.word for turn in words])
    return {letter.lower(): column for letter, column in columns.items() if letter in SLIDING}


def _reference_points(machine: object) -> dict[int, float]:
    """Where G28 and G30 lead on a lathe [mm]: home, since machine zero is in the chuck."""
    if not is_lathe(machine):
        return {}
    return {
        first + AXIS_PLACES.index(axis.letter): axis.home / MM
        for first in (5161, 5181)
        for axis in getattr(machine, "axes", ())
        if axis.letter in AXIS_PLACES
    }


def _travel(mover: MachineTool | Robot) -> dict[str, tuple[float, float]]:
    """The travel of the axes that go straight."""
    return {axis.letter: (axis.lower, axis.upper) for axis in mover.axes if axis.letter in AXIS_PLACES}


def _path_control(cell: Cell, channel: str) -> str:
    """What is in force before the program says so; on a lathe corners are kept, unless the cell says otherwise."""
    own, machine = cell.channels[channel], cell.machine_of(channel)
    said = own.path_control != USUAL_PATH_CONTROL
    return KEPT_CORNERS if is_lathe(machine) and not said else own.path_control


def _actions(cell: Cell, name: str) -> dict[str, MappedAction]:
    """What M-codes do: those of `m_codes`, those that switch or set a signal alone, those that have a sensor read."""
    found: dict[str, MappedAction] = {}
    channel = cell.channels[name]
    for sensor, mounted in cell.sensors.items():
        for code in () if mounted.mount.trigger is None else mounted.mount.trigger.codes:
            found.setdefault(code, MappedAction(target=sensor, verb="read"))
    words = [(signal, source.word) for signal, source in channel.signals.items()]
    words += [(device.name, device.word) for device in devices_of(cell, name)]
    for target, word in words:
        for code in word.codes:
            verb = "off" if code == word.off else "on" if word.off else "set"
            found.setdefault(code, MappedAction(target=target, verb=verb))
    return found | {word: MappedAction(target=code.target, verb=code.verb) for word, code in channel.m_codes.items()}


def _wired(cell: Cell, name: str) -> frozenset[str]:
    """Outputs that a signal, an input, a device or a sensor follows."""
    channel = cell.channels[name]
    pins = [source.word.pin for source in channel.signals.values()]
    pins += [source.output for source in channel.inputs.values()]
    pins += [device.word.pin for device in devices_of(cell, name)]
    pins += [mounted.mount.trigger.pin for mounted in cell.sensors.values() if mounted.mount.trigger is not None]
    return frozenset(pin for pin in pins if pin is not None)


def devices_of(cell: Cell, channel: str) -> list[Device]:
    """The devices that the program of a channel switches."""
    first = next(iter(cell.channels))
    return [device for device in cell.devices.values() if (device.channel or first) == channel]


def _turned(cell: Cell, channel: str, placement: Placement) -> list[Diagnostic]:
    """An error for each work system that is turned about Z, which the control of the channel cannot do."""
    found = []
    dialect = cell.channels[channel].dialect
    for index in sorted(set(placement.given).difference(placement.leaning)):
        R = placement.work_offsets[index].R
        if abs(turn := degrees(atan2(float(R[1, 0]), float(R[0, 0])))) > _UNTURNED:
            name = name_of_system(index)
            found.append(
                Diagnostic(
                    code="GS726",
                    severity=Severity.ERROR,
                    span=cell.channel_span(channel, "work_offsets", name),
                    message=f"{name} is turned by {turn:.6g} deg about Z; work systems of `{dialect}` are only shifted",
                    hint="let the program turn it (G68 X0 Y0 R…), or turn the stock and what holds it",
                )
            )
    return found


def _differing(cell: Cell, channel: str, table: ToolTable, lengths: dict[int, float]) -> list[Diagnostic]:
    """A warning for each tool that is longer or shorter for the control than in reality."""
    span = cell.channel_span(channel, "tool_table")
    return [
        Diagnostic(
            code="GS732",
            span=span,
            message=f"the tool table says T{number} is {table[number].offset[2] / MM:.3f} mm long; "
            f"`tools:` says {length / MM:.3f} mm",
            hint="the tip will be off by the difference, as on the machine",
            value=table[number].offset[2],
            limit=length,
            unit="m",
        )
        for number, length in sorted(lengths.items())
        if number in table and abs(table[number].offset[2] - length) > 1e-6
    ]
