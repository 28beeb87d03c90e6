"""Tools and processes of a stranger: what none of ours does, each as small as it can be.

They stand for packages that somebody else writes; `test_newcomers.py` runs them through a whole cell. The fixture
`newcomers` puts them into the tables for one test.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from gcodesim.declarations.keys import key
from gcodesim.diagnostics import Diagnostic
from gcodesim.material.shape import cylinder as section
from gcodesim.processes.column import ADDED, ENGAGED, FINDINGS, LOG, REMOVED, RESULTS, Column
from gcodesim.processes.protocol import Process
from gcodesim.processes.rows import Rows
from gcodesim.processes.signal import ACTIVE, SetBy, Signal
from gcodesim.processes.window import ProcessState, ProcessStep, Window
from gcodesim.processes.zone import Zone
from gcodesim.tools.body import Primitive, cylinder
from gcodesim.tools.flat_end_mill import FlatEndMill
from gcodesim.tools.parts import BodyPart
from gcodesim.tools.tool import Tool

HERE = "tests.contract.newcomers"
NEW = {
    "tools": {
        "pointer": "Pointer",
        "lamp": "Lamp",
        "gun": "Gun",
        "feeler": "Feeler",
        "watched_mill": "WatchedMill",
        "beam": "Beam",
        "claw": "Claw",
    },
    "processes": {
        "burning": "Burning",
        "misting": "Misting",
        "feeling": "Feeling",
        "watching": "Watching",
        "shining": "Shining",
        "holding": "Holding",
    },
    "parts": {"lens": "LENS"},
}
LENS = BodyPart(words="the lens", hint="keep the lens away", color=(0.1, 0.2, 0.9, 1.0))


@dataclass(frozen=True, slots=True, kw_only=True)
class Pointer(Tool):
    """Something that is only moved, with a part that nobody has heard of."""

    kind: ClassVar[str] = "pointer"

    @property
    def primitives(self) -> tuple[Primitive, ...]:
        return (cylinder("finger", 2e-3, 0.0, self.length), *self._holder_bodies())


@dataclass(frozen=True, slots=True, kw_only=True)
class Lamp(Tool):
    """A laser that burns material between its tip and `focus` below it; it does not touch anything."""

    kind: ClassVar[str] = "lamp"
    process: ClassVar[str] = "burning"

    focus: float = key("length", "how far below the tip it burns")
    spot: float = key("length", "diameter of the spot", default=1e-3)

    @property
    def primitives(self) -> tuple[Primitive, ...]:
        return (cylinder("lens", 5e-3, 0.0, self.length),)


@dataclass(frozen=True, kw_only=True, eq=False)
class Burning(Process):
    """Takes all material in its spot, down to its focus, while it is switched on."""

    kind: ClassVar[str] = "burning"
    takes: ClassVar[bool] = True
    reads: ClassVar[tuple[Signal, ...]] = (ACTIVE,)
    writes: ClassVar[tuple[Column, ...]] = (
        REMOVED,
        ENGAGED,
        Column("heat", "J", says="energy that went into the material"),
        Column("dose", "J/m^2", of="greatest", shown_in=LOG, says="energy for each area"),
        Column("hot", of="any", says="the beam is on"),
        Column("burnt_rapid", "m^3", shown_in=FINDINGS, says="what was burnt in rapids"),
    )

    lamp: Lamp

    @classmethod
    def of(cls, tool: Lamp, material: Any) -> Burning:
        return cls(lamp=tool)

    @property
    def zone(self) -> Zone:
        return Zone(radius=0.5 * self.lamp.spot, below=self.lamp.focus)

    def run(self, stock: Any, window: Window, state: ProcessState) -> ProcessStep:
        lit = window.signals[ACTIVE.name] > 0.0
        on = lit[window.piece_step]
        down = self.lamp.focus * window.axis[window.piece_step][on]
        found = stock.remove(
            window.piece_start[on] - down,
            window.piece_end[on] - down,
            section(self.lamp.spot, 0.0, self.lamp.focus),
        )
        removed = np.zeros(window.steps)
        np.add.at(removed, window.piece_step[on], found.volume)
        heat = 2e10 * removed
        return ProcessStep.free(
            window.steps,
            {
                "removed": removed,
                "engaged": removed > 0.0,
                "heat": heat,
                "dose": heat / (0.25 * np.pi * self.lamp.spot**2),
                "hot": lit,
                "burnt_rapid": np.where(window.rapid, removed, 0.0),
            },
        )

    @classmethod
    def findings(cls, rows: Rows) -> Iterable[Diagnostic]:
        """A word of its own: GS401 with a message that no cutter has."""
        for event in rows.events(rows["burnt_rapid"] > 0.0):
            first = int(event[0])
            yield Diagnostic(
                code="GS401",
                message=f"{rows.tool_name(first)} burns {rows['burnt_rapid'][event].sum() * 1e9:.3g} mm³ on its way",
                span=rows.span(first),
            )


@dataclass(frozen=True, slots=True, kw_only=True)
class Gun(Tool):
    """A spray gun."""

    kind: ClassVar[str] = "gun"
    process: ClassVar[str] = "misting"


@dataclass(frozen=True, kw_only=True, eq=False)
class Misting(Process):
    """Acts on a surface: the thickest film so far, if all paint that hits the box spreads over its surface."""

    kind: ClassVar[str] = "misting"
    acts_on: ClassVar[Any] = "surface"
    reads: ClassVar[tuple[Signal, ...]] = (ACTIVE, Signal("flow", "m^3/s", 1e-6))
    writes: ClassVar[tuple[Column, ...]] = (
        ENGAGED,
        ADDED,
        Column("film", "m", of="last", says="thickness of the film"),
    )

    @classmethod
    def of(cls, tool: Gun, material: Any) -> Misting:
        return cls()

    @property
    def zone(self) -> Zone:
        return Zone(radius=0.05, below=0.2)

    def begin(self) -> ProcessState:
        return ProcessState(values=np.zeros(1))

    def run(self, skin: Any, window: Window, state: ProcessState) -> ProcessStep:
        points, faces = skin.triangles()
        a, b, c = (points[faces[:, i]] for i in range(3))
        area = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()
        on = window.signals[ACTIVE.name] > 0.0
        paint = np.where(on, window.signals["flow"] * window.dt, 0.0)
        film = state.values[0] + np.cumsum(paint) / area
        state.values[0] = film[-1]
        return ProcessStep.free(window.steps, {"engaged": on, "film": film})


@dataclass(frozen=True, slots=True, kw_only=True)
class Feeler(Tool):
    """Tells how far the nearest body is from its tip."""

    kind: ClassVar[str] = "feeler"
    process: ClassVar[str] = "feeling"


@dataclass(frozen=True, kw_only=True, eq=False)
class Feeling(Process):
    """Acts on bodies, within 20 mm of the tip."""

    kind: ClassVar[str] = "feeling"
    acts_on: ClassVar[Any] = "bodies"
    writes: ClassVar[tuple[Column, ...]] = (
        ENGAGED,
        Column("nearness", "m", of="greatest", shown_in=LOG | RESULTS, says="20 mm less the distance of a body"),
        Column("bodies", of="last", shown_in=RESULTS, says="how many bodies there are"),
    )

    @classmethod
    def of(cls, tool: Feeler, material: Any) -> Feeling:
        return cls()

    @property
    def zone(self) -> Zone:
        return Zone(radius=0.02, below=0.02, above=0.02)

    def run(self, bodies: Any, window: Window, state: ProcessState) -> ProcessStep:
        near = np.zeros(window.steps)
        for body in bodies:
            low, high = body.box
            outside = np.maximum(np.maximum(low - window.piece_end, window.piece_end - high), 0.0)
            np.maximum.at(near, window.piece_step, 0.02 - np.linalg.norm(outside, axis=1))
        return ProcessStep.free(
            window.steps, {"engaged": near > 0.0, "nearness": near, "bodies": np.full(window.steps, len(bodies))}
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class Watching(Process):
    """Acts on nothing: counts the pictures that a camera has taken, one each tenth of a second."""

    kind: ClassVar[str] = "watching"
    acts_on: ClassVar[Any] = "nothing"
    writes: ClassVar[tuple[Column, ...]] = (
        Column("pictures", of="last", says="taken so far"),
        Column("way", "m", says="of the camera"),
    )

    @classmethod
    def of(cls, tool: Tool, material: Any) -> Watching:
        assert material is None
        return cls()

    def begin(self) -> ProcessState:
        return ProcessState(values=np.zeros(1))

    def run(self, target: Any, window: Window, state: ProcessState) -> ProcessStep:
        assert target is None
        steps = state.values[0] + np.arange(1, window.steps + 1)
        state.values[0] = steps[-1]
        way = np.zeros(window.steps)
        np.add.at(way, window.piece_step, np.linalg.norm(window.piece_end - window.piece_start, axis=1))
        return ProcessStep.free(window.steps, {"pictures": np.floor(steps * window.dt / 0.1 + 1e-9), "way": way})


@dataclass(frozen=True, slots=True, kw_only=True)
class WatchedMill(FlatEndMill):
    """A cutter with a camera beside it: two processes."""

    kind: ClassVar[str] = "watched_mill"
    processes: ClassVar[tuple[str, ...]] = ("milling", "watching")


@dataclass(frozen=True, slots=True, kw_only=True)
class Beam(Tool):
    """A laser whose program gives its power."""

    kind: ClassVar[str] = "beam"
    process: ClassVar[str] = "shining"


POWER: Signal = Signal("power", "W", 5.0)


@dataclass(frozen=True, kw_only=True, eq=False)
class Shining(Process):
    """Acts on nothing: adds up the energy of its beam, which is what `power` says."""

    kind: ClassVar[str] = "shining"
    acts_on: ClassVar[Any] = "nothing"
    reads: ClassVar[tuple[Signal, ...]] = (POWER,)
    writes: ClassVar[tuple[Column, ...]] = (
        Column("energy", "J", says="of the beam"),
        Column("beam", "W", of="greatest", says="power of the beam"),
    )

    @classmethod
    def of(cls, tool: Tool, material: Any) -> Shining:
        return cls()

    def run(self, target: Any, window: Window, state: ProcessState) -> ProcessStep:
        power = window.signals[POWER.name]
        return ProcessStep.free(window.steps, {"energy": power * window.dt, "beam": power})


@dataclass(frozen=True, slots=True, kw_only=True)
class Claw(Tool):
    """A gripper."""

    kind: ClassVar[str] = "claw"
    process: ClassVar[str] = "holding"


@dataclass(frozen=True, kw_only=True, eq=False)
class Holding(Process):
    """Acts on nothing: tells how long it is closed. It receives `close` and `open`, and a verb that nobody else has."""

    kind: ClassVar[str] = "holding"
    acts_on: ClassVar[Any] = "nothing"
    reads: ClassVar[tuple[Signal, ...]] = (
        Signal(
            "grip",
            set_by=(
                SetBy("gripper", "close", 1.0),
                SetBy("gripper", "open", 0.0),
                SetBy("claw", "hold gently", 0.5),
            ),
        ),
    )
    writes: ClassVar[tuple[Column, ...]] = (
        Column("closed", of="any", says="the claw is shut"),
        Column("grip", of="greatest", shown_in=LOG | RESULTS, says="how firmly"),
    )

    @classmethod
    def of(cls, tool: Tool, material: Any) -> Holding:
        return cls()

    def run(self, target: Any, window: Window, state: ProcessState) -> ProcessStep:
        grip = window.signals["grip"]
        return ProcessStep.free(window.steps, {"closed": grip > 0.0, "grip": grip})
