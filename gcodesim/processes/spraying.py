"""Spraying: a gun lays a film on the faces of bodies in its cone. No force."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import norms
from gcodesim.frozen import frozen
from gcodesim.processes.column import ENGAGED, FINDINGS, LINES, LOG, RESULTS, Column
from gcodesim.processes.protocol import ActsOn, Process
from gcodesim.processes.signal import FLOW, SPRAY, Signal
from gcodesim.processes.window import ProcessState, ProcessStep, Window
from gcodesim.tools.spray_gun import SprayGun

if TYPE_CHECKING:
    from gcodesim.diagnostics import Diagnostic
    from gcodesim.material.film import Dabs, Pattern
    from gcodesim.processes.materials import Material
    from gcodesim.processes.protocol import CoatedSkin
    from gcodesim.processes.rows import Rows

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

STRIDE: Final = 0.25
"""How far the gun goes in one dab, in half widths of its spot: half a standard deviation of a Gaussian."""


@frozen(slots=False, eq=False)
class Spraying(Process):
    """The spraying of one gun onto one body.

    While the gun is on, what it sprays is counted wherever it points, so its zone is everywhere; `sprayed` and `solids`
    are those of the gun, however many bodies there are. What does not meet a body that is coated is overspray.
    """

    kind: ClassVar[str] = "spraying"
    acts_on: ClassVar[ActsOn] = "surface"
    told_by_words: ClassVar[tuple[str, ...]] = ("GS539", "GS542")
    reads: ClassVar[tuple[Signal, ...]] = (SPRAY, FLOW)
    writes: ClassVar[tuple[Column, ...]] = (
        ENGAGED,
        Column("sprayed", "m^3", shown_in=LOG | LINES | RESULTS, says="that left the gun", together="greatest"),
        Column("solids", "m^3", shown_in=RESULTS, says="in it, which stay when it is dry", together="greatest"),
        Column("met", "m^3", shown_in=RESULTS, says="of these that met a surface to be coated"),
        Column("film", "m^3", shown_in=LOG | LINES | RESULTS, says="of these that stayed there"),
        Column("without_flow", of="any", shown_in=FINDINGS, says="the gun is on and nothing flows"),
        Column("near_film", "m^3", shown_in=FINDINGS, says="film laid from too near"),
        Column("near_way", "m^4", shown_in=FINDINGS, says="the same times its distance"),
        Column("far_film", "m^3", shown_in=FINDINGS, says="film laid from too far"),
        Column("far_way", "m^4", shown_in=FINDINGS, says="the same times its distance"),
    )

    gun: SprayGun
    pattern: Pattern

    @classmethod
    def of(cls, tool: SprayGun, material: Material | None) -> Spraying:
        """What lies below the paint does not matter."""
        from gcodesim.processes.spray_pattern import pattern_of

        return cls(gun=tool, pattern=pattern_of(tool))

    @classmethod
    def is_on(cls, signals: Mapping[str, NDArray[Any]], tool: SprayGun) -> NDArray[np.bool_]:
        trigger, flow = signals[SPRAY.name], signals[FLOW.name]
        return np.where(np.isnan(trigger), flow > 0.0, trigger > 0.0)

    def run(self, skin: CoatedSkin, window: Window, state: ProcessState) -> ProcessStep:
        """Lay the film of all steps in which the gun is on."""
        n = window.steps
        trigger, given = window.signals[SPRAY.name], window.signals[FLOW.name]
        on = np.where(np.isnan(trigger), given > 0.0, trigger > 0.0)  # a flow that was never given is not above zero
        if not on.any():
            return ProcessStep.free(n)
        flow = np.where(np.isnan(given), self.gun.flow, np.maximum(given, 0.0))
        liquid = np.where(on, flow * window.dt, 0.0)
        solids = self.gun.solids * liquid
        columns = {"engaged": on, "sprayed": liquid, "solids": solids, "without_flow": on & (liquid <= 0.0)}
        wet = np.flatnonzero(liquid > 0.0)
        coating = skin.coating
        if len(wet) and coating is not None and len(window.piece_step):
            step, dabs = self._dabs(skin, window, wet, liquid)
            told = coating.lay(self.pattern, dabs, skin.shades)
            sums = np.zeros((n, told.shape[1]))
            np.add.at(sums, step, told)
            shares = np.zeros(n)
            np.add.at(shares, step, told[:, 0] * dabs.solids)
            names = ("film", "near_film", "near_way", "far_film", "far_way")
            columns |= {name: sums[:, 1 + k] for k, name in enumerate(names)} | {"met": shares}
        elif coating is None:  # GS537 says why nobody knows what it meets
            columns["met"] = solids
        return ProcessStep.free(n, columns)

    def _dabs(self, skin: CoatedSkin, window: Window, wet: Ints, liquid: Array) -> tuple[Ints, Dabs]:
        """The steps `wet` (w,) in dabs: the step of each, and where the gun is in its middle."""
        from gcodesim.material.film import Dabs
        from gcodesim.processes.spray_pattern import narrowest

        assert window.side is not None and window.where is not None
        last = len(window.piece_step) - 1
        first = np.minimum(np.searchsorted(window.piece_step, wet, side="left"), last)
        final = np.maximum(np.searchsorted(window.piece_step, wet, side="right") - 1, 0)
        start = np.where((final < first)[:, None], window.piece_end[final], window.piece_start[first])
        way = window.piece_end[final] - start  # none where the tool rests
        stride = STRIDE * narrowest(self.pattern, self.gun.distance)
        parts = np.maximum(np.ceil(norms(way) / stride), 1.0).astype(np.int64)
        at = np.repeat(np.arange(len(wet)), parts)
        begin = np.cumsum(parts) - parts
        share = (np.arange(len(at)) - begin[at] + 0.5) / parts[at]
        step = wet[at]
        before = window.axis if window.axis_before is None else window.axis_before
        axis = -(before[step] + share[:, None] * (window.axis[step] - before[step]))
        each = 1.0 / parts[at]
        return step, Dabs(
            place=start[at] + share[:, None] * way[at],
            axis=np.ascontiguousarray(axis / norms(axis)[:, None]),
            side=np.ascontiguousarray(window.side[step]),
            solids=self.gun.solids * liquid[step] * each,
            liquid=liquid[step] * each,
            down=np.ascontiguousarray(-window.where("world")[step, :3, 2]),
            poses=_poses(skin, window, step),
        )

    @classmethod
    def findings(cls, rows: Rows) -> Iterable[Diagnostic]:
        """GS533 to GS535: spray on nothing, from too near or too far, a gun that is on without flow."""
        from gcodesim.processes.spray_misuse import spray_findings

        return spray_findings(rows)


def _poses(skin: CoatedSkin, window: Window, step: Ints) -> Array:
    """X_SF (k, b, 3, 4) of the frames of all bodies that may shade, in the steps (k,)."""
    assert window.where is not None
    poses: Array = np.empty((len(step), len(skin.shade_frames), 3, 4))
    for b, frame in enumerate(skin.shade_frames):
        poses[:, b] = window.where(frame)[step, :3]
    return poses
