"""References between the parts of a cell: frames, channels, materials, steps; findings where they do not fit."""

from __future__ import annotations

from dataclasses import replace
from importlib.util import find_spec
from typing import Final

from gcodesim.canon.systems import SYSTEMS, system_index, system_name
from gcodesim.cell.assembly import with_parts
from gcodesim.cell.cell import MAIN, Cell
from gcodesim.cell.channel import Channel
from gcodesim.cell.externals import External, check_words, with_externals
from gcodesim.cell.placing import MACHINE, Carried, FixedLink, FrameTree, Place
from gcodesim.cell.receivers import with_signals
from gcodesim.cell.settings import matches, with_step
from gcodesim.cell.stock import StockShape
from gcodesim.cell.surfaces import check_surfaces
from gcodesim.cell.touching import check_touching
from gcodesim.declarations.keys import keys
from gcodesim.declarations.mesh_shape import MeshShape
from gcodesim.declarations.reading import Path, Reading, suggestion
from gcodesim.declarations.record import list_default
from gcodesim.diagnostics import Diagnostic, Severity, Span, codes
from gcodesim.frames import WORLD, Pose
from gcodesim.kinematics.chain import BASE
from gcodesim.rs274.dialects import DIALECTS
from gcodesim.rs274.dialects.systems import dialect_with
from gcodesim.sensors.switch import SightSwitch
from gcodesim.solids import Box
from gcodesim.units import MM

_FOLLOW_WORK: Final = ("stock", "fixtures", "parts", "sensors", "target", "devices")
_ON_LINKS: Final = ("frames", "stock", "fixtures", "parts", "sensors")
_STRANGE: Final = 100.0  # times larger or smaller than the rest


def resolve(cell: Cell, to: Reading) -> Cell:
    """`cell` with frames, bases, channels and steps filled in; faults become findings of `to`."""
    cell = replace(cell, stocks=with_parts(cell.stocks, to))
    cell = with_externals(cell, to)
    cell = _with_frames(cell, to)
    cell = _with_channels(cell, to)
    if not to.broken & {("simulation",), ("log",)}:
        simulation, log = with_step(cell.simulation, cell.log, to)
        cell = replace(cell, simulation=simulation, log=log)
    _check_frames(cell, to)
    check_words(cell, to)
    _check_materials(cell, to)
    _check_rakes(cell, to)
    _check_stock_on_arm(cell, to)
    _check_systems(cell, to)
    _check_spindle(cell, to)
    _check_mesh_sizes(cell, to)
    _check_loaded_tools(cell, to)
    _check_stands(cell, to)
    _check_sensors(cell, to)
    cell = with_signals(cell, to)
    _check_devices(cell, to)
    _check_heard(cell, to)
    _check_codes(cell, to)
    _check_world(cell, to)
    check_touching(cell, to)
    check_surfaces(cell, to)
    return replace(cell, spans=_spans(cell, to), defaults_used=tuple(to.defaults))


def _spans(cell: Cell, to: Reading) -> dict[Path, Span]:
    """Places of all values; a stock without a name of its own is found by the name `stock` too."""
    spans = dict(to.spans)
    if "stock" in cell.stocks and ("stock", "stock") not in spans:
        spans |= {("stock", *path): span for path, span in to.spans.items() if path[:1] == ("stock",)}
    return spans


def _with_frames(cell: Cell, to: Reading) -> Cell:
    placed: dict[str, tuple[Place | FixedLink, Path]] = {
        name: (place, ("frames", name)) for name, place in cell.placed_frames.items()
    }
    if cell.machine is not None:
        placed[MACHINE] = (cell.machine.base, ("machine", "base"))
        for external in cell.machine.externals:
            placed[_base_of(external)] = (external.base, ("externals", external.name, "base"))
    for name, robot in cell.robots.items():
        placed[robot.base_frame] = (robot.base, ("robots", name, "base"))
        for link, X in robot.whole.fixed_links.items():
            placed.setdefault(f"{name}/{link}", (FixedLink(robot.base_frame, X), ("robots", name)))
        for external in robot.externals:
            placed[_base_of(external)] = (external.base, ("externals", external.name, "base"))
    tree = FrameTree(placed, cell.link_names, to)
    for name, robot in cell.robots.items():
        for external in robot.externals:
            tree.carried[external.name] = Carried(f"{name}/{external.name}", Pose.identity())
    for external in () if cell.machine is None else cell.machine.externals:
        tree.carried[external.name] = Carried(f"{MACHINE}/{external.name}", Pose.identity())
    tree.resolve()
    bases = {name: tree.poses.get(name) or place.X for name, (place, _) in placed.items()}  # else a fault: see below
    machine = cell.machine
    if machine is not None:
        tables = tuple(replace(own, X_WE=bases[_base_of(own)]) for own in machine.externals)
        machine = machine.at(bases[MACHINE], tables)
        for own in tables:
            tree.poses.pop(_base_of(own), None)
    robots = {name: robot.at(bases[robot.base_frame]) for name, robot in cell.robots.items()}
    for name, robot in robots.items():
        standing = tuple(replace(own, X_WE=bases[_base_of(own)]) for own in robot.externals)
        robots[name] = robot.with_externals(standing)
        for own in standing:
            del tree.poses[_base_of(own)]
    return replace(cell, frames=tree.poses, carried=tree.carried, machine=machine, robots=robots)


def _base_of(external: External) -> str:
    """A name that no frame has, for the place where external axes stand."""
    return f"{external.name} stands"


def _with_channels(cell: Cell, to: Reading) -> Cell:
    """Channels by name, each with the name of its robot, `machine` for the machine tool."""
    movers = [*([MACHINE] if (MACHINE,) in to.keys else []), *to.names_in("robots")]
    if not movers and (("robots",) in to.broken or ("robots",) in to.spans):
        return cell  # there is one, and its faults have been reported
    if not movers:
        message = "the cell has neither a machine nor a robot"
        to.fault("GS722", Span(to.file, 1, 1, 1, 2), message, "write `machine: gantry_xyz`, or a robot under `robots:`")
        return cell
    if cell.channels and cell.only_channel is not None:
        stray = min(
            (to.keys[(name,)] for name in keys(Channel) if (name,) in to.keys), key=lambda s: (s.line, s.column)
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
            to.fault("GS719", to.key(("channels", name, "robot")), message, "one robot, one channel")
        first.setdefault(robot, name)


def _check_frames(cell: Cell, to: Reading) -> None:
    """Every `in:` names a frame or a link; anything at rest stands on something at rest."""
    if ("frames",) in to.broken:
        return
    fixed = [WORLD, *to.names_in("frames"), *([MACHINE] if (MACHINE,) in to.keys else [])]
    fixed += [f"{name}/{BASE}" for name in to.names_in("robots")]
    fixed += [name for name in cell.frames if name not in fixed]
    for reference in to.references:
        if reference.what != "frame":
            continue
        name, section = reference.name, reference.path[0]
        if name in cell.carried or (name in cell.link_names and name not in fixed):
            if section not in _ON_LINKS and not _is_on_platform(cell, name, reference.path):
                _fault_on_link(cell, name, reference.path, to)
        elif name not in fixed and not _is_on_unknown(cell, name, to):
            _fault_of_frame(cell, name, fixed, reference.path, to)


def _is_on_platform(cell: Cell, name: str, path: Path) -> bool:
    """Whether a work system stands on what external axes carry: those of its own channel; on an arm any."""
    channel = _channel_of(cell, path)
    if channel is None or "work_offsets" not in path:
        return False
    link = cell.carried[name].link if name in cell.carried else name
    if channel.robot == MACHINE:
        return cell.machine is not None and link in cell.machine.platforms
    own = cell.robots.get(str(channel.robot))
    from_surface = channel.orientation is not None and channel.orientation.tool_axis.surface is not None
    return link in cell.platforms and not (from_surface and own is not None and link not in own.platforms)


def _channel_of(cell: Cell, path: Path) -> Channel | None:
    """The channel to which a key of the cell file belongs."""
    if path[0] == "channels":
        return cell.channels.get(str(path[1]))
    return next(iter(cell.channels.values()), None)


def _fault_on_link(cell: Cell, name: str, path: Path, to: Reading) -> None:
    link = cell.carried[name].link if name in cell.carried else name
    message = f"`{name}` moves" if link == name else f"`{name}` moves with `{link}`"
    hint = "only frames, stock, fixtures, parts and sensors may stand in it"
    if "work_offsets" in path:
        hint = "a work system may stand on what external axes carry, not on a link; stock and parts may stand on both"
        channel = _channel_of(cell, path)
        if link in cell.platforms and channel is not None:
            message = f"{message}, which the program of `{link.partition('/')[0]}` moves"
            machine = channel.robot == MACHINE
            what = "the program of a machine tool" if machine else "a tool axis from a surface"
            hint = f"{what} follows {'its own table' if machine else 'external axes of its own robot'} only; " + (
                "an arm can work there, or give the table to the machine (`robot: machine`)"
                if machine
                else "name another `tool_axis`, such as -Z of G54"
            )
    to.fault("GS712", to.span(path), message, hint)


def _fault_of_frame(cell: Cell, name: str, fixed: list[str], path: Path, to: Reading) -> None:
    span = to.span(path)
    follows_work = path[0] in _FOLLOW_WORK or path[-1] == "tool_axis"
    if system_name(name) is None:
        known = [*fixed, "G54"] if follows_work else fixed
        if path[0] in _ON_LINKS and "/" in name:
            known = [*known, *cell.link_names]
        to.fault("GS712", span, f"there is no frame `{name}`", suggestion(name, list(dict.fromkeys(known))))
    elif not follows_work:
        message = f"`{name}` is no fixed frame"
        hint = "only stock, fixtures, parts, sensors, the target and a tool axis may stand in it"
        to.fault("GS712", span, message, hint)


def _is_on_unknown(cell: Cell, name: str, to: Reading) -> bool:
    """Whether `name` is a link of something whose links are unknown because of a fault that has been reported."""
    mover, slash, _ = name.partition("/")
    if mover == MACHINE:
        return bool(slash) and (MACHINE,) in to.keys and cell.machine is None
    return bool(slash) and mover in to.names_in("robots") and mover not in cell.robots


def _check_sensors(cell: Cell, to: Reading) -> None:
    """What feels the load of a tool stands on the flange that carries it; names of tools are those of tools."""
    for name in cell.sensors:
        if name in (f"T{number}" for number in cell.tools):
            to.fault("GS711", to.key(("sensors", name)), f"`{name}` is what a tool of this cell is called")
    if not cell.channels:
        return
    mover = next(iter(cell.channels.values())).robot
    machine = cell.machine if mover == MACHINE else cell.robots.get(str(mover))
    if machine is None:
        return
    flange = f"{mover}/{machine.chain.flange_name}"
    for name, mounted in cell.sensors.items():
        frame = mounted.mount.place.frame or WORLD
        if mounted.sensor.on_flange and (cell.carried[frame].link if frame in cell.carried else frame) != flange:
            to.fault(
                "GS719",
                to.span(("sensors", name, "in")),
                f"`{name}` stands on `{frame}`; a {mounted.kind.replace('_', ' ')} measures between flange and tool",
                f"write `in: {flange}`",
            )


def _check_loaded_tools(cell: Cell, to: Reading) -> None:
    if ("tools",) in to.broken:
        return
    for name, channel in cell.channels.items():
        number = channel.loaded_tool
        if number is None or number in cell.tools:
            continue
        own: Path = ("channels", name, "loaded_tool")
        known = ", ".join(f"T{tool}" for tool in sorted(cell.tools)) or "none"
        to.fault(
            "GS712",
            to.span(own) if own in to.spans else to.span(("loaded_tool",)),
            f"there is no tool T{number} to be loaded",
            f"tools of this cell: {known}",
        )


def _check_systems(cell: Cell, to: Reading) -> None:
    """Additional work systems exist only where the dialect has them."""
    for name, channel in cell.channels.items():
        own: Path = ("channels", name)
        path: Path = (*own, "dialect") if (*own, "dialect") in to.keys else ("dialect",)
        if path not in to.keys or DIALECTS[channel.dialect].further_systems:
            continue  # if no dialect is written, the command line may name it
        for system in channel.work_offsets:
            if system not in SYSTEMS:
                having = dialect_with(system_index(system))
                to.fault(
                    "GS719",
                    to.span((*path[:-1], "work_offsets", system)),
                    f"{system} is a work system of `{having}`, and the dialect is `{channel.dialect}`",
                    "G54 to G59.3 are there in every dialect but `grbl`, which ends at G59",
                    related=to.span(path),
                )


def _check_stock_on_arm(cell: Cell, to: Reading) -> None:
    if not cell.channels:
        return
    name, first = next(iter(cell.channels.items()))
    given = {("work_offsets",), ("channels", name, "work_offsets")} & to.keys.keys()
    if first.robot == MACHINE or given:
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
    """Materials are defined in the cell or in the library; only what cuts asks for their constants of force."""
    from gcodesim.processes import PROCESSES
    from gcodesim.processes.materials import LIBRARY

    if ("materials",) in to.broken:
        return
    own = to.names_in("materials")
    kinds = {kind for tool in cell.tools.values() for kind in tool.processes}
    pushed = not kinds or any(PROCESSES[kind].pushes for kind in kinds)
    for reference in to.references:
        name = reference.name
        if reference.what != "material" or name in own:
            continue
        span = to.span(reference.path)
        if name not in LIBRARY:
            guess = suggestion(name, own) if own else ""
            near = ", ".join(f"`{s}`" for s in LIBRARY.suggest(name))
            hint = (
                guess
                if guess.startswith("did")
                else f"near are {near}"
                if near
                else "`gcodesim list materials` shows all"
            )
            to.fault("GS712", span, f"there is no material `{name}`", hint)
        elif not LIBRARY[name].usable:
            message = f"the source of material `{name}` is in doubt: {LIBRARY[name].note}"
            to.findings.add(Diagnostic(code="GS729", span=span, message=message))
        elif LIBRARY[name].law is None and pushed:
            message = f"there are no force data for `{name}`: it is cut without force"
            hint = f"give constants of your own: `materials: {{my_{LIBRARY[name].id}: {{kc11: … N/mm^2, mc: …}}}}`"
            to.findings.add(Diagnostic(code="GS926", span=span, message=message, hint=hint))


def _check_rakes(cell: Cell, to: Reading) -> None:
    """GS738: tools that say a rake, in materials whose table does not: for each such material that the cell names."""
    from gcodesim.processes.materials import LIBRARY

    raked = [f"T{number}" for number, tool in cell.tools.items() if getattr(tool, "rake", None) is not None]
    if not raked or ("materials",) in to.broken:
        return
    told: set[str] = set()
    for reference in to.references:
        if reference.what != "material" or reference.name in told:
            continue
        material = cell.materials.get(reference.name) or LIBRARY.get(reference.name)
        if material is None or material.law is None or material.rake is not None:
            continue
        told.add(reference.name)
        message = (
            f"`{reference.name}` does not say for which rake its constants hold: `rake` of {raked[0]} changes nothing"
        )
        hint = f"`materials: {{my_{material.id}: {{…, rake: 6 deg}}}}` gives constants with the rake of their edges"
        to.findings.add(Diagnostic(code="GS738", span=to.span(reference.path), message=message, hint=hint))


def _check_stands(cell: Cell, to: Reading) -> None:
    """Stands are for tools that there are, and for arms."""
    for number in cell.magazine.stands:
        path = ("magazine", "stands", number)
        if number not in cell.tools and ("tools",) not in to.broken:
            known = ", ".join(f"T{other}" for other in sorted(cell.tools)) or "none"
            to.fault("GS712", to.key(path), f"there is no tool {number} for this stand", f"tools of this cell: {known}")
        elif not cell.robots:
            to.fault("GS719", to.key(path), "only an arm drives to a stand", "a machine has `change_time` and `pitch`")


def _check_mesh_sizes(cell: Cell, to: Reading) -> None:
    """A mesh a hundred times larger or smaller than its surroundings mostly has another unit."""
    meshes: list[tuple[StockShape | None, Path]] = [
        (f.shape, ("fixtures", name, "mesh")) for name, f in cell.fixtures.items()
    ]
    meshes += [(p.shape, ("parts", name, "mesh")) for name, p in cell.parts.items()]
    meshes += [(cell.target.shape, ("target", "mesh"))] if cell.target is not None else []
    meshes += [(s.shape, (("stock", name, "mesh"))) for name, s in cell.stocks.items()]
    scale = _size_of_cell(cell)
    for shape, path in meshes:
        if not isinstance(shape, MeshShape):
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
    """A length that is typical of this cell [m]: the longest side of stock, else the longest travel."""
    boxes = (stock.shape for stock in cell.stocks.values())
    sides = [side for shape in boxes if isinstance(shape, Box) for side in shape.size]
    if sides:
        return max(sides)
    travels = [] if cell.machine is None else [axis.upper - axis.lower for axis in cell.machine.axes if not axis.rotary]
    return max(travels, default=1.0)


def _check_devices(cell: Cell, to: Reading) -> None:
    """Channels that devices name, and devices that inputs name, are there."""
    known = to.names_in("devices")
    for name, device in cell.devices.items():
        if device.channel is not None and cell.channels and device.channel not in cell.channels:
            to.fault(
                "GS712",
                to.span(("devices", name, "channel")),
                f"there is no channel `{device.channel}`",
                suggestion(device.channel, list(cell.channels)),
            )
    for reference in to.references:
        if reference.what == "device" and reference.name not in known:
            hint = suggestion(reference.name, known) if known else "there are none: `devices: {…}` of the cell"
            to.fault("GS712", to.span(reference.path), f"there is no device `{reference.name}`", hint)


def _check_heard(cell: Cell, to: Reading) -> None:
    """Sensors that inputs name are there, and answer yes or no."""
    known = to.names_in("sensors")
    switches = [name for name, mounted in cell.sensors.items() if isinstance(mounted.sensor, SightSwitch)]
    for reference in to.references:
        if reference.what != "sensor":
            continue
        if reference.name not in known:
            hint = suggestion(reference.name, known) if known else "there are none: `sensors: {…}` of the cell"
            to.fault("GS712", to.span(reference.path), f"there is no sensor `{reference.name}`", hint)
        elif reference.name in cell.sensors and reference.name not in switches:
            to.fault(
                "GS711",
                to.span(reference.path),
                f"`{reference.name}` is a {cell.sensors[reference.name].kind}, which answers neither yes nor no",
                "inputs read sensors of the types `light_barrier` and `proximity_switch`",
            )


def _check_spindle(cell: Cell, to: Reading) -> None:
    """Times of the spindle are for some speed."""
    given = [name for name in ("run_up", "run_down") if getattr(cell.spindle, name) > 0.0]
    if given and cell.spindle.full_speed(cell.limits) is None:
        message = f"`{given[0]}` is a time, and nothing says to which speed"
        hint = "give `speed`, or `limits: {spindle_speed: …}`"
        to.fault("GS705", to.key(("spindle", given[0])), message, hint)


def _check_codes(cell: Cell, to: Reading) -> None:
    """A pattern under `checks`, or a suppressed code, that matches no code is a slip."""
    wanted: list[tuple[str, Path]] = [(pattern, ("checks", pattern)) for pattern in cell.checks]
    wanted += [(entry.code, ("suppress", index, "code")) for index, entry in enumerate(cell.suppress)]
    for pattern, path in wanted:
        if not any(matches(pattern, code.code) for code in codes()):
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
