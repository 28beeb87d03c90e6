"""Bodies of the cell on whose normal a tool may stand."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from gcodesim.cell.externals import columns_of
from gcodesim.cell.placement import FIXTURE, PART, STOCK, Placement
from gcodesim.cell.placing import MACHINE
from gcodesim.cell.stock import solid_of
from gcodesim.declarations.reading import Path, Reading, suggestion
from gcodesim.frames import Pose
from gcodesim.solids import Hulls, Solid

if TYPE_CHECKING:
    from gcodesim.cell.cell import Cell

TARGET: Final = "target"


def surface_of(cell: Cell, placement: Placement, channel: str) -> tuple[Solid, Pose] | None:
    """The body on whose normal the tool of a channel stands, and X_MS of its place; None where there is none.

    What a table or a platform carries is where it is with their axes at zero.
    """
    own = cell.channels[channel].orientation
    name = None if own is None else own.tool_axis.surface
    if name is None:
        return None
    solid, kind = _named(cell, name)
    if solid is None:
        return None
    X_MW = placement.X_WM.inverse()
    if kind == TARGET:
        assert placement.target is not None
        return solid, X_MW @ placement.target
    frame = f"{kind}/{name}"
    if (on := placement.carried.get(frame)) is not None:
        X_WC = cell.platforms[on.link]
        return solid, X_MW @ X_WC @ on.X
    places = {STOCK: placement.stocks, FIXTURE: placement.fixtures, PART: placement.parts}[kind]
    X_WS = places[name]
    return solid, X_MW @ X_WS


def _named(cell: Cell, name: str) -> tuple[Solid | None, str]:
    """The solid of that name and what kind of body it is; None without one."""
    if name == TARGET and cell.target is not None and cell.target.shape is not None:
        return cell.target.shape.solid, TARGET
    for kind, bodies in ((STOCK, cell.stocks), (FIXTURE, cell.fixtures), (PART, cell.parts)):
        if (body := bodies.get(name)) is not None:
            return solid_of(body.shape), kind
    return None, ""


def check_surfaces(cell: Cell, to: Reading) -> None:
    """A tool axis from a surface names a body with one skin, and the machine can lean its tool."""
    for name, channel in cell.channels.items():
        surface = None if channel.orientation is None else channel.orientation.tool_axis.surface
        if surface is None:
            continue
        path: Path = (
            ("orientation", "tool_axis")
            if name not in to.names_in("channels")
            else ("channels", name, "orientation", "tool_axis")
        )
        span = to.span(path)
        known = [*([TARGET] if cell.target is not None else []), *cell.stocks, *cell.fixtures, *cell.parts]
        solid, _ = _named(cell, surface)
        if surface not in known:
            to.fault("GS712", span, f"there is no stock, fixture or part `{surface}`", suggestion(surface, known))
        elif solid is None or isinstance(solid, Hulls):
            to.fault("GS719", span, f"`{surface}` has no one skin on whose normal a tool could stand", "name a mesh")
        elif (fault := _cannot_lean(cell, str(channel.robot))) is not None:
            to.fault("GS719", span, *fault)


def _cannot_lean(cell: Cell, mover: str) -> tuple[str, str] | None:
    """Why the machine of a channel cannot lean its tool by a surface, and what to do; None where it can."""
    if mover == MACHINE and cell.machine is not None:
        if not any(axis.rotary and axis.at is not None for axis in cell.machine.axes):
            return "no rotary axis of the machine has a place, so its tool stays upright", "give its rotary axes `at:`"
        return None
    robot = cell.robots.get(mover)
    if robot is not None and columns_of(robot.externals):
        letters = " and ".join(columns_of(robot.externals))
        return f"{letters} of the program move external axes; they cannot hold the tool axis besides", (
            "let the planner choose where these stand: `free: true`"
        )
    return None
