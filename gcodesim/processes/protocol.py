"""What every process declares, including those of third parties: what it acts on, its reach, what it reads and writes.

A process acts on targets, with one `Task` for each; `acts_on` names their sort:

- `stock`: each stock of the cell in turn, a `material.Stock`, which the process may change in place;
- `revolved`: the same for the stock of a lathe, a `material.revolved.Revolved`; it is no `stock`;
- `milled`: what a process on `stock` gets of the stock of a lathe where its tool is driven: its columns;
- `surface`: the skin of each stock, and of each other body that is to be coated, in turn: a `Skin`, which can be
  looked at but not cut. Where the cell has a spray gun it is a `CoatedSkin`;
- `bodies`: everything in the cell that does not move by itself, all at once, as a tuple of `SolidBody`;
- `parts`: everything that may be carried, all at once, as a `gripping.PartsAtHand`, which takes them and lets go;
- `nothing`: there is no target. `run` gets None, and its frame S is that of the bodies.

The executor asks a process about a window of steps when its `zone` may meet the target on the way; a process without a
target, or with a zone that is `EVERYWHERE`, is asked about every window. It is not asked, and says nothing, where the
cell has no target of that sort.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Final, Literal, Protocol, Self

import numpy as np
from numpy.typing import NDArray

from gcodesim.processes.column import Column
from gcodesim.processes.signal import Signal
from gcodesim.processes.window import ProcessState, ProcessStep, Window
from gcodesim.processes.zone import EVERYWHERE, Zone

if TYPE_CHECKING:
    from gcodesim.diagnostics import Diagnostic
    from gcodesim.material.film import BodyFilm, Shades
    from gcodesim.processes.materials import Material
    from gcodesim.processes.rows import Rows

Array = NDArray[np.float64]

UP: Final = np.array([0.0, 0.0, 1.0])
UPRIGHT: Final = 1e-6
"""[-] by which the axis of a tool may differ from upright and still be called so: an arm says no more of it."""

ActsOn = Literal["stock", "revolved", "milled", "surface", "bodies", "parts", "nothing"]


class Skin(Protocol):
    """The surface of a stock as it is now, in the frame S of its columns."""

    @property
    def name(self) -> str:
        """The stock's name in the cell."""

    @property
    def box(self) -> tuple[Array, Array]:
        """Least and greatest corner (3,) [m] in S of the box that holds it."""

    def triangles(self) -> tuple[Array, NDArray[np.int32]]:
        """Points (v, 3) [m] in S and triangles (t, 3) that point outwards; made anew at each call."""


class CoatedSkin(Skin, Protocol):
    """A skin on which a film may be laid, in the same frame S."""

    @property
    def coating(self) -> BodyFilm | None:
        """The film, begun on the skin as it is now if there is none; None where that cannot be."""

    @property
    def shade_frames(self) -> tuple[str, ...]:
        """The frames of the bodies that may stand between a gun and the skin, for `Window.where`."""

    @property
    def shades(self) -> Shades:
        """These bodies, each in its frame."""


class SolidBody(Protocol):
    """Something solid in the cell, in the frame S of all bodies."""

    @property
    def name(self) -> str:
        """The name in the cell."""

    @property
    def role(self) -> str:
        """What it is: `fixture`, `stock` or `part`."""

    @property
    def box(self) -> tuple[Array, Array]:
        """Least and greatest corner (3,) [m] in S of the box that holds it."""

    def triangles(self) -> tuple[Array, NDArray[np.int32]]:
        """Points (v, 3) [m] in S and triangles (t, 3)."""


class Loop(Protocol):
    """A window that is run step by step; see `Process.loop`."""

    def step(self, k: int, moved_before: Array, moved: Array, share: Array) -> Array:
        """Step `k`, in order. The tip is off the window's pieces by `moved_before` … `moved` (3,) [m].

        `share` (c, 2) tells where in its step each piece begins and ends. Wrench (6,) on the tool in S.
        """

    def finish(self) -> ProcessStep:
        """The outcome of all steps."""


class Process:
    """The base of all processes: it acts on nothing, writes nothing and finds nothing wrong.

    A kind of process is a frozen dataclass below this. `kind` is its name in the table `PROCESSES`; `acts_on` its sort
    of target; `takes` says that it removes material, `pushes` that it exerts a force, so that a machine may yield;
    `lays` that it adds material to a stock, which may grow beyond its box; `together` that it acts on a stock
    with all parts that stand in it at once, however they are turned: it is given a `material.StockAssembly`, or,
    where it lays, the whole with the parts in it;
    `touches` says that it is about the tool in contact, so that it is not asked where a probe touches on purpose;
    `told_by_words` are codes of findings about its switch that follow from the words of a program alone, without a run:
    GS539 (on in a rapid), GS542 (never on);
    `leads` says that its force depends on nothing but the window, so that the others act where it puts the tip;
    `reads` lists the signals that `Window.signals` holds for it, `writes` the columns that it gives values for.
    """

    kind: ClassVar[str] = ""
    acts_on: ClassVar[ActsOn] = "stock"
    takes: ClassVar[bool] = False
    lays: ClassVar[bool] = False
    together: ClassVar[bool] = False
    pushes: ClassVar[bool] = False
    touches: ClassVar[bool] = False
    leads: ClassVar[bool] = False
    told_by_words: ClassVar[tuple[str, ...]] = ()
    reads: ClassVar[tuple[Signal, ...]] = ()
    writes: ClassVar[tuple[Column, ...]] = ()

    @classmethod
    def of(cls, tool: Any, material: Material | None) -> Self:
        """The process of `tool` at a target of `material`, which is None if it is not known or there is no stock."""
        raise NotImplementedError

    @classmethod
    def of_revolved(cls, tool: Any, material: Material | None) -> Process | None:
        """For a process that acts on `stock`: what `tool` does to that of a lathe; None if it can do nothing there."""
        return None

    @classmethod
    def columns_of(cls, tool: Any) -> tuple[Column, ...]:
        """The columns that it provides for `tool`: all that it `writes`, and more for what some tools ask for."""
        return cls.writes

    @classmethod
    def is_on(cls, signals: Mapping[str, NDArray[Any]], tool: Any) -> NDArray[np.bool_] | None:
        """Whether words of the program have switched it on (n,), by the signals (n,) that it reads.

        None of a process that is not switched: what it does follows from where its tool is.
        """
        return None

    @classmethod
    def is_seen_on(cls, signals: Mapping[str, NDArray[Any]], tool: Any) -> NDArray[np.bool_] | None:
        """Whether the log draws it as switched on (n,): what gives something off while it is on; None as of `is_on`."""
        return cls.is_on(signals, tool)

    @classmethod
    def needs(cls, tool: Any) -> tuple[Signal, ...]:
        """The signals that it reads without which nothing comes of it: one of them that stays 0 is told (GS549)."""
        return ()

    @property
    def zone(self) -> Zone:
        """Where it acts, seen from the tip of its tool."""
        return EVERYWHERE

    def rests(self, window: Window) -> bool:
        """Whether it exerts no force in a window, as can be told beforehand; then no world has to ask for it."""
        return not self.pushes

    def idles(self, signals: Mapping[str, NDArray[Any]], steps: int) -> NDArray[np.bool_]:
        """In which steps (n,) it exerts no force, of a process that `leads`, by the signals (n,) that it reads."""
        return np.full(steps, not self.pushes)

    @property
    def by_path(self) -> bool:
        """Whether it says the same however its path is cut into steps that are shorter than what it acts on is fine.

        Then a run may give it steps of different length; see `Window.dt`.
        """
        return False

    @property
    def shaping(self) -> Process:
        """What does the same to the shape of the target as quickly as can be: without force where that takes time."""
        return self

    @property
    def swept(self) -> Array | None:
        """The closed outline (k, 2) [m] of what takes or adds material: across the axis, and along it from the tip.

        On a lathe that of the blade, in (r, z). It tells which line made a face; None of processes that make none.
        """
        return None

    def takes_within(self, depth: float) -> Zone:
        """Where it takes material, seen from the tip of its tool; none lies farther beyond the tip than `depth` [m]."""
        outline = self.swept
        if outline is None:
            return self.zone
        radius, low, high = float(outline[:, 0].max()), float(outline[:, 1].min()), float(outline[:, 1].max())
        return Zone(radius=radius, below=-low, above=high)

    def from_above(self, window: Window) -> bool:
        """Whether all that it takes in a window it takes with what stood above, along Z of its target."""
        outline = self.swept
        if outline is None or float(np.abs(window.axis - UP).max(initial=0.0)) > UPRIGHT:
            return False
        side = outline[outline[:, 0] > 0.0]
        risen = np.lexsort((side[:, 0], np.round(side[:, 1], 8)))
        return bool((np.diff(side[risen, 0]) >= -1e-9).all())

    def begin(self) -> ProcessState:
        """The state of a tool that was just put in."""
        return ProcessState()

    def run(self, target: Any, window: Window, state: ProcessState) -> ProcessStep:
        """Act on `target` along `window`; `target` and `state` are changed in place."""
        raise NotImplementedError

    def loop(self, target: Any, window: Window, state: ProcessState) -> Loop:
        """The same step by step, for a world that reacts to every wrench with a motion; only when it `pushes`."""
        raise NotImplementedError

    @classmethod
    def findings(cls, rows: Rows) -> Iterable[Diagnostic]:
        """Findings about how the process was used, in its own words; `rows` are those of all its tools."""
        return ()
