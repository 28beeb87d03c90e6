"""A cell ready to run: kinematics, tools, processes and stock, each in its place."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import field, replace
from functools import partial
from math import isnan
from pathlib import Path
from typing import TYPE_CHECKING, Final, cast

import numpy as np

from gcodesim.arithmetic.matrices import applied, multiplied, norms
from gcodesim.canon.systems import SYSTEMS
from gcodesim.cell import Cell, Placement, place
from gcodesim.cell.cell import MAIN
from gcodesim.cell.leftover import NOTHING_LEFT, Leftover, no_stock
from gcodesim.cell.machine import MachineTool
from gcodesim.cell.part import PartSpec
from gcodesim.cell.placement import DEVICE, FIXTURE, PART, SENSOR, STOCK, bounds_of
from gcodesim.cell.placing import MACHINE
from gcodesim.cell.robot import Payload, Robot
from gcodesim.cell.signals import SignalSource
from gcodesim.cell.stock import StockSpec, solid_of
from gcodesim.diagnostics import Diagnostic
from gcodesim.frames import WORLD, Array, Pose
from gcodesim.frozen import frozen
from gcodesim.kinematics import Cartesian, Chain, Inertial, Kinematics, Link, kinematics_of, model_path
from gcodesim.processes.sheet import Sheet
from gcodesim.processes.signal import Signal, signals_read_by
from gcodesim.scene import WORK, Body, Mover, Scene, Stand
from gcodesim.scene.coated import Coated, Shading
from gcodesim.solids import (
    Box,
    Cylinder,
    Hulls,
    Mesh,
    MeshError,
    MeshFile,
    Placed,
    Solid,
    read_mesh,
    room_of,
    triangles_of,
)
from gcodesim.solids.mesh_file import Triangles
from gcodesim.tools.body import STEEL_DENSITY
from gcodesim.units import MM, RPM

if TYPE_CHECKING:
    from gcodesim.controllers import Controller
    from gcodesim.material.revolved import Revolved
    from gcodesim.material.stock import Stock
    from gcodesim.processes.materials import Material
    from gcodesim.tools.tool import Tool

MEMORY_BUDGET: Final = 2 << 30
"""Bytes that one stock may take: what a laptop can spare."""

CELLS_PER_DIAMETER: Final = 24
"""Cells across the smallest cutter where the cell file names no resolution."""

BODIES: Final = "bodies"
"""The world as it is with all axes at zero, carried by the table if there is one: here fixtures and stocks rest."""

WORK_FRAME: Final = "G54"
"""Where the log draws the frame `stock` of a cell without one."""

USUAL_LATHE: Final = 4000.0 * RPM
"""Greatest speed [rad/s] of a lathe's spindle where the cell gives no `limits: {spindle_speed: …}`."""

COATED_COLUMNS: Final = 400_000
"""Columns of a stock whose surface is coated: as fine as a film can be, within a second."""

_IN_THE_WAY: Final = ("fixture", "stock", "part", "obstacle")
"""Roles of bodies that may stand between a gun and what it coats."""

FINEST_DEFAULT: Final = 0.05 * MM
COARSEST_DEFAULT: Final = 0.5 * MM
MOST_DEFAULT_COLUMNS: Final = 4_000_000


@frozen(eq=False)
class PlacedStock:
    """A workpiece and its place: `X_WS` is the frame of its columns in the world at the start (table axes at zero).

    That is its own frame S, unless it lies on another side (`stock.turn`). `frame` is its name in the scene.
    """

    name: str
    frame: str
    spec: StockSpec
    stock: Stock
    X_WS: Pose
    material: Material | None
    initial: float

    @property
    def revolved(self) -> bool:
        """Whether it turns in a lathe; then `stock` is a `material.Revolved`."""
        return hasattr(self.stock, "profile")


@frozen(eq=False)
class Shop:
    """Everything that a channel's program acts on.

    `mover` is what the program moves, one of the scene's. `X_BM` is machine zero seen from its base B (of a machine:
    M); on an arm M is B, turned when its work systems are tilted. `beside` are the movers of other programs that run at
    the same time. `coated` are the bodies that spray may coat, by the names of their frames.
    """

    cell: Cell
    channel: str
    mover: Mover
    placement: Placement
    X_BM: Pose
    scene: Scene
    stocks: Mapping[str, PlacedStock] = field(default_factory=dict)
    coated: Mapping[str, Coated] = field(default_factory=dict)
    beside: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        """The mover's name, as in the log."""
        return self.mover.name

    @property
    def kinematics(self) -> Kinematics:
        return self.mover.kinematics

    @property
    def X_WB(self) -> Pose:
        return self.mover.X_WB

    @property
    def home(self) -> Array:
        return self.mover.home

    @property
    def stiffness(self) -> Array | None:
        return self.mover.stiffness

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Names as in the log: `arm/joint_1`, `machine/X`."""
        return self.mover.joint_names

    @property
    def magazine_pose(self) -> Pose:
        """Where the first pocket is: X_W of the flange side of the tool in it."""
        placed = self.cell.magazine.place
        return self.cell.frames[placed.frame or "world"] @ placed.X

    def stand(self, number: int) -> Pose:
        """X_WF of the flange while this tool is coupled in its stand."""
        place = self.cell.magazine.stands[number].place
        return self._frame_of_stand(number) @ place.X

    def stand_axes(self, number: int, vector: Array) -> Array:
        """A vector (3,) in axes of what the stand of a tool stands in, in those of the world."""
        turned: Array = applied(self._frame_of_stand(number).R, vector)
        return turned

    def _frame_of_stand(self, number: int) -> Pose:
        return self.cell.frames[self.cell.magazine.stands[number].place.frame or WORLD]

    @property
    def sheet(self) -> Sheet:
        """The columns that a run in this cell has."""
        return Sheet.of(self.cell.tools.values(), ("turning",) if self.mover.lathe else ())

    @property
    def moves_parts(self) -> bool:
        """Whether anything in the cell may move its parts: a gripper, or a device."""
        return bool(self.cell.devices) or any("gripping" in tool.processes for tool in self.cell.tools.values())

    @property
    def signals(self) -> dict[str, Signal]:
        """What the processes of its tools read. A switch without a position of its own is off where codes switch it."""
        codes = {(code.target, code.verb) for code in self.cell.channels[self.channel].m_codes.values()}
        found = {
            name: replace(signal, default=0.0) if isnan(signal.default) and signal.is_set_by(codes) else signal
            for name, signal in signals_read_by(self.cell.tools.values()).items()
        }
        if self.mover.lathe:
            from gcodesim.processes import PROCESSES

            found |= {signal.name: signal for signal in PROCESSES["turning"].reads}
        return found

    @property
    def signal_sources(self) -> Mapping[str, SignalSource]:
        """Which words of the program give signals."""
        return self.cell.channels[self.channel].signals

    @property
    def fastest(self) -> float | None:
        """The greatest speed [rad/s] of the spindle of a lathe; None on every other machine."""
        if not self.mover.lathe:
            return None
        return self.cell.limits.spindle_speed or USUAL_LATHE

    def tool(self, number: int) -> Tool | None:
        """The tool with this number; None for the empty spindle and for numbers that the cell does not have."""
        return self.cell.tools.get(number)


def open_shop(cell: Cell, channel: str = MAIN) -> Shop:
    """Kinematics and places of a cell, without stock."""
    if channel not in cell.channels:
        channel = next(iter(cell.channels))
    placement = place(cell, channel)
    mover = _mover(cell.machine_of(channel))
    return Shop(
        cell=cell,
        channel=channel,
        mover=mover,
        placement=placement,
        X_BM=mover.X_WB.inverse() @ placement.X_WM,
        scene=_scene(cell, mover, placement),
    )


def _mover(description: MachineTool | Robot) -> Mover:
    return _machine(description) if isinstance(description, MachineTool) else _robot(description)


def _machine(tool: MachineTool) -> Mover:
    """A machine tool as a mover of the scene; it counts as rigid."""
    kinematics = kinematics_of(tool.chain)
    homes = {axis.letter: axis.home for axis in tool.axes}
    return Mover(
        name=MACHINE,
        kinematics=kinematics,
        X_WB=tool.X_WM,
        home=np.array([homes[letter] for letter in kinematics.joints.names]),
        joints_are_axes=True,
        rapids=tool.rapids,
        retreat=np.array([0.0, 0.0, 1.0]),
        timed_only=tuple(axis.letter for axis in tool.axes if axis.rotary and axis.at is None),
        seen_whole=False,
        lathe=tool.lathe,
        own_table=tool.own_table,
        description=None if tool.model is None else model_path(tool.model),
    )


def _robot(robot: Robot) -> Mover:
    """A robot as a mover of the scene."""
    kinematics = kinematics_of(_loaded(robot.chain, robot.payload))
    home = np.array(robot.home)
    stiffness = None if robot.stiffness is None else np.array(robot.stiffness)
    outside: tuple[str, ...] = ()
    if robot.externals:
        from gcodesim.kinematics.assembly import Assembly

        assembly = Assembly.of(kinematics, [external.carrier(robot.X_WB) for external in robot.externals])
        outside = tuple(assembly.joints.names[i] for i in assembly.externals)
        homes = {
            f"{external.name}/{letter}": at
            for external in robot.externals
            for letter, at in zip(external.axes, external.homes, strict=True)
        }
        home = assembly.together(home[None], np.array([[homes[name] for name in outside]]))[0]
        if stiffness is not None:  # carriages and tables count as rigid
            stiffness = assembly.together(stiffness[None], np.full((1, len(outside)), np.inf))[0]
        kinematics = assembly
    return Mover(
        name=robot.name,
        kinematics=kinematics,
        X_WB=robot.X_WB,
        home=home,
        stiffness=stiffness,
        externals=outside,
        seen_whole=not isinstance(kinematics, Cartesian),
        description=robot.description,
        controller=controller_of(robot.controller, kinematics),
        may_meet=robot.allow_collisions,
    )


def controller_of(controller: Controller, kinematics: Kinematics) -> Controller:
    """The same for all joints that move, external axes among them: it has no values for those."""
    from gcodesim.kinematics.assembly import Assembly

    if not isinstance(kinematics, Assembly):
        return controller
    return controller.of_joints(kinematics.own, len(kinematics.joints))


def _scene(cell: Cell, mover: Mover, placement: Placement) -> Scene:
    """The frames of a cell. Whatever names no link stands on the side that carries the work, with all axes at zero."""
    frames = {
        WORK_FRAME: _system_stand(cell, mover, placement),
        BODIES: _work_stand(mover, Pose.identity()),
        **{f"{STOCK}/{name}": _work_stand(mover, X_WS) for name, X_WS in placement.stocks.items()},
        **{f"{FIXTURE}/{name}": _work_stand(mover, X_W) for name, X_W in placement.fixtures.items()},
        **{f"{PART}/{name}": _work_stand(mover, X_W) for name, X_W in placement.parts.items()},
        **{f"{SENSOR}/{name}": _sensor_stand(cell, name, mover, X_W) for name, X_W in placement.sensors.items()},
        **{f"{DEVICE}/{name}": Stand(WORLD, X_W) for name, X_W in placement.devices.items()},
        **{name: Stand(on.link, on.X) for name, on in placement.carried.items()},
    }
    movers = {mover.name: mover}
    for link in (*(on.link for on in placement.carried.values()), *placement.borne.values()):
        name = link.partition("/")[0]
        if name not in movers:
            movers[name] = _mover(cell.machine if name == MACHINE and cell.machine else cell.robots[name])
    return Scene(movers=movers, frames=frames, bodies=(*_links(mover), *_standing(cell)))


def _system_stand(cell: Cell, mover: Mover, placement: Placement) -> Stand:
    """The stand of G54; on what an external axis carries it moves with that."""
    link = placement.platforms.get(1) or placement.borne.get(1)
    if link is None:
        return _work_stand(mover, placement.X_W("G54"))
    return Stand(link, cell.platforms[link].inverse() @ placement.X_W("G54"))


def _links(mover: Mover) -> Iterator[Body]:
    """The links of a mover that have a shape; the root is its base."""
    shapes: dict[int, list[Placed]] = {}
    for shape in mover.kinematics.link_shapes:
        shapes.setdefault(shape.link, []).append(shape.placed)
    for index, solids in sorted(shapes.items()):
        link = mover.kinematics.link_names[index] if index else mover.kinematics.chain.base_name
        yield Body(name=f"{mover.name}/{link}", solids=tuple(solids), role="link")


def _standing(cell: Cell) -> Iterator[Body]:
    """Stocks, in their shape at the start, fixtures, devices, and parts."""
    for name, stock in cell.stocks.items():
        solid = solid_of(stock.shape)
        yield Body(name=f"{STOCK}/{name}", solids=() if solid is None else (Placed(solid),), role="stock")
    for name, fixture in cell.fixtures.items():
        solid = solid_of(fixture.shape)
        yield Body(name=f"{FIXTURE}/{name}", solids=() if solid is None else (Placed(solid),), role="fixture")
    for name, device in cell.devices.items():
        solid = solid_of(device.shape)
        yield Body(name=f"{DEVICE}/{name}", solids=() if solid is None else (Placed(solid),), role="obstacle")
    for name, part in cell.parts.items():
        solid = solid_of(part.shape)
        solids = () if solid is None else (Placed(solid),)
        yield Body(name=f"{PART}/{name}", solids=solids, role="part", mass=_mass(part, solid), friction=part.friction)


def _mass(part: PartSpec, solid: Solid | None) -> float:
    """[kg] of a part; of steel where the cell does not say it."""
    if part.mass is not None or solid is None or isinstance(solid, Hulls):
        return part.mass or 0.0
    return STEEL_DENSITY * abs(solid.volume)


def _work_stand(mover: Mover, X_W: Pose) -> Stand:
    """The stand of something at `X_W` in the world while the axes are at zero; it moves with a moving table."""
    if isinstance(mover.kinematics, Cartesian) and mover.moves(WORK):
        own = mover.own_table
        if own is None:
            return Stand(f"{mover.name}/{WORK}", mover.X_WB.inverse() @ X_W)
        if mover.moves(own):
            still = np.zeros((1, len(mover.kinematics.joints)))
            X_WT = mover.X_WB @ Pose.from_matrix(mover.seen_from_base(own, still)[0])
            return Stand(f"{mover.name}/{own}", X_WT.inverse() @ X_W)
    return Stand(WORLD, X_W)


def _sensor_stand(cell: Cell, name: str, mover: Mover, X_W: Pose) -> Stand:
    """A sensor moves with a moving table only if it stands in a work system."""
    in_work = cell.sensors[name].mount.place.frame in SYSTEMS
    return _work_stand(mover, X_W) if in_work else Stand(WORLD, X_W)


def _loaded(chain: Chain, payload: Payload | None) -> Chain:
    """The chain together with what hangs on its flange besides the tool."""
    if payload is None:
        return chain
    flange = next(link for link in chain.links if link.name == chain.flange)
    if flange.inertial is not None and flange.inertial.mass > 0.0:
        raise AssertionError("a flange with a mass of its own cannot take a payload")
    carried = Inertial(mass=payload.mass, com=np.array(payload.xyz), inertia=np.zeros((3, 3)))
    links = tuple(
        Link(name=link.name, inertial=carried, visuals=link.visuals, collisions=link.collisions)
        if link is flange
        else link
        for link in chain.links
    )
    return replace(chain, links=links)


def with_stock(shop: Shop, left: Mapping[str, Path] | None = None) -> tuple[Shop, list[Diagnostic]]:
    """The shop with its workpieces; a finding for each that does not fit into memory or cannot be read.

    `left` are files with the stocks of the cell as the first part of the program has left them.
    """
    left = left or {}
    stocks: dict[str, PlacedStock] = {}
    stands: dict[str, Stand] = {}
    findings = [*_undrawn(shop), *_idle_on_lathe(shop)]
    fresh: dict[str, Stock] = {}
    for name, spec in shop.cell.stocks.items():
        made = _left(shop, name, left[name], name, spec) if name in left else _stock(shop, name, spec)
        if isinstance(made, Diagnostic):
            findings.append(made)
        else:
            fresh[name] = made
    findings += [*(_fitted(shop, fresh) if not left else ()), *_apart(shop)]
    for name, made in fresh.items():
        spec = shop.cell.stocks[name]
        material = shop.cell.material(spec)
        if material is None and made.material:
            material = _material_named(shop.cell, made.material)
        frame = f"{STOCK}/{name}"
        X_WS = _rest_of(shop, name)
        if not shop.mover.lathe:
            made = _upright(shop, made, X_WS)
        turn = Pose(np.zeros(3), made.turn)
        stand = shop.scene.frames[frame]
        stands[frame] = Stand(stand.parent, stand.X @ turn)
        stocks[name] = PlacedStock(
            name=name, frame=frame, spec=spec, stock=made, X_WS=X_WS @ turn, material=material, initial=made.volume
        )
    stocked = replace(shop, stocks=stocks, scene=shop.scene.with_frames(stands))
    return replace(stocked, coated=_coated(stocked)), findings


def _rest_of(shop: Shop, name: str) -> Pose:
    """Where a stock is at the start, in the world."""
    return shop.placement.stocks[name] if name in shop.placement.stocks else shop.scene.at_rest(f"{STOCK}/{name}")


def _fitted(shop: Shop, fresh: Mapping[str, Stock]) -> list[Diagnostic]:
    """Take the room of each part out of the stock that it is inside of, and out of the parts before it there.

    GS413 for a part that takes nothing of them. What an earlier run left has its holes already.
    """
    findings: list[Diagnostic] = []
    specs = shop.cell.stocks
    for name, spec in specs.items():
        solid = solid_of(spec.shape)
        if spec.inside is None or solid is None or name not in fresh:
            continue
        from gcodesim.material.embedded import take_out

        room, taken = room_of(solid), 0.0
        for other in fresh:
            if other == name:
                break
            if spec.inside in (other, specs[other].inside) and solid_of(specs[other].shape) is not None:
                points = (_rest_of(shop, other).inverse() @ _rest_of(shop, name)).apply(room.points)
                taken += take_out(fresh[other], points, room.faces)
        if taken <= 0.0:
            findings.append(
                Diagnostic(
                    code="GS413",
                    span=shop.cell.span("stock", name),
                    message=f"`{name}` is not inside of `{spec.inside}`: no place is common to them",
                    hint="look at `xyz`, which counts from the frame of that stock",
                )
            )
    return findings


def _apart(shop: Shop) -> list[Diagnostic]:
    """GS931 for each tool that does not see the parts of a stock together."""
    name = next((name for name, spec in shop.cell.stocks.items() if spec.inside is not None), None)
    if name is None:
        return []
    from gcodesim.processes import PROCESSES

    return [
        Diagnostic(
            code="GS931",
            span=shop.cell.span("tools", number),
            message=f"{tool.name} acts on each part of `{shop.cell.stocks[name].inside}` as if it were alone",
            hint="give it a stock without parts",
        )
        for number, tool in sorted(shop.cell.tools.items())
        if any(PROCESSES[kind].lays or hasattr(PROCESSES[kind], "dose") for kind in tool.processes)
    ]


def _coated(shop: Shop) -> dict[str, Coated]:
    """The bodies that a spray gun may coat, all standing in each other's way."""
    coats = shop.cell.coats
    if not coats:
        return {}
    from gcodesim.processes.spray_pattern import finest

    usual = finest(shop.cell.tools.values())
    sizes = {frame: spec.resolution or usual for frame, spec in coats.items()}
    skins = {placed.frame: _stock_skin(placed.stock) for placed in shop.stocks.values()}
    solids = {body.name: partial(skin_of, body) for body in shop.scene.bodies if body.role in _IN_THE_WAY}
    skins = {**skins, **{frame: skin for frame, skin in solids.items() if frame not in skins}}
    shading = Shading([*skins.items()])
    found = {}
    for frame, size in sizes.items():
        placed = shop.stocks.get(frame.rpartition("/")[2]) if frame.startswith(f"{STOCK}/") else None
        if placed is not None:
            stock = placed.stock
            found[frame] = Coated(
                frame, skins[frame], size, shading, volume=partial(getattr, stock, "volume"), in_part=stock.in_part
            )
        elif frame in skins:
            found[frame] = Coated(frame, skins[frame], size, shading)
    return found


def _stock_skin(stock: Stock) -> Callable[[], Triangles]:
    """The surface of a stock as it is when it is asked for."""

    def skin() -> Triangles:
        surface = stock.surface(stock.spacing_for(COATED_COLUMNS))
        return Triangles(points=surface.vertices, faces=surface.faces.astype(np.int32, copy=False))

    return skin


def skin_of(body: Body) -> Triangles:
    """The skins of all solids of a body, in its frame."""
    parts = [(placed.X, triangles_of(placed.solid)) for placed in body.solids]
    if not parts:
        raise ValueError("a body without a shape")
    starts = np.cumsum([0, *(len(skin.points) for _, skin in parts)])
    return Triangles(
        points=np.concatenate([X.apply(skin.points) for X, skin in parts]),
        faces=np.concatenate([skin.faces + at for (_, skin), at in zip(parts, starts[:-1], strict=True)]).astype(
            np.int32
        ),
    )


def side_by_side(first: Shop, others: Sequence[Shop]) -> list[Shop]:
    """The shops of several channels in one scene, `first` first: with its stocks, fixtures and their places.

    What names no link stands on the table of the machine tool if one of the channels moves it, else on that of
    `first`. The other shops are those of the same cell without stock.
    """
    shops = [first, *others]
    movers = {name: mover for shop in reversed(shops) for name, mover in shop.scene.movers.items()}
    bearer = next((shop.mover for shop in shops if shop.mover.name == MACHINE), first.mover)
    stands = {name: first.scene.frames[name] for name in first.scene.frames if name not in (WORK_FRAME, BODIES)}
    if bearer is not first.mover:
        loose = [name for name in stands if name not in first.placement.carried]
        stands |= {name: _work_stand(bearer, first.scene.at_rest(name)) for name in loose}
    return [
        replace(
            shop,
            scene=replace(shop.scene, movers=movers, frames={**shop.scene.frames, **stands}),
            stocks=first.stocks,
            coated=first.coated,
            beside=tuple(other.name for other in shops if other is not shop),
            placement=replace(
                shop.placement,
                stocks=first.placement.stocks,
                fixtures=first.placement.fixtures,
                parts=first.placement.parts,
                devices=first.placement.devices,
                target=first.placement.target,
                carried=first.placement.carried,
            ),
        )
        for shop in shops
    ]


def _idle_on_lathe(shop: Shop) -> list[Diagnostic]:
    """GS435 for each tool that could cut, but not on this machine."""
    if not (shop.cell.stocks and shop.cell.tools):
        return []
    findings = []
    for number, tool in sorted(shop.cell.tools.items()):
        turns = "turning" in tool.processes
        if turns == shop.mover.lathe or not (turns or "milling" in tool.processes) or tool.kind == "drill":
            continue
        if tool.is_driven:
            continue
        what = "it stands, unless it is driven" if shop.mover.lathe else "the work does not turn"
        hint = (
            "`driven: true` makes it a driven tool, against which the work stands or is turned by a C axis"
            if shop.mover.lathe
            else "turn with lathe tools on a lathe (`machine: lathe_xz`), mill with mills on other machines"
        )
        findings.append(
            Diagnostic(
                code="GS435",
                span=shop.cell.span("tools", str(number)),
                message=f"{tool.name} is moved but takes nothing: {what}",
                hint=hint,
            )
        )
    return findings


def _undrawn(shop: Shop) -> list[Diagnostic]:
    """A finding for each mesh of the robot, or of a tool's own body, that cannot be read."""
    cell = shop.cell
    links = [shape.placed.solid for shape in shop.kinematics.link_shapes]
    owners = [(f"`{shop.name}`", cell.span("robots", shop.name), links)]
    for number, tool in sorted(cell.tools.items()):
        bodies = [placed.solid for _, placed in tool.own_shapes()]
        owners.append((tool.name, cell.span("tools", number, "body"), bodies))
    findings = []
    for name, span, solids in owners:
        meshes = (solid.source for solid in solids if isinstance(solid, Mesh))
        for file in dict.fromkeys(mesh.path for mesh in meshes if isinstance(mesh, MeshFile)):
            try:
                read_mesh(file)
            except MeshError as fault:
                message = f"a mesh of {name} cannot be drawn: {fault}"
                findings.append(Diagnostic(code="GS770", span=span, message=message, hint=fault.hint))
    return findings


def _fitting(shop: Shop, name: str, stock: Stock, spec: StockSpec) -> Stock | Diagnostic:
    """What an earlier run left, as this machine needs it: what a lathe has turned stands in columns on a mill."""
    if not hasattr(stock, "profile"):
        return stock
    turned = cast("Revolved", stock)
    if shop.mover.lathe:
        return _for_driven_tools(shop, name, turned, spec.resolution)
    low, high = stock.bounds
    turned.milling_cell = spec.resolution or default_resolution(shop.cell, tuple((high - low).tolist()))
    return turned.in_columns()


def _upright(shop: Shop, stock: Stock, X_WS: Pose) -> Stock:
    """The stock with its columns along the axis of S that points to the spindle; most stocks are like that anyway."""
    from gcodesim.material.turning import turn_for, turned

    own = shop.cell.channels[shop.channel].orientation
    retreat = shop.mover.retreat
    up = -shop.placement.tool_axis(own) if retreat is None else applied(shop.placement.X_WM.R, retreat)
    R = turn_for(applied(multiplied(X_WS.R, stock.turn).T, up))
    return stock if np.array_equal(R, np.eye(3)) else turned(stock, R)


def _material_named(cell: Cell, name: str) -> Material | None:
    """The material named by an earlier run's stock, if this cell or the library knows it."""
    from gcodesim.processes.materials import LIBRARY

    return cell.materials.get(name) or LIBRARY.get(name)


def _left(shop: Shop, name: str, path: Path, said: str, spec: StockSpec) -> Stock | Diagnostic:
    """The stock that an earlier run left in a file; `said` is how the cell calls where that is."""
    from gcodesim.material.stock_file import StockFileError, load_stock

    try:
        return _fitting(shop, name, load_stock(path), spec)
    except (OSError, StockFileError) as fault:  # it was there when the cell was read
        return Diagnostic(
            code="GS410",
            span=shop.cell.span("stock", name, "from"),
            message=no_stock(said, path.name, fault),
            hint=NOTHING_LEFT,
        )


def _stock(shop: Shop, name: str, spec: StockSpec) -> Stock | Diagnostic:
    from gcodesim.material.stock import Stock, finest_resolution, memory_needed

    shape = spec.shape
    if isinstance(shape, Leftover):
        return _left(shop, name, shape.path, shape.name, spec)
    if shop.mover.lathe:
        return _revolved(shop, name, spec)
    lower, upper = bounds_of(shape)
    size = (upper[0] - lower[0], upper[1] - lower[1], upper[2] - lower[2])
    resolution = spec.resolution or default_resolution(shop.cell, size)
    needed = memory_needed(size, resolution)
    if needed > MEMORY_BUDGET:
        return _too_fine(shop, name, resolution, needed, finest_resolution(size, MEMORY_BUDGET))
    material = spec.material or ""
    if isinstance(shape, Box) and spec.heights is not None:
        from gcodesim.material.warped import Tops, warped_box

        tops = Tops(spec.heights.x, spec.heights.y, spec.heights.z)
        return warped_box(lower, upper, tops, resolution, material)
    if isinstance(shape, Box):
        return Stock.box(lower, upper, resolution, material)
    if isinstance(shape, Cylinder):
        centre = (0.0, 0.0, shape.bottom)
        return Stock.cylinder(centre, 2.0 * shape.radius, shape.top - shape.bottom, resolution, material)
    from gcodesim.material.mesh import stock_of_mesh

    return stock_of_mesh(*read_mesh(shape.path, shape.scale), resolution, material)


def _too_fine(shop: Shop, name: str, resolution: float, needed: int, finest: float) -> Diagnostic:
    """GS411 for a stock whose columns do not fit into memory."""
    return Diagnostic(
        code="GS411",
        span=shop.cell.span("stock", name, "resolution"),
        message=f"stock `{name}` at {resolution / MM:g} mm needs {needed / 2**30:.3g} GiB ({needed} bytes); "
        f"{MEMORY_BUDGET / 2**30:.3g} GiB are allowed",
        value=float(needed),
        limit=float(MEMORY_BUDGET),
        unit="B",
        hint=f"the finest resolution that fits is {finest / MM:g} mm",
    )


def _revolved(shop: Shop, name: str, spec: StockSpec) -> Stock | Diagnostic:
    """The stock of a lathe: a bar or a tube about the spindle's axis."""
    from gcodesim.material.guards import guards_of
    from gcodesim.material.revolved import Revolved

    shape = spec.shape
    X_MS = shop.placement.X_WM.inverse() @ shop.placement.stocks.get(name, Pose.identity())
    aside = float(norms(X_MS.p[None, :2])[0])
    if not isinstance(shape, Cylinder) or aside > 1e-6 or X_MS.R[2, 2] < 1.0 - 1e-9:
        what = "is no cylinder" if not isinstance(shape, Cylinder) else f"stands {aside / MM:.3f} mm beside the spindle"
        return Diagnostic(
            code="GS436",
            span=shop.cell.span("stock", name),
            message=f"stock `{name}` {what}; a lathe turns bars and tubes about its Z axis",
            hint="`cylinder: [diameter, length]`, with `bore` for a tube, and G54 at X0",
        )
    bore = 0.5 * (spec.bore or 0.0)
    if bore >= shape.radius:
        return Diagnostic(
            code="GS436",
            span=shop.cell.span("stock", name, "bore"),
            message=f"the bore of stock `{name}` is as wide as the bar",
            hint="`bore` is the diameter of the hole",
        )
    stock = Revolved.bar(
        shape.radius,
        shape.bottom,
        shape.top,
        bore=bore,
        resolution=None if _is_driven_at(shop) else spec.resolution,
        material=spec.material or "",
        guards=guards_of(spec.chuck, spec.tailstock, shape.bottom, shape.top, shape.radius),
    )
    return _for_driven_tools(shop, name, stock, spec.resolution)


def _is_driven_at(shop: Shop) -> bool:
    """Whether the cell has driven tools; then the resolution of a lathe's stock is that of their columns."""
    return any(tool.is_driven for tool in shop.cell.tools.values())


def _for_driven_tools(shop: Shop, name: str, stock: Revolved, resolution: float | None) -> Stock | Diagnostic:
    """The stock of a lathe with the cell of the columns that driven tools cut."""
    from gcodesim.material.round_columns import finest_columns, memory_of_columns

    if not _is_driven_at(shop):
        return stock
    low, high = stock.bounds
    size = tuple((high - low).tolist())
    stock.milling_cell = resolution or default_resolution(shop.cell, size)
    needed = memory_of_columns(size, stock.milling_cell)
    if needed <= MEMORY_BUDGET:
        return stock
    return _too_fine(shop, name, stock.milling_cell, needed, finest_columns(size, MEMORY_BUDGET))


def default_resolution(cell: Cell, size: tuple[float, float, float]) -> float:
    """Grid [m] of a stock for which the cell names none: fine enough for the smallest tool, never absurdly fine."""
    widths = [width for tool in cell.tools.values() if (width := getattr(tool, "diameter", None))]
    wanted = min(widths) / CELLS_PER_DIAMETER if widths else COARSEST_DEFAULT
    wanted = float(np.clip(wanted, FINEST_DEFAULT, COARSEST_DEFAULT))
    fewest = float(np.sqrt(size[0] * size[1] / MOST_DEFAULT_COLUMNS))
    return max(wanted, fewest)
