"""Where the work is: work systems in the machine; stock, fixtures and target in the world.

On a machine tool M is machine zero. So is its base B, but on a lathe B is the nose
of its spindle. On an arm M is the base frame B, except that
M is turned about B's origin when the work systems are tilted in B: G-code knows
only a shift and a turn about Z of M, so Z of M has to be parallel to theirs.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import field, replace
from itertools import product
from typing import Final

import numpy as np

from gcodesim.arithmetic.elementary import acos, atan2
from gcodesim.arithmetic.matrices import multiplied
from gcodesim.canon.systems import SYSTEMS, system_index
from gcodesim.cell.cell import MAIN, Cell
from gcodesim.cell.channel import Channel
from gcodesim.cell.machine import MachineTool, is_lathe
from gcodesim.cell.orientation import Orientation
from gcodesim.cell.placing import Carried
from gcodesim.cell.placing import Place as Standing
from gcodesim.cell.robot import Robot
from gcodesim.cell.stock import StockShape
from gcodesim.diagnostics import Diagnostic, Severity
from gcodesim.frames import Array, Pose
from gcodesim.frozen import frozen
from gcodesim.rs274.dialects import DIALECTS
from gcodesim.rs274.dialects.systems import first_of_system
from gcodesim.solids import Box, Cylinder
from gcodesim.units import DEG, MM

Bounds = tuple[tuple[float, float, float], tuple[float, float, float]]

STOCK: Final = "stock"
FIXTURE: Final = "fixture"
PART: Final = "part"
SENSOR: Final = "sensor"
DEVICE: Final = "device"
UNDER_BED: Final = 0.01  # m by which the longest tool could go below the top of a bed
CLEARANCE: Final = 0.1  # m by which the longest tool clears the stock's top, at the top of Z
CHUCK_FACE: Final = 0.08  # m from the nose of a lathe's spindle to the end of stock without a place
_UPRIGHT: Final = 1e-9  # Z axes whose dot product is nearer to 1 than this count as parallel


@frozen
class Placement:
    """The places of everything that depends on the work systems.

    `X_WM` is M of the channel in the world; `work_offsets` X_MP of systems 1 (G54) to 9 (G59.3), and of
    additional ones that the cell names (101 is G54.1 P1); those of `leaning` do not just turn about Z of M.
    `stocks`, `fixtures`, `parts` and `target` are X_W of the bodies' own frames, and `sensors` of theirs, without
    those that stand on a link: these are `carried`, by names such as `stock/plate`, `fixture/clamp` and `sensor/eye`.
    `given` are the systems that the cell names; `automatic`: G54 was chosen by the rule for stock without a place.
    `platforms` says on which link an external axis carries a system; its offset holds with that axis at zero. Those of
    `borne` are moved so by the programs of other channels.
    """

    X_WM: Pose
    work_offsets: Mapping[int, Pose]
    given: tuple[int, ...]
    automatic: bool
    stocks: Mapping[str, Pose]
    fixtures: Mapping[str, Pose]
    target: Pose | None
    sensors: Mapping[str, Pose] = field(default_factory=dict)
    carried: Mapping[str, Carried] = field(default_factory=dict)
    parts: Mapping[str, Pose] = field(default_factory=dict)
    platforms: Mapping[int, str] = field(default_factory=dict)
    borne: Mapping[int, str] = field(default_factory=dict)
    devices: Mapping[str, Pose] = field(default_factory=dict)
    frames: Mapping[str, Pose] = field(default_factory=dict)
    findings: tuple[Diagnostic, ...] = ()

    def X_W(self, name: str) -> Pose:
        """The pose of a frame or work system (`table`, `G54`) in the world; KeyError when there is none."""
        if name in self.frames:
            return self.frames[name]
        return self.X_WM @ self.work_offsets.get(system_index(name), Pose.identity())

    def parameters(self, systems: Iterable[int] | None = None) -> dict[int, float]:
        """Offsets of `systems` (default: all) in the control's parameters.

        5221 X, 5222 Y, 5223 Z [mm], 5230 turn about Z [deg], the next system 20 further; additional ones
        where their dialect says, without a turn. Axes of leaning systems stand in no parameter.
        """
        values: dict[int, float] = {}
        for index in self.work_offsets if systems is None else systems:
            X_MP, first = self.work_offsets[index], first_of_system(index)
            for axis in range(3):
                values[first + axis] = float(X_MP.p[axis]) / MM
            if index > len(SYSTEMS):
                continue
            upright = not _leans(X_MP)
            values[first + 9] = atan2(float(X_MP.R[1, 0]), float(X_MP.R[0, 0])) / DEG if upright else 0.0
        return values

    @property
    def leaning(self) -> tuple[int, ...]:
        """Systems whose Z is not that of M."""
        return tuple(index for index, X_MP in self.work_offsets.items() if _leans(X_MP))

    def tool_axis(self, orientation: Orientation | None, system: int = 1) -> Array:
        """Direction of the tool's Z in the world (3,), by an arm's `orientation`; default −Z of `system`."""
        wanted = (orientation or Orientation()).tool_axis
        X_WA = self.X_WM @ self.work_offsets[system] if wanted.frame is None else self.X_W(wanted.frame)
        return X_WA.rotate(np.array(wanted.axis))


def place(cell: Cell, channel: str = MAIN) -> Placement:
    """Where the work of `channel` is, by the rules of the cell file; a pure function.

    Findings: GS725 (a note on what was chosen), GS726 (a tilted system on a machine).
    """
    if channel == MAIN and channel not in cell.channels:
        channel = next(iter(cell.channels))
    own = cell.channels[channel]
    mover = cell.machine_of(channel)
    findings: list[Diagnostic] = []
    X_WM = mover.X_WM if mover.axes else _upright_base(cell, own, mover)
    offsets = {index: Pose.identity() for index in range(1, len(SYSTEMS) + 1)}
    for name, standing in own.work_offsets.items():
        X_MP = _offset(cell, X_WM, mover.X_WM, standing)
        offsets[system_index(name)] = X_MP
        if mover.axes and _leans(X_MP):
            tilt = np.degrees(acos(np.clip(X_MP.R[2, 2], -1, 1)))
            findings.append(
                Diagnostic(
                    code="GS726",
                    span=cell.channel_span(channel, "work_offsets", name),
                    severity=Severity.ERROR if is_lathe(mover) else None,
                    message=f"{name} is tilted by {tilt:.6g} deg against the Z axis of the machine; "
                    "the program runs in it, but most controls only shift work systems and turn them about Z",
                    hint="a plane that the program lays (G68.2) does the same there, or turn the frame of the work",
                )
            )
    waiting = {name: stock for name, stock in cell.stocks.items() if stock.place.frame is None}
    automatic = bool(mover.axes and waiting) and not own.work_offsets
    if automatic:
        if is_lathe(mover):
            offsets[1], note = _before_chuck(cell, mover)
        else:
            offsets[1], note = _automatic(cell, mover, is_bed=DIALECTS[own.dialect].prints)
        findings.append(note)
    elif mover.axes and not own.work_offsets:
        findings += _at_machine_zero(cell)
    result = Placement(
        X_WM=X_WM,
        work_offsets=offsets,
        given=tuple(sorted(system_index(name) for name in own.work_offsets)),
        automatic=automatic,
        stocks={},
        fixtures={},
        target=None,
        frames=cell.frames,
        findings=tuple(findings),
    )
    bearers = {
        system_index(name): on[0]
        for name, standing in own.work_offsets.items()
        if (on := _platform_of(cell, standing)) is not None
    }
    platforms = {system: link for system, link in bearers.items() if link in mover.platforms}
    borne = {system: link for system, link in bearers.items() if link not in mover.platforms}
    result = replace(result, platforms=platforms, borne=borne)
    stocks = {f"{STOCK}/{name}": stock.place for name, stock in cell.stocks.items()}
    fixtures = {f"{FIXTURE}/{name}": fixture.place for name, fixture in cell.fixtures.items()}
    parts = {f"{PART}/{name}": part.place for name, part in cell.parts.items()}
    sensors = {f"{SENSOR}/{name}": sensor.mount.place for name, sensor in cell.sensors.items()}
    placed = {**stocks, **fixtures, **parts, **sensors}
    carried = {
        name: on_link
        for name, stand in placed.items()
        if (on_link := _on_link(cell, stand) or _with_system(cell, result, name, stand))
    }
    return replace(
        result,
        stocks={
            name: _standing(result, stock.place, "G54")
            for name, stock in cell.stocks.items()
            if f"{STOCK}/{name}" not in carried
        },
        fixtures={
            name: _standing(result, fixture.place, "world")
            for name, fixture in cell.fixtures.items()
            if f"{FIXTURE}/{name}" not in carried
        },
        parts={
            name: _standing(result, part.place, "world")
            for name, part in cell.parts.items()
            if f"{PART}/{name}" not in carried
        },
        sensors={
            name: _standing(result, sensor.mount.place, "world")
            for name, sensor in cell.sensors.items()
            if f"{SENSOR}/{name}" not in carried
        },
        devices={name: _standing(result, device.place, "world") for name, device in cell.devices.items()},
        target=None if cell.target is None else _standing(result, cell.target.place, "G54"),
        carried=carried,
    )


def _standing(placement: Placement, standing: Standing, default: str) -> Pose:
    return placement.X_W(standing.frame or default) @ standing.X


def _with_system(cell: Cell, placement: Placement, name: str, standing: Standing) -> Carried | None:
    """Where something stands on the platform that carries its work system; None if no external axis does."""
    frame = standing.frame or ("G54" if name.startswith(STOCK) else "world")
    bearers = {**placement.platforms, **placement.borne}
    link = bearers.get(system_index(frame)) if frame in SYSTEMS else None
    if link is None:
        return None
    return Carried(link, cell.platforms[link].inverse() @ placement.X_W(frame) @ standing.X)


def _on_link(cell: Cell, standing: Standing) -> Carried | None:
    """The link on which it stands; None if it is at rest."""
    name = standing.frame or ""
    if name in cell.carried:
        return Carried(cell.carried[name].link, cell.carried[name].X @ standing.X)
    return Carried(name, standing.X) if name not in cell.frames and name in cell.link_names else None


def _platform_of(cell: Cell, standing: Standing) -> tuple[str, Pose] | None:
    """The link that external axes move, on which something stands, and the frame there at zero in W."""
    on = _on_link(cell, replace(standing, xyz=(0.0, 0.0, 0.0), rpy=(0.0, 0.0, 0.0)))
    if on is None or on.link not in cell.platforms:
        return None
    return on.link, cell.platforms[on.link] @ on.X


def _offset(cell: Cell, X_WM: Pose, X_WB: Pose, standing: Standing) -> Pose:
    """X_MP of a work offset; without `in:` it counts from machine zero, on an arm from the base."""
    if standing.frame is None:
        X_WP = X_WB @ standing.X
    elif (on := _platform_of(cell, standing)) is not None:
        _, X_WC = on
        X_WP = X_WC @ standing.X
    else:
        X_WP = cell.frames[standing.frame] @ standing.X
    return _cleaned(X_WM.inverse() @ X_WP)


def _leans(X_MP: Pose) -> bool:
    """Whether a work system does not just turn about Z of M."""
    return bool(X_MP.R[2, 2] < 1.0 - _UPRIGHT)


def _cleaned(X: Pose) -> Pose:
    """A rotation, set to an axis from which it differs only by rounding."""
    whole = np.round(X.R)
    return Pose(X.p, whole + 0.0) if np.abs(X.R - whole).max() < 1e-12 else X


def _upright_base(cell: Cell, channel: Channel, robot: MachineTool | Robot) -> Pose:
    """M of an arm: B, or B turned so that its Z is that of the first work system named."""
    if not channel.work_offsets:
        return robot.X_WB
    first = channel.work_offsets[min(channel.work_offsets, key=system_index)]
    R_BP = _offset(cell, robot.X_WB, robot.X_WB, first).R
    if R_BP[2, 2] >= 1.0 - _UPRIGHT:
        return robot.X_WB
    return Pose(robot.X_WB.p, multiplied(robot.X_WB.R, R_BP))


def bounds_of(shape: StockShape) -> Bounds:
    """Least and greatest corner [m] of a shape in its own frame."""
    return shape.bounds if isinstance(shape, Box | Cylinder) else (shape.lower, shape.upper)


def _corners_without_place(cell: Cell) -> Array:
    """Corners (n, 3) [m], in G54, of the boxes around all stock whose place the cell leaves open."""
    return np.concatenate(
        [
            stock.place.X.apply(np.array(list(product(*zip(*bounds_of(stock.shape), strict=True)))))
            for stock in cell.stocks.values()
            if stock.place.frame is None
        ]
    )


def _before_chuck(cell: Cell, machine: MachineTool | Robot) -> tuple[Pose, Diagnostic]:
    """G54 of a lathe for stock without a place: on the spindle's axis, the stock's lower end at the chuck."""
    nose = (machine.X_WM.inverse() @ machine.X_WB).p
    p = np.round(nose + np.array([0.0, 0.0, CHUCK_FACE - _corners_without_place(cell)[:, 2].min()]), 9) + 0.0
    note = Diagnostic(
        code="GS725",
        span=cell.span("stock"),
        message=f"G54 was placed at X{p[0] / MM:.10g} Z{p[2] / MM:.10g} mm of the machine: on the axis of the spindle, "
        f"the stock's end {CHUCK_FACE / MM:.10g} mm before the spindle nose",
        hint=f"`work_offsets: {{G54: {{xyz: [{nose[0] / MM:.10g}, 0, z]}}}}` places it yourself",
    )
    return Pose(p, np.eye(3)), note


def _automatic(cell: Cell, machine: MachineTool | Robot, *, is_bed: bool) -> tuple[Pose, Diagnostic]:
    """G54 for stock without a place: its middle at mid-travel in X and Y, its top in reach of the longest tool.

    A bed that is printed on is as low as the tool reaches, so that the print may be as high as the travel.
    """
    cloud = _corners_without_place(cell)
    low, high = cloud.min(axis=0), cloud.max(axis=0)
    x, y, z = (machine.axis(letter) for letter in "XYZ")
    longest = max((tool.true_length for tool in cell.tools.values()), default=0.0)
    travel = 2.0 * CLEARANCE if z is None else z.upper - z.lower
    above = max(travel - UNDER_BED, 0.5 * travel) if is_bed else min(CLEARANCE, 0.5 * travel)
    top = (0.0 if z is None else z.upper) - longest - above
    p = np.array(
        [
            (0.0 if x is None else x.middle) - 0.5 * (low[0] + high[0]),
            (0.0 if y is None else y.middle) - 0.5 * (low[1] + high[1]),
            top - high[2],
        ]
    )
    p = np.round(p, 9) + 0.0  # whole nanometres, so that programs and messages show round numbers
    where = " ".join(f"{letter}{value / MM:.10g}" for letter, value in zip("XYZ", p, strict=True))
    note = Diagnostic(
        code="GS725",
        span=cell.span("stock"),
        message=f"G54 was placed at {where} mm of the machine: "
        f"stock in mid-travel, its top {above / MM:.10g} mm below the longest tool",
        hint="`work_offsets: {G54: {xyz: [x, y, z]}}` places it yourself",
    )
    return Pose(p, np.eye(3)), note


def _at_machine_zero(cell: Cell) -> list[Diagnostic]:
    """A note if stock is in a work system that nobody has placed."""
    for name, stock in cell.stocks.items():
        if stock.place.frame in SYSTEMS:
            path = ("stock", name, "in") if ("stock", name, "in") in cell.spans else ("stock", "in")
            message = f"{stock.place.frame} is at machine zero, because no `work_offsets` place it"
            hint = "leave out `in:` to have it placed in the middle of the travel, or give `work_offsets`"
            return [Diagnostic(code="GS725", span=cell.span(*path), message=message, hint=hint)]
    return []
