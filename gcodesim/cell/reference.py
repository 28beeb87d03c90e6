"""All keys of the cell file as Markdown, from the classes that read them; `docs/cell.md` carries it.

`python -m gcodesim.cell.reference docs/cell.md` rewrites the part of that page between its two markers. With types of
tools behind the page (`… my_page.md chamfer_mill`) it writes their tables alone, for the page of another package.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Final

from gcodesim.cell.cell import Cell
from gcodesim.cell.channel import Channel
from gcodesim.cell.device import Device
from gcodesim.cell.externals import External, SlidingAxis, TurningAxis
from gcodesim.cell.film import FilmRegion, FilmSpec
from gcodesim.cell.machine import MachineForm
from gcodesim.cell.machine_axes import LinearAxis, RotaryAxis
from gcodesim.cell.material import MaterialForm
from gcodesim.cell.named_kinematics import NAMED_KINEMATICS
from gcodesim.cell.orientation import Orientation
from gcodesim.cell.part import PartSpec
from gcodesim.cell.placing import Place
from gcodesim.cell.robot import RobotForm
from gcodesim.cell.sensors import Mount
from gcodesim.cell.settings import Limits, LogSettings, Magazine, Simulation, SpindleTimes, Suppression
from gcodesim.cell.signals import SignalSource
from gcodesim.cell.stock import Layer, ShapeKeys, StockSpec, Target
from gcodesim.cell.tool_stand import StandSpec
from gcodesim.controllers.flexible import Flexible
from gcodesim.controllers.pd import PD
from gcodesim.declarations.keys import all_keys, keys
from gcodesim.declarations.tables import key_table, units_as_text
from gcodesim.key_page import rewrite
from gcodesim.sensors import SENSORS
from gcodesim.tools import TOOLS
from gcodesim.tools.extruder import RayCone
from gcodesim.tools.own_body import OwnBody
from gcodesim.tools.spray_gun import Fading, Footprint
from gcodesim.tools.tcp import Tcp
from gcodesim.tools.tcp_load import TcpLoad

SECTIONS: Final[tuple[tuple[str, type], ...]] = (
    ("A place (`frames`, `base`, and among the keys of whatever stands somewhere)", Place),
    ("`machine`", MachineForm),
    ("Axes X, Y, Z", LinearAxis),
    ("Axes A, B, C", RotaryAxis),
    *((f"`kinematics` of type `{name}`", cls) for name, cls in NAMED_KINEMATICS.items()),
    ("`robots`", RobotForm),
    ("`controller` of type `flexible`", Flexible),
    ("`controller` of type `pd` or `computed_torque`", PD),
    ("`externals`", External),
    ("External axes U, V, W", SlidingAxis),
    ("External axes A, B, C", TurningAxis),
    ("A channel (`channels`); where there is but one, its keys stand at top level", Channel),
    ("`orientation`", Orientation),
    ("A signal (`signals`)", SignalSource),
    ("Shapes of stock, fixtures and parts", ShapeKeys),
    ("`stock`, besides its shape and place", StockSpec),
    ("`parts`, besides their shape and place", PartSpec),
    ("`film` of stock, parts and fixtures", FilmSpec),
    ("`inside` of `film`", FilmRegion),
    ("`layers` of a stock", Layer),
    ("`tcp` of a tool", Tcp),
    ("`body` of a tool", OwnBody),
    ("`load` of a tool", TcpLoad),
    ("`rays` of an extruder", RayCone),
    ("`footprint` of a spray gun", Footprint),
    ("`fading` of a spray gun", Fading),
    ("`devices`, besides their shape and place", Device),
    ("`materials`", MaterialForm),
    ("`target`, besides its place", Target),
    ("`sensors`, besides their place and the keys of their type", Mount),
    ("`magazine`, besides its place", Magazine),
    ("`stands` of the magazine, by the numbers of tools", StandSpec),
    ("`spindle`", SpindleTimes),
    ("`limits`", Limits),
    ("`suppress`", Suppression),
    ("`simulation`", Simulation),
    ("`log`", LogSettings),
)


def reference() -> str:
    """The reference: a table for each class, one for each tool type, and the units."""
    parts = ["### Top level", "", *key_table(list(keys(Cell).values()))]
    shape = set(all_keys(ShapeKeys))
    for title, cls in SECTIONS:
        inherited = shape if issubclass(cls, ShapeKeys) and cls is not ShapeKeys else set()
        parts += ["", f"### {title}", "", *key_table([key for key in keys(cls).values() if key.name not in inherited])]
    parts += ["", tool_reference(list(TOOLS))]
    for name, sensor in SENSORS.items():
        parts += ["", f"### Sensor type `{name}`", "", *key_table(list(all_keys(sensor).values()))]
    return "\n".join([*parts, "", "### Units", "", "```text", units_as_text(), "```"])


def tool_reference(names: list[str]) -> str:
    """A table for each of these types of tools."""
    return "\n\n".join(
        "\n".join([f"### Tool type `{name}`", "", *key_table(list(all_keys(TOOLS[name]).values()))]) for name in names
    )


if __name__ == "__main__":
    page, *types = sys.argv[1:]
    rewrite(Path(page), tool_reference(types) if types else reference())
