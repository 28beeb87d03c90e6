"""After a run: the stock against the target of the cell, and the lines that made what is out of tolerance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.checks.clearance import place_in_system
from gcodesim.checks.target import loose_finding, target_findings
from gcodesim.diagnostics import Diagnostic, Span
from gcodesim.frames import Array, Pose
from gcodesim.frozen import frozen
from gcodesim.jobs.operations import operations_of
from gcodesim.jobs.skins import slack_of
from gcodesim.jobs.target_result import MOST_REGIONS, LooseResult, MakerLine, RegionResult, TargetResult
from gcodesim.motion.tool_path import HOME, RAPID
from gcodesim.solids.mesh_file import MeshError
from gcodesim.tools.cutter import Cutter
from gcodesim.units import MM

if TYPE_CHECKING:
    from gcodesim.cell.stock import Target
    from gcodesim.executor import Execution
    from gcodesim.jobs.job import Job
    from gcodesim.material.deviation import Deviation, Misfit
    from gcodesim.material.passes import Makers, Passes
    from gcodesim.material.scallops import Work
    from gcodesim.motion.tool_path import ToolPath
    from gcodesim.shop import PlacedStock, Shop

AS_DEEP: Final = 0.9
"""Faces with this share of the greatest depth count as the deepest: the first line that made one is to blame."""

SURELY: Final = 0.7
"""Share of a depth to which the target surely reaches out around its place: depths may be taken along columns."""

PLACES: Final = 9
"""Faces of a gouge at which further lines are looked for."""

AS_GREAT: Final = 0.5
"""Lines that left this share of what the line with the most has left count as well: the first is to blame."""

EXACT: Final = 0.05
"""Share of the slack within which a face is looked for first: most are exactly where a tool has been."""

MOST_LINES: Final = 20
"""Lines of a region in the results."""


def verify(job: Job, execution: Execution) -> tuple[TargetResult | None, list[Diagnostic]]:
    """Compare what a finished run left with the target of its cell; findings GS441 to GS444."""
    cell, shop = job.cell, job.shop
    if cell is None or shop is None or cell.target is None or shop.placement.target is None:
        return None, []
    span = cell.span("target")
    if execution.interrupted or any(each.stopped_at is not None for each in job.all):
        return None, [_not_compared(span, "the program did not run to its end")]
    if not shop.stocks:
        return None, [_not_compared(span, "the cell has no stock")]
    assert cell.target.shape is not None
    try:
        mesh = cell.target.shape.solid.triangles
    except MeshError as fault:
        return None, [_not_compared(span, str(fault))]
    placed, vertices = _stock_of(shop, shop.placement.target, mesh.points)
    if placed is None:
        return None, [_not_compared(span, "the target and the stock have no place in common")]
    from gcodesim.jobs.skins import painted
    from gcodesim.material.deviation import compare
    from gcodesim.material.mesh import OpenMeshError
    from gcodesim.material.scallops import scallops_of

    try:
        deviation = compare(placed.stock, vertices, mesh.faces, cell.target.tolerance)
    except OpenMeshError:
        name = cell.target.shape.name
        return None, [_not_compared(span, f"the mesh `{name}` is not closed, so nobody knows what is inside of it")]
    passes = execution.passes[placed.name]
    result = _Blame(job, placed, passes).result(cell.target, deviation)
    tolerance = cell.target.tolerance
    regions = _told(deviation)
    skin, makers = painted(job, placed, passes, (vertices, mesh.faces), tolerance, regions)
    job.skins[placed.name] = skin
    result = replace(result, scallops=list(scallops_of(skin, *_works(job, makers), passes)))
    program = Span(job.program.name)
    totals = {True: (result.gouges, result.gouge), False: (result.excesses, result.excess)}
    found = list(target_findings(result.regions, totals, result.tolerance, program))
    found += loose_finding([(each.volume, each.system, each.at) for each in result.loose], program)
    if deviation.overhang > cell.target.tolerance:
        how = f"the target stands {deviation.overhang / MM:.3g} mm out of the stock `{placed.name}`"
        hint = "what is out there is not compared; look at `zero` and `in` of both, and at the unit of the mesh"
        found.append(Diagnostic(code="GS444", span=span, message=how, hint=hint))
    return result, found


def _works(job: Job, makers: Makers) -> tuple[NDArray[np.int64], list[Work]]:
    """For each face the number of the work that made it, or -1; and the works that leave ridges, in order."""
    from gcodesim.material.scallops import Work

    assert job.cell is not None
    made = np.full(len(makers.row), -1, dtype=np.int64)
    works: list[Work] = []
    names = {number: tool.name for number, tool in job.cell.tools.items()}
    for number, each in enumerate(job.all):
        assert each.plan is not None
        path = each.plan.path
        faces = np.flatnonzero((makers.program == number) & (makers.row >= 0))
        rows = makers.row[faces]
        operations = operations_of(path, each.program.name, each.program.table)
        for operation in np.unique(operations.number[rows]).tolist():
            own = operations.number[rows] == operation
            row = int(rows[own][0])
            tool = int(path.state_of(row).tool)
            cutter = job.cell.tools.get(tool)
            if isinstance(cutter, Cutter) and cutter.leaves_ridges:
                made[faces[own]] = len(works)
                works.append(Work(tool, operations.name_of(row, names, tool), cutter.radius))
    return made, works


def _told(deviation: Deviation) -> list[Misfit]:
    """The regions that stand in the results: gouges, then excess, the greatest volumes of each."""
    told: list[Misfit] = []
    for side in (True, False):
        told += [region for region in deviation.regions if region.gouge is side][: MOST_REGIONS // 2]
    return told


def _not_compared(span: Span, why: str) -> Diagnostic:
    return Diagnostic(
        code="GS444",
        span=span,
        message=f"the part is not compared with its target: {why}",
        hint="mend this, then run again",
    )


def _stock_of(shop: Shop, X_WT: Pose, points: Array) -> tuple[PlacedStock | None, Array]:
    """The stock that shares most room with the target, and the points (v, 3) of the target in its frame."""
    best, most, seen = None, 0.0, points
    for placed in shop.stocks.values():
        own = (placed.X_WS.inverse() @ X_WT).apply(points)
        low, high = placed.stock.bounds
        shared = np.minimum(high, own.max(axis=0)) - np.maximum(low, own.min(axis=0))
        room = float(np.prod(np.maximum(shared, 0.0)))
        if room > most:
            best, most, seen = placed, room, own
    return best, seen


@frozen(eq=False)
class _Guilty:
    """A path row of the program with a number, the gap [m] if it only came near, and lines with their shares."""

    row: int
    program: int
    gap: float | None
    lines: Sequence[MakerLine]


class _Blame:
    """Finds the lines behind regions, and says where these are."""

    def __init__(self, job: Job, placed: PlacedStock, passes: Passes) -> None:
        assert job.shop is not None
        assert job.cell is not None and job.cell.target is not None
        self._job, self._placed, self._passes = job, placed, passes
        self._tolerance = job.cell.target.tolerance
        self._paths = [self._path_of(each) for each in job.all]
        self._feeds = [(path.kind != RAPID) & (path.kind != HOME) for path in self._paths]
        self._slack = slack_of(placed.stock.cell)
        self._X_MS = job.shop.placement.X_WM.inverse() @ placed.X_WS

    def result(self, target: Target, deviation: Deviation) -> TargetResult:
        assert target.shape is not None
        sums = {side: [r.volume for r in deviation.regions if r.gouge is side] for side in (True, False)}
        return TargetResult(
            stock=self._placed.name,
            mesh=target.shape.name,
            tolerance=target.tolerance,
            least=deviation.least,
            most=deviation.most,
            area=deviation.area,
            area_outside=deviation.area_outside,
            gouge=float(sum(sums[True])),
            excess=float(sum(sums[False])),
            gouges=len(sums[True]),
            excesses=len(sums[False]),
            regions=[self._region(region) for region in _told(deviation)],
            loose=[self._loose(part.volume, part.at) for part in deviation.loose[:MOST_REGIONS]],
        )

    def _region(self, region: Misfit) -> RegionResult:
        guilty = self._guilty(region)
        program = 0 if guilty is None else guilty.program
        row = -1 if guilty is None else guilty.row
        system, at = self._place(region.at, program, row)
        corners = np.array([self._place(point, program, row)[1] for point in (region.low, region.high)])
        path, plan = self._paths[program], self._job.all[program].plan
        assert plan is not None
        return RegionResult(
            gouge=region.gouge,
            volume=region.volume,
            area=region.area,
            depth=region.depth,
            system=system,
            at=at,
            low=_triple(corners.min(axis=0)),
            high=_triple(corners.max(axis=0)),
            lines=() if guilty is None else guilty.lines,
            guilty=None if guilty is None else path.span(row),
            tool=None if guilty is None else path.states[path.state[row]].tool,
            gap=None if guilty is None else guilty.gap,
            time=None if guilty is None else float(plan.trajectory.row_start[row]),
            others=self._others(region, guilty),
        )

    def _loose(self, volume: float, at: Array) -> LooseResult:
        system, place = self._place(at, 0, -1)
        return LooseResult(volume=volume, system=system, at=place)

    def _guilty(self, region: Misfit) -> _Guilty | None:
        makers = self._makers(region.faces)
        made = makers.gap <= self._slack
        if made.any():
            deep = made & (region.depths >= AS_DEEP * region.depths[made].max())
            if not region.gouge:
                deep = self._greatest(makers, deep, region.volumes)
            row, program, _ = self._first(makers, np.flatnonzero(deep))
            return _Guilty(row=row, program=program, gap=None, lines=self._lines(makers, made, region.volumes))
        if region.gouge:
            return None
        worst = region.faces[[int(np.argmax(region.depths))]]
        near = self._passes.makers(worst, self._slack, self._feeds)
        if near.row[0] < 0:
            return None
        return _Guilty(row=int(near.row[0]), program=int(near.program[0]), gap=max(float(near.gap[0]), 0.0), lines=())

    def _others(self, region: Misfit, guilty: _Guilty | None) -> tuple[Span, ...]:
        """Further lines than those that made its faces that go through a gouge, looked for at some of these.

        All that is nearer to a face than the skin of the target belongs to the target: what comes so near cuts into it.
        """
        if guilty is None or not region.gouge:
            return ()
        lines: dict[tuple[str, int], Span] = {}
        for face in np.linspace(0, len(region.faces) - 1, min(PLACES, len(region.faces))).astype(np.int64).tolist():
            reach = SURELY * float(region.depths[face]) - self._tolerance
            for program, row in self._passes.through(region.faces[face], reach) if reach > 0.0 else ():
                span = self._paths[program].span(row)
                lines.setdefault((span.file, span.line), span)
        for told in (self._paths[guilty.program].span(guilty.row), *(line.span for line in guilty.lines)):
            lines.pop((told.file, told.line), None)
        return tuple(lines[key] for key in sorted(lines))[:MOST_LINES]

    def _makers(self, faces: Array) -> Makers:
        """The first pass that made each face; one that is exactly there before one beside it, such as at a wall."""
        near = self._passes.makers(faces, self._slack, within=True)
        exact = self._passes.makers(faces, EXACT * self._slack, within=True)
        for known, found in zip((near.row, near.program, near.gap), (exact.row, exact.program, exact.gap), strict=True):
            known[exact.row >= 0] = found[exact.row >= 0]
        return near

    @staticmethod
    def _greatest(makers: Makers, deep: NDArray[np.bool_], volumes: Array) -> NDArray[np.bool_]:
        """Those of some faces whose row has left most standing, or nearly: lines beside it made walls of it at most."""
        faces = np.flatnonzero(deep)
        rows, which = np.unique(np.stack([makers.program, makers.row])[:, faces], axis=1, return_inverse=True)
        left = np.bincount(which.ravel(), weights=volumes[faces], minlength=rows.shape[1])
        great = np.zeros_like(deep)
        great[faces[left[which.ravel()] >= AS_GREAT * left.max()]] = True
        return great

    def _first(self, makers: Makers, among: NDArray[np.intp]) -> tuple[int, int, float]:
        """Row and program of the earliest pass among those of some faces."""
        times = []
        for face in among.tolist():
            program, row = int(makers.program[face]), int(makers.row[face])
            plan = self._job.all[program].plan
            assert plan is not None
            times.append((float(plan.trajectory.row_start[row]), program, row))
        time, program, row = min(times)
        return row, program, time

    def _lines(self, makers: Makers, made: NDArray[np.bool_], volumes: Array) -> list[MakerLine]:
        shares: dict[tuple[int, str, int, int], list[Any]] = {}
        for face in np.flatnonzero(made).tolist():
            program, row = int(makers.program[face]), int(makers.row[face])
            path = self._paths[program]
            span, tool = path.span(row), path.states[path.state[row]].tool
            entry = shares.setdefault((program, span.file, span.line, tool), [span, 0.0])
            entry[1] += float(volumes[face])
        whole = sum(entry[1] for entry in shares.values())
        ordered = sorted(shares.items(), key=lambda item: (-item[1][1], item[0]))
        return [
            MakerLine(span=span, tool=tool, share=volume / whole if whole > 0.0 else 1.0)
            for (_, _, _, tool), (span, volume) in ordered[:MOST_LINES]
        ]

    def _place(self, point: Array, program: int, row: int) -> tuple[str, tuple[float, float, float]]:
        """A point of S in the work system of a path row, as the program would write it [m]."""
        path = self._paths[program]
        state = path.states[path.state[row]] if len(path) else path.states[0]
        system, at = place_in_system(self._X_MS.apply(point[None])[0], state)
        return system, _triple(at)

    @staticmethod
    def _path_of(job: Job) -> ToolPath:
        assert job.plan is not None
        return job.plan.path


def _triple(point: Array) -> tuple[float, float, float]:
    x, y, z = (float(value) for value in point)
    return x, y, z
