"""What the parts of a cell mean for each other: frames, channels, materials, steps. Findings for what does not fit."""

from __future__ import annotations

from dataclasses import replace
from importlib.util import find_spec
from typing import Final

from gcodesim.cell.cell import FORMAT, MACHINE, MAIN, Cell
from gcodesim.cell.channel import Channel
from gcodesim.cell.placing import SYSTEMS, FrameTree, Place, unknown_frame
from gcodesim.cell.reading import Path, Reading, suggestion
from gcodesim.cell.records import keys, list_default
from gcodesim.cell.settings import matches, with_step
from gcodesim.cell.stock import Box, Mesh, Shape
from gcodesim.diagnostics import Diagnostic, Severity, Span, codes
from gcodesim.units import MM

_STRANGE: Final = 100.0  # times larger or smaller than the rest


def resolve(cell: Cell, to: Reading) -> Cell:
    """`cell` with frames, bases, channels and steps filled in; faults become findings of `to`."""
    if cell.gcodesim != FORMAT:
        to.fault(
            "GS711",
            to.span(("gcodesim",)),
            f"format {cell.gcodesim} of cells is not known",
            f"write `gcodesim: {FORMAT}`",
        )
    cell = _with_frames(cell, to)
    cell = _with_channels(cell, to)
    simulation, log = with_step(cell.simulation, cell.log, to)
    cell = replace(cell, simulation=simulation, log=log)
    _check_places(cell, to)
    _check_materials(cell, to)
    _check_mesh_sizes(cell, to)
    _check_codes(cell, to)
    _check_world(cell, to)
    return replace(cell, spans=_spans(cell, to), defaults_used=tuple(to.defaults))


def _spans(cell: Cell, to: Reading) -> dict[Path, Span]:
    """Places of all values; a stock without a name of its own is found by the name `stock` too."""
    spans = dict(to.spans)
    if "stock" in cell.stocks and ("stock", "stock") not in spans:
        spans |= {("stock", *path): span for path, span in to.spans.items() if path[:1] == ("stock",)}
    return spans


def _with_frames(cell: Cell, to: Reading) -> Cell:
    placed: dict[str, tuple[Place, Path]] = {
        name: (place, ("frames", name)) for name, place in cell.placed_frames.items()
    }
    if cell.machine is not None:
        placed[MACHINE] = (cell.machine.base, ("machine", "base"))
    for name, robot in cell.robots.items():
        placed[f"{name}/base"] = (robot.base, ("robots", name, "base"))
    frames = FrameTree(placed, to).resolve()
    machine = None if cell.machine is None else cell.machine.at(frames[MACHINE])
    robots = {name: robot.at(frames[f"{name}/base"]) for name, robot in cell.robots.items()}
    return replace(cell, frames=frames, machine=machine, robots=robots)


def _with_channels(cell: Cell, to: Reading) -> Cell:
    """Channels by name, each with the name of its robot, `machine` for the machine tool."""
    movers = [*([MACHINE] if cell.machine is not None else []), *cell.robots]
    if not movers:
        message = "the cell has neither a machine nor a robot"
        to.fault("GS722", Span(to.file, 1, 1, 1, 2), message, "write `machine: gantry_xyz`, or a robot under `robots:`")
        return cell
    if cell.channels and cell.only_channel is not None:
        stray = min(
            (to.spans[(name,)] for name in keys(Channel) if (name,) in to.spans), key=lambda s: (s.line, s.column)
        )
        to.fault(
            "GS719",
            stray,
            "with `channels`, this key belongs into one of them",
            f"channels are {', '.join(f'`{c}`' for c in cell.channels)}",
        )
    channels = dict(cell.channels) or {MAIN: cell.only_channel or _channel_by_default(to)}
    for name, channel in channels.items():
        path: Path = ("channels", name) if cell.channels else ()
        channels[name] = replace(channel, robot=_mover(channel, movers, path, to))
    _check_taken(channels, bool(cell.channels), to)
    return replace(cell, channels=channels)


def _channel_by_default(to: Reading) -> Channel:
    list_default(Channel(), "", to, ())
    return Channel()


def _mover(channel: Channel, movers: list[str], path: Path, to: Reading) -> str:
    if channel.robot is None:
        if len(movers) > 1:
            span = to.span(path) if path else to.span(("robots",))
            known = ", ".join(f"`{name}`" for name in movers)
            where = f"channel `{path[-1]}`" if path else "the cell"
            to.fault(
                "GS722", span, f"{where} does not say who runs the program: {known}", f"write `robot: {movers[0]}`"
            )
        return movers[0]
    if channel.robot not in movers:
        to.fault(
            "GS712",
            to.span((*path, "robot")),
            f"there is no robot `{channel.robot}`",
            suggestion(channel.robot, movers),
        )
    return channel.robot


def _check_taken(channels: dict[str, Channel], nested: bool, to: Reading) -> None:
    """Two programs cannot move one robot."""
    first: dict[str, str] = {}
    for name, channel in channels.items():
        robot = str(channel.robot)
        if robot in first and nested:
            message = f"`{robot}` runs the programs of two channels, `{first[robot]}` and `{name}`"
            to.fault("GS719", to.span(("channels", name, "robot")), message, "one robot, one channel")
        first.setdefault(robot, name)


def _check_places(cell: Cell, to: Reading) -> None:
    """Every `in:` names a frame; on an arm stock has a place."""
    fixed = list(cell.frames)
    for name, channel in cell.channels.items():
        path: Path = () if (("channels", name)) not in to.spans else ("channels", name)
        for system, place in channel.work_offsets.items():
            if place.frame is not None and place.frame not in fixed:
                unknown_frame(place.frame, (*path, "work_offsets", system), fixed, to)
        if channel.orientation is not None:
            frame = channel.orientation.tool_axis.frame
            if frame is not None and frame not in SYSTEMS and frame not in fixed:
                span = to.span((*path, "orientation", "tool_axis"))
                to.fault("GS712", span, f"there is no frame `{frame}`", suggestion(frame, [*SYSTEMS[:1], *fixed]))
    single = ("stock", "stock") not in to.spans
    standing: list[tuple[Place, Path]] = [
        (stock.place, ("stock",) if single else ("stock", name)) for name, stock in cell.stocks.items()
    ]
    standing += [(fixture.place, ("fixtures", name)) for name, fixture in cell.fixtures.items()]
    standing += [(cell.target.place, ("target",))] if cell.target is not None else []
    for place, path in standing:
        if place.frame is not None and place.frame not in fixed and place.frame not in SYSTEMS:
            unknown_frame(place.frame, path, [*fixed, "G54"], to)
    if cell.magazine.place.frame not in (None, *fixed):
        unknown_frame(str(cell.magazine.place.frame), ("magazine",), fixed, to)
    _check_stock_on_arm(cell, to)


def _check_stock_on_arm(cell: Cell, to: Reading) -> None:
    if not cell.channels:
        return
    first = next(iter(cell.channels.values()))
    if first.robot == MACHINE or first.work_offsets:
        return
    for name, stock in cell.stocks.items():
        if stock.place.frame is None:
            span = to.span(("stock", name)) if ("stock", name) in to.spans else to.span(("stock",))
            to.fault(
                "GS724",
                span,
                f"where `{name}` is nobody can know: it has no `in:`, and the robot no `work_offsets`",
                "write `in:` with a frame, and `work_offsets: {G54: {in: …}}` for the program's zero",
            )


def _check_materials(cell: Cell, to: Reading) -> None:
    """Materials are one's own or in the library."""
    from gcodesim.processes.materials import LIBRARY

    for name, stock in cell.stocks.items():
        if stock.material is None or stock.material in cell.materials:
            continue
        path: Path = ("stock", name, "material") if ("stock", name, "material") in to.spans else ("stock", "material")
        try:
            usable = LIBRARY[stock.material].usable
        except KeyError:
            own = suggestion(stock.material, list(cell.materials)) if cell.materials else ""
            near = ", ".join(f"`{s}`" for s in LIBRARY.suggest(stock.material))
            hint = (
                own if own.startswith("did") else f"near are {near}" if near else "`gcodesim list materials` shows all"
            )
            to.fault("GS712", to.span(path), f"there is no material `{stock.material}`", hint)
            continue
        if not usable:
            to.findings.add(
                Diagnostic(
                    code="GS729",
                    span=to.span(path),
                    message=f"the source of `{stock.material}` is in doubt: {LIBRARY[stock.material].note}",
                )
            )


def _check_mesh_sizes(cell: Cell, to: Reading) -> None:
    """A mesh a hundred times larger or smaller than what it stands with mostly has another unit."""
    meshes: list[tuple[Shape | None, Path]] = [
        (f.shape, ("fixtures", name, "mesh")) for name, f in cell.fixtures.items()
    ]
    meshes += [(cell.target.shape, ("target", "mesh"))] if cell.target is not None else []
    meshes += [(s.shape, (("stock", name, "mesh"))) for name, s in cell.stocks.items()]
    scale = _size_of_cell(cell)
    for shape, path in meshes:
        if not isinstance(shape, Mesh) or shape.lower is None or shape.upper is None:
            continue
        side = max(high - low for low, high in zip(shape.lower, shape.upper, strict=True))
        if scale / _STRANGE <= side <= scale * _STRANGE:
            continue
        much = "larger" if side > scale else "smaller"
        to.findings.add(
            Diagnostic(
                code="GS718",
                span=to.span(path) if path in to.spans else to.span(("stock", "mesh")),
                message=f"`{shape.name}` is {side / MM:.6g} mm long, "
                f"over a hundred times {much} than the cell ({scale / MM:.6g} mm)",
                hint="is its `unit` right?",
                value=side / MM,
                limit=scale / MM,
                unit="mm",
            )
        )


def _size_of_cell(cell: Cell) -> float:
    """A length that says how large things are here [m]: the longest side of stock, else the longest travel."""
    boxes = (stock.shape for stock in cell.stocks.values())
    sides = [side for shape in boxes if isinstance(shape, Box) for side in shape.size]
    if sides:
        return max(sides)
    travels = [] if cell.machine is None else [axis.upper - axis.lower for axis in cell.machine.axes if not axis.rotary]
    return max(travels, default=1.0)


def _check_codes(cell: Cell, to: Reading) -> None:
    """A pattern under `checks` or a suppressed code that no finding has is a slip."""
    wanted: list[tuple[str, Path]] = [(pattern, ("checks", pattern)) for pattern in cell.checks]
    wanted += [(entry.code, ("suppress", index, "code")) for index, entry in enumerate(cell.suppress)]
    known = [code.code for code in codes()] if wanted else []
    for pattern, path in wanted:
        if not any(matches(pattern, code) for code in known):
            to.findings.add(
                Diagnostic(
                    code="GS727", span=to.span(path), message=f"no finding of this version has the code {pattern}"
                )
            )


def _check_world(cell: Cell, to: Reading) -> None:
    if cell.simulation.world == "bullet" and find_spec("pybullet") is None:
        to.findings.add(
            Diagnostic(
                code="GS728",
                span=to.span(("simulation", "world")),
                severity=Severity.ERROR,
                message="`world: bullet` needs pybullet, which is not installed here",
                hint="install pybullet (Python 3.11 on x86-64 Linux), or write `world: kinematic`",
            )
        )
