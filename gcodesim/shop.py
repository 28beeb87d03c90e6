"""The cell come to life: kinematics, tools, processes and stock, each in its place."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Final

import numpy as np

from gcodesim.cell import Cell, Placement, place
from gcodesim.cell.cell import MACHINE, MAIN
from gcodesim.cell.leftover import NOTHING_LEFT, Leftover, no_stock
from gcodesim.cell.machine import MachineTool
from gcodesim.cell.placement import bounds_of
from gcodesim.cell.robot import Payload, Robot
from gcodesim.cell.stock import Box, Cylinder, StockSpec
from gcodesim.diagnostics import Diagnostic
from gcodesim.frames import Array, Pose
from gcodesim.kinematics import Cartesian, Chain, Inertial, Kinematics, Link, kinematics_of
from gcodesim.units import MM

if TYPE_CHECKING:
    from gcodesim.material.stock import Stock
    from gcodesim.processes.materials import Material
    from gcodesim.tools.tool import Tool

MEMORY_BUDGET: Final = 2 << 30
"""Bytes that one stock may take: what a laptop has to spare."""

CELLS_PER_DIAMETER: Final = 24
"""Cells across the smallest cutter where the cell file names no resolution."""

FINEST_DEFAULT: Final = 0.05 * MM
COARSEST_DEFAULT: Final = 0.5 * MM
MOST_DEFAULT_COLUMNS: Final = 4_000_000


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PlacedStock:
    """A workpiece and where it stands: `X_WS` is the frame of its columns in the world (table axes at zero).

    That is its own frame S, unless it lies on another side (`stock.turn`).
    """

    name: str
    spec: StockSpec
    stock: Stock
    X_WS: Pose
    material: Material | None
    initial: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Shop:
    """All that a channel's program acts on.

    `X_WB` is the base B of the robot (of a machine: M), `X_BM` machine zero seen
    from there; on an arm M is B, turned when its work systems are tilted.
    `stiffness` (j,) [N·m/rad] or None for a rigid machine.
    """

    cell: Cell
    channel: str
    name: str
    kinematics: Kinematics
    placement: Placement
    X_WB: Pose
    X_BM: Pose
    home: Array
    stiffness: Array | None
    stocks: Mapping[str, PlacedStock] = field(default_factory=dict)

    @property
    def is_arm(self) -> bool:
        return not isinstance(self.kinematics, Cartesian)

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Names as in the log: `arm/joint_1`, `machine/X`."""
        return tuple(f"{self.name}/{joint}" for joint in self.kinematics.joints.names)

    @property
    def magazine_pose(self) -> Pose:
        """Where the first pocket stands: X_W of the flange side of the tool in it."""
        placed = self.cell.magazine.place
        return self.cell.frames[placed.frame or "world"] @ placed.X

    def tool(self, number: int) -> Tool | None:
        """The tool of that number; None for the empty spindle and for numbers that the cell does not know."""
        return self.cell.tools.get(number)


def open_shop(cell: Cell, channel: str = MAIN) -> Shop:
    """Kinematics and places of a cell, without stock."""
    if channel not in cell.channels:
        channel = next(iter(cell.channels))
    mover = cell.machine_of(channel)
    placement = place(cell, channel)
    kinematics: Kinematics
    if isinstance(mover, MachineTool):
        kinematics = kinematics_of(mover.chain)
        name, X_WB, stiffness = MACHINE, mover.X_WM, None
        homes = {axis.letter: axis.home for axis in mover.axes}
        home = np.array([homes[letter] for letter in kinematics.joints.names])
    else:
        kinematics = kinematics_of(_loaded(mover.chain, mover.payload))
        name, X_WB = mover.name, mover.X_WB
        home = np.array(mover.home)
        stiffness = None if mover.stiffness is None else np.array(mover.stiffness)
    return Shop(
        cell=cell,
        channel=channel,
        name=name,
        kinematics=kinematics,
        placement=placement,
        X_WB=X_WB,
        X_BM=X_WB.inverse() @ placement.X_WM,
        home=home,
        stiffness=stiffness,
    )


def _loaded(chain: Chain, payload: Payload | None) -> Chain:
    """The chain with what hangs at its flange besides the tool."""
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


def with_stock(shop: Shop) -> tuple[Shop, list[Diagnostic]]:
    """The shop with its workpieces; a finding for each that does not fit into memory or cannot be read."""
    stocks: dict[str, PlacedStock] = {}
    findings = _undrawn(shop)
    for name, spec in shop.cell.stocks.items():
        made = _stock(shop, name, spec)
        if isinstance(made, Diagnostic):
            findings.append(made)
            continue
        material = shop.cell.material(spec)
        if material is None and made.material:
            material = _material_named(shop.cell, made.material)
        X_WS = shop.placement.stocks[name]
        made = _upright(shop, made, X_WS)
        stocks[name] = PlacedStock(
            name=name,
            spec=spec,
            stock=made,
            X_WS=X_WS @ Pose(np.zeros(3), made.turn),
            material=material,
            initial=made.volume,
        )
    return replace(shop, stocks=stocks), findings


def _undrawn(shop: Shop) -> list[Diagnostic]:
    """A finding for each mesh of the robot that cannot be read."""
    from gcodesim.material.mesh import read_mesh

    findings = []
    for mesh in dict.fromkeys(shape.mesh for shape in shop.kinematics.link_shapes if shape.mesh is not None):
        try:
            read_mesh(mesh)
        except ValueError as fault:
            message = f"a mesh of `{shop.name}` cannot be drawn: {fault}"
            findings.append(Diagnostic(code="GS770", span=shop.cell.span("robots", shop.name), message=message))
    return findings


def _upright(shop: Shop, stock: Stock, X_WS: Pose) -> Stock:
    """The stock with its columns along the axis of S that points to the spindle; most stand so from the start."""
    from gcodesim.material.turning import turn_for, turned

    own = shop.cell.channels[shop.channel].orientation
    up = -shop.placement.tool_axis(own) if shop.is_arm else shop.placement.X_WM.R[:, 2]
    R = turn_for((X_WS.R @ stock.turn).T @ up)
    return stock if np.array_equal(R, np.eye(3)) else turned(stock, R)


def _material_named(cell: Cell, name: str) -> Material | None:
    """A material that an earlier run's stock names, when this cell or the library knows it."""
    from gcodesim.processes.materials import LIBRARY

    return cell.materials.get(name) or LIBRARY.get(name)


def _stock(shop: Shop, name: str, spec: StockSpec) -> Stock | Diagnostic:
    from gcodesim.material.stock import Stock, finest_resolution, memory_needed
    from gcodesim.material.stock_file import StockFileError, load_stock

    span = shop.cell.span("stock", name, "resolution")
    shape = spec.shape
    if isinstance(shape, Leftover):
        try:
            return load_stock(shape.path)
        except (OSError, StockFileError) as fault:  # it was there when the cell was read
            return Diagnostic(
                code="GS410",
                span=shop.cell.span("stock", name, "from"),
                message=no_stock(shape.name, shape.path.name, fault),
                hint=NOTHING_LEFT,
            )
    lower, upper = bounds_of(shape)
    size = (upper[0] - lower[0], upper[1] - lower[1], upper[2] - lower[2])
    resolution = spec.resolution or default_resolution(shop.cell, size)
    needed = memory_needed(size, resolution)
    if needed > MEMORY_BUDGET:
        finest = finest_resolution(size, MEMORY_BUDGET)
        return Diagnostic(
            code="GS411",
            span=span,
            message=f"stock `{name}` at {resolution / MM:g} mm needs {needed / 2**30:.3g} GiB ({needed} bytes); "
            f"{MEMORY_BUDGET / 2**30:.3g} GiB are allowed",
            value=float(needed),
            limit=float(MEMORY_BUDGET),
            unit="B",
            hint=f"the finest resolution that fits is {finest / MM:g} mm",
        )
    material = spec.material or ""
    if isinstance(shape, Box):
        return Stock.box(lower, upper, resolution, material)
    if isinstance(shape, Cylinder):
        centre = (0.0, 0.0, shape.bottom)
        return Stock.cylinder(centre, 2.0 * shape.radius, shape.top - shape.bottom, resolution, material)
    from gcodesim.material.mesh import read_mesh, stock_of_mesh

    return stock_of_mesh(*read_mesh(shape.path, shape.scale), resolution, material)


def default_resolution(cell: Cell, size: tuple[float, float, float]) -> float:
    """Grid [m] of a stock whose file names none: fine enough for the smallest tool, never absurdly fine."""
    widths = [width for tool in cell.tools.values() if (width := getattr(tool, "diameter", None))]
    wanted = min(widths) / CELLS_PER_DIAMETER if widths else COARSEST_DEFAULT
    wanted = float(np.clip(wanted, FINEST_DEFAULT, COARSEST_DEFAULT))
    fewest = float(np.sqrt(size[0] * size[1] / MOST_DEFAULT_COLUMNS))
    return max(wanted, fewest)


def mover_of(shop: Shop) -> MachineTool | Robot:
    """The description of what the program moves."""
    return shop.cell.machine_of(shop.channel)
