"""Extrusion: a nozzle lays a bead along its path.

Two ways, by what is known. Where the volume is, as by E words, which count filament, or by the flow of a pump, it goes
onto whatever lies below, as a bead whose width follows from that volume and the gap below the nozzle. Otherwise a bead
of the tool's own size is laid while an M-code has switched the tool on: its volume is section times length, whatever
the pump could deliver, and where material is already in the way the bead loses that part. No force.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import norms
from gcodesim.arithmetic.scalars import tan
from gcodesim.frozen import frozen
from gcodesim.processes.column import ADDED, ENGAGED, FINDINGS, RESULTS, Column, Shown
from gcodesim.processes.protocol import Process
from gcodesim.processes.signal import ACTIVE, BEAD_HEIGHT, BEAD_WIDTH, FLOW, Signal
from gcodesim.processes.window import ProcessState, ProcessStep, Window, sums_by_step
from gcodesim.tools.extruder import Extruder, RayCone

if TYPE_CHECKING:
    from gcodesim.diagnostics import Diagnostic
    from gcodesim.material.stock import Stock
    from gcodesim.processes.materials import Material
    from gcodesim.processes.rows import Rows

Array = NDArray[np.float64]

DRAWN = 0
"""Place in the state of a nozzle with rays: how many rays there were so far."""


@frozen(slots=False, eq=False)
class Extrusion(Process):
    """The printing process of one extruder: adds its bead to the stock on feed moves.

    It lays its bead wherever it gives material, so its zone is everywhere. It exerts no force, so the machine does not
    yield and a whole window can be laid at once.
    """

    kind: ClassVar[str] = "extrusion"
    lays: ClassVar[bool] = True
    together: ClassVar[bool] = True
    told_by_words: ClassVar[tuple[str, ...]] = ("GS539", "GS542")
    reads: ClassVar[tuple[Signal, ...]] = (ACTIVE, BEAD_WIDTH, BEAD_HEIGHT, FLOW)
    writes: ClassVar[tuple[Column, ...]] = (
        ADDED,
        ENGAGED,
        Column("nominal", "m^3", "sum", Shown.NOWHERE, "volume that it meant to add"),
        Column("extruded", "m^3", "sum", RESULTS, "volume that left the nozzle and was meant to be laid"),
        Column("beside", "m^3", "sum", RESULTS, "extruded beside the stock, where it is not kept"),
        Column("swollen", "m^3", "sum", RESULTS, "found no room below the nozzle and stands above it"),
        Column("blobs", "m^3", "sum", RESULTS, "laid while the nozzle stands"),
        Column("fallen", "m^3", "sum", RESULTS, "came out while the nozzle stands with nothing below, and is not kept"),
        Column("unsupported", "m", "sum", RESULTS, "laid where nothing is below"),
        Column("laid_length", "m", "sum", RESULTS, "way on which a bead was laid"),
        Column("meant", "m^3", "sum", RESULTS, "volume of beads of the width and height that are named"),
        Column("crowded_out", "m^3", "sum", RESULTS, "of that, of beads of the tool's own size that met material"),
        Column("built", "m", "greatest", FINDINGS, "height of the beads of a paste on the first of them"),
    )

    extruder: Extruder

    @classmethod
    def of(cls, tool: Extruder, material: Material | None) -> Extrusion:
        """The process of an extruder; the material it lays has no cutting constants."""
        return cls(extruder=tool)

    @classmethod
    def is_on(cls, signals: Mapping[str, NDArray[Any]], tool: Extruder) -> NDArray[np.bool_]:
        return (signals[ACTIVE.name] > 0.0) & ~(signals[FLOW.name] <= 0.0)

    @classmethod
    def needs(cls, tool: Extruder) -> tuple[Signal, ...]:
        return (FLOW,)

    @property
    def swept(self) -> Array | None:
        half, height = 0.5 * self.extruder.bead_width, self.extruder.bead_height
        return np.array([[-half, -height], [half, -height], [half, 0.0], [-half, 0.0]])

    def begin(self) -> ProcessState:
        from gcodesim.material.strand import CARRY

        if self.extruder.rays is not None:
            return ProcessState(values=np.zeros(1))
        return ProcessState(values=np.full(CARRY + 1, np.inf))  # the last is the level on which a paste was begun

    def run(self, stock: Stock | None, window: Window, state: ProcessState) -> ProcessStep:
        """Add to `stock` (in place) what goes through the nozzle along the pieces of `window`."""
        volume = self._given(window)
        if self.extruder.rays is not None:
            return self._by_rays(stock, window, volume, self.extruder.rays, state)
        if volume is not None:
            return self._by_volume(stock, window, volume, state)
        n = window.steps
        laid = window.signals[ACTIVE.name][window.piece_step] > 0.0
        way = norms(window.piece_end - window.piece_start)
        lengths = way * laid
        nominal = sums_by_step(window.piece_step, self.extruder.bead_area * lengths, n)
        columns = {"nominal": nominal, "engaged": nominal > 0.0}
        if stock is not None and laid.any():
            from gcodesim.material.strand import carried

            start, end = window.piece_start[laid], window.piece_end[laid]
            step, length = window.piece_step[laid], way[laid]
            width, height = self.extruder.bead_width, self.extruder.bead_height
            found = stock.add_bead(start, end, width, height)
            hanging = length * (1.0 - carried(stock, start, end, width, height))
            missing = found.nominal - found.volume
            beside = np.where(_off_grid(stock, start, end, width), missing, 0.0)
            columns |= {
                "added": sums_by_step(step, found.volume, n),
                "beside": sums_by_step(step, beside, n),
                "meant": nominal,
                "crowded_out": sums_by_step(step, missing - beside, n),
                "unsupported": sums_by_step(step, hanging, n),
                "laid_length": sums_by_step(step, length, n),
                "built": self._built(end, step, n, state),
            }
        return ProcessStep.free(n, columns)

    def _given(self, window: Window) -> Array | None:
        """The volume (c,) [m³] that goes through the nozzle along each piece; None where nothing says how much."""
        if window.filament is not None:
            return window.filament * self.extruder.filament_area
        own = np.nan if self.extruder.flow is None else self.extruder.flow
        flow = np.where(np.isnan(window.signals[FLOW.name]), own, window.signals[FLOW.name])
        if np.isnan(flow).all():
            return None
        on = (window.signals[ACTIVE.name] > 0.0) & (flow > 0.0)
        share = 1.0 if window.piece_share is None else np.diff(window.piece_share, axis=1)[:, 0]
        volume: Array = np.where(on, flow, 0.0)[window.piece_step] * share * window.dt
        return volume

    def _by_volume(self, stock: Stock | None, window: Window, volume: Array, state: ProcessState) -> ProcessStep:
        """The volume (c,) of each piece, wherever it finds room."""
        n = window.steps
        some = np.flatnonzero(volume > 0.0)
        if stock is None or not len(some):
            return ProcessStep.free(n)
        from gcodesim.material.strand import FilamentStrand, lay_strand

        extruder, step = self.extruder, window.piece_step[some]
        volume = volume[some]
        width, height = window.signals[BEAD_WIDTH.name][step], window.signals[BEAD_HEIGHT.name][step]
        height = np.where(height > 0.0, height, extruder.bead_height)
        width = np.maximum(np.where(width > 0.0, width, extruder.bead_width), height)
        start, end = window.piece_start[some], window.piece_end[some]
        strand = FilamentStrand(start, end, volume, width, height)
        found, rests = lay_strand(stock, strand, state.values), strand.at_rest
        length = np.where(rests, 0.0, norms(end - start))
        asked = ((width - height) * height + 0.25 * np.pi * (height * height)) * length
        columns = {
            "added": found.volume,
            "nominal": volume,
            "extruded": volume,
            "beside": np.where(rests, 0.0, found.beside),
            "swollen": np.where(rests, 0.0, found.above),
            "blobs": np.where(rests, found.volume, 0.0),
            "fallen": np.where(rests, found.beside, 0.0),
            "unsupported": length * (1.0 - found.support),
            "laid_length": length,
            "meant": asked,
        }
        sums = {name: sums_by_step(step, values, n) for name, values in columns.items()}
        sums["built"] = self._built(end, step, n, state)
        return ProcessStep.free(n, {**sums, "engaged": sums["laid_length"] > 0.0})

    def _built(self, ends: Array, step: NDArray[np.int64], n: int, state: ProcessState) -> Array:
        """How high (n,) [m] the beads stand that end at `ends` (c, 3), of a paste; 0 of what sets at once."""
        built = np.zeros(n)
        if self.extruder.paste is not None:
            state.values[-1] = min(state.values[-1], float(ends[:, 2].min()) - self.extruder.bead_height)
            np.maximum.at(built, step, ends[:, 2] - state.values[-1])
        return built

    def _by_rays(
        self, stock: Stock | None, window: Window, volume: Array | None, rays: RayCone, state: ProcessState
    ) -> ProcessStep:
        """Particles along the rays of a cone; `volume` (c,) of each piece, else that of the tool's bead."""
        n = window.steps
        way = norms(window.piece_end - window.piece_start)
        if volume is None:
            volume = self.extruder.bead_area * way * (window.signals[ACTIVE.name][window.piece_step] > 0.0)
        some = np.flatnonzero(volume > 0.0)
        if stock is None or not len(some):
            return ProcessStep.free(n)
        from gcodesim.material.rain import NozzleRays, rain_on

        step = window.piece_step[some]
        cone = NozzleRays(spread=tan(0.5 * rays.angle), far=rays.distance, number=rays.number, seed=rays.seed)
        start, end, axis = window.piece_start[some], window.piece_end[some], window.axis[step]
        thrown = state.values[DRAWN]
        fallen = rain_on(stock, cone, start, end, axis, volume[some], int(thrown))
        state.values[DRAWN] = thrown + len(some) * rays.number
        columns = {
            "added": fallen.volume,
            "nominal": volume[some],
            "extruded": volume[some],
            "beside": volume[some] - fallen.volume,
        }
        sums = {name: sums_by_step(step, values, n) for name, values in columns.items()}
        return ProcessStep.free(n, {**sums, "engaged": sums["extruded"] > 0.0})

    @classmethod
    def findings(cls, rows: Rows) -> Iterable[Diagnostic]:
        """GS520 to GS524: beads in the air, of another size than flow allows, beside the stock, or without room.

        GS519: blobs. GS528 and GS529: pastes that do not stand.
        """
        from gcodesim.processes.printing import paste_findings, printing_findings

        yield from printing_findings(rows)
        yield from paste_findings(rows)


def _off_grid(stock: Stock, starts: Array, ends: Array, width: float) -> NDArray[np.bool_]:
    """Whether a bead of `width` [m] hangs over the border of the columns, in the middle (c,) of each piece."""
    middle = 0.5 * (starts + ends)[:, :2]
    low, high = stock.bounds
    off: NDArray[np.bool_] = np.any((middle - 0.5 * width < low[:2]) | (middle + 0.5 * width > high[:2]), axis=1)
    return off
