"""A program in a cell, as far as it has come, and what was said besides."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import date
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, Protocol

from gcodesim.canon import Event
from gcodesim.cell import Cell, LoadedCell
from gcodesim.cell.cell import MAIN
from gcodesim.cell.verdict import final_findings
from gcodesim.diagnostics import Diagnostic, Findings, Severity, SourceText, Span
from gcodesim.frozen import frozen
from gcodesim.jobs.results import FallenPiece, ProbeResult
from gcodesim.rs274 import Run, Settings
from gcodesim.shop import Shop

if TYPE_CHECKING:
    from gcodesim.checks.stock_watch import StockWatch
    from gcodesim.executor.halt import RunHalt
    from gcodesim.executor.record import StepRecord
    from gcodesim.executor.tasks import Only
    from gcodesim.jobs.meetings import Appointments
    from gcodesim.jobs.target_result import TargetResult
    from gcodesim.log.shapes import DrawnLine
    from gcodesim.material.skin import PaintedSkin
    from gcodesim.planning import Plan
    from gcodesim.planning.bearers import Bearers
    from gcodesim.planning.borne_work import BorneWork
    from gcodesim.world import World

KINEMATIC: Final = "kinematic"
BULLET: Final = "bullet"


@frozen
class Options:
    """Options of the command line that override the cell: `world`, settings of the reader, the day for suppressions.

    `findings` and `sources` are those of further files that the command line names. `force` lets a run overwrite inputs
    and files of others in its output folder. `channels` are the programs of further channels, by name. `only`: what
    the run is about, if not all; the rest is left out. `from_line`: the program takes up another one there, with the
    stocks in the files `left`.
    """

    world: str | None = None
    settings: Callable[[Settings], Settings] = lambda settings: settings
    findings: Sequence[Diagnostic] = ()
    sources: Mapping[str, SourceText] = field(default_factory=dict)
    today: date | None = None
    fail_on: Severity | None = Severity.ERROR
    force: bool = False
    channels: Mapping[str, SourceText] = field(default_factory=dict)
    only: Only | None = None
    from_line: int | None = None
    left: Mapping[str, Path] = field(default_factory=dict)


class Onward(Protocol):
    """How the plan of a job goes on, leg by leg."""

    def onward(self, halt: RunHalt | None = None) -> Plan | None:
        """The plan of all legs so far and the next, which the job keeps from then on; None: there is no further leg.

        `halt`: where the run stands now; None if nothing is run.
        """

    @property
    def ended(self) -> bool:
        """Whether all of the program has been planned."""

    def stock_up(self) -> bool:
        """Load the stocks; False if a fault in one of them, which is reported, keeps the job from running."""

    def watch_stocks(self) -> StockWatch | None:
        """Who looks in a run at what the machine does to stocks as they then are; findings of the plan go."""

    def stop(self) -> None:
        """Somebody stopped the run: report what has been found while reading up to then."""

    def tell_of_untouched_stock(self) -> None:
        """Report that nothing was cut although probes have met the stock."""


@dataclass(slots=True, kw_only=True, eq=False)
class Job:
    """A program in a cell, as far as it has come. `plan` is None when the cell or the program gives nothing to move.

    Several programs at once are a job each: `others` are those of further channels, in the order of their names, and
    `meetings` tells when they wait for each other; only the first job has them. `held` is the mark at which a program
    waits for ever; it is the last that is read of it. `alone`: no other program runs. `seen` gets each window of the
    run as soon as it has been moved through, and `led` puts around its world what leads that on. `borne` is where the
    work is that programs of other channels move, as the plan has it, and `bearers` where it is at any time.
    """

    program: SourceText
    loaded: LoadedCell
    options: Options
    findings: Findings
    channel: str = MAIN
    others: Sequence[Job] = ()
    meetings: Appointments | None = None
    held: Span | None = None
    alone: bool = True
    seen: Callable[[StepRecord], None] | None = None
    led: Callable[[World], World] | None = None
    sensed: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)  # what sensors have read, for the results
    drawings: tuple[DrawnLine, ...] | None = None  # what a script has drawn so far; None where none draws
    shop: Shop | None = None
    borne: BorneWork | None = None
    bearers: Bearers | None = None
    reading: Run | None = None
    plan: Plan | None = None
    legs: Onward | None = None  # how `plan` goes on where the program asks something of the run
    events: Sequence[Event] = ()  # without moves
    probings: list[ProbeResult] = field(default_factory=list)
    fallen: dict[str, list[FallenPiece]] = field(default_factory=dict)  # out of which stock
    sources: dict[str, SourceText] = field(default_factory=dict)
    target: TargetResult | None = None  # the finished stock against the target
    skins: dict[str, PaintedSkin] = field(default_factory=dict)  # of stocks that were compared with it, by name

    @property
    def cell(self) -> Cell | None:
        return self.loaded.cell

    @property
    def stopped_at(self) -> Span | None:
        """The block at which reading ended early, or the mark at which the program waits for ever."""
        if self.held is not None:
            return self.held
        return self.reading.failed.span if self.reading is not None and self.reading.failed is not None else None

    @property
    def all(self) -> tuple[Job, ...]:
        """The jobs of all channels that run, this one first."""
        return (self, *self.others)

    def shown(self, findings: Iterable[Diagnostic]) -> list[Diagnostic]:
        """`findings` with the severities of the cell, without those that it suppresses."""
        return final_findings(findings, self.cell, self.program, self.options.today)

    @property
    def world(self) -> str:
        """Which world runs this: the requested one, else that of the cell, else bullet if it is installed.

        Who asks for nothing but shapes or forces does not ask for motors.
        """
        if self.options.only in ("shape", "force"):
            return KINEMATIC
        named = self.options.world or (self.cell.simulation.world if self.cell is not None else None)
        return named or (BULLET if find_spec("pybullet") is not None else KINEMATIC)
