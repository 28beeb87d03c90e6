"""The finished part against its target: what is too much, what is missing, and which line is to blame."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Protocol

from gcodesim.diagnostics import Diagnostic, Span
from gcodesim.units import MM, MM2, MM3

Point = tuple[float, float, float]

MOST_TOLD = 20
"""Findings of each kind; one more tells of all the others."""

_MOST_LINES = 6

_LEAST_SHARE = 0.02
"""Lines with less of a place are only in the results."""


class ToldLine(Protocol):
    """A line that made faces of a region."""

    @property
    def span(self) -> Span: ...
    @property
    def share(self) -> float: ...


class ToldRegion(Protocol):
    """A place out of tolerance; see `jobs.target_result.RegionResult`."""

    @property
    def gouge(self) -> bool: ...
    @property
    def volume(self) -> float: ...
    @property
    def area(self) -> float: ...
    @property
    def depth(self) -> float: ...
    @property
    def system(self) -> str: ...
    @property
    def at(self) -> Point: ...
    @property
    def lines(self) -> Sequence[ToldLine]: ...
    @property
    def guilty(self) -> Span | None: ...
    @property
    def tool(self) -> int | None: ...
    @property
    def gap(self) -> float | None: ...
    @property
    def time(self) -> float | None: ...
    @property
    def others(self) -> Sequence[Span]: ...


def target_findings(
    regions: Sequence[ToldRegion], totals: dict[bool, tuple[int, float]], tolerance: float, program: Span
) -> Iterator[Diagnostic]:
    """GS441 for each gouge and GS442 for each place where too much is left, the greatest volumes first.

    `totals`: number and volume [m³] of all gouges (True) and of all excess (False); `program` is the place of a finding
    that no line is to blame for.
    """
    for gouge in (True, False):
        own = [region for region in regions if region.gouge is gouge][:MOST_TOLD]
        for region in own:
            yield _finding(region, tolerance, program)
        count, volume = totals[gouge]
        left = count - len(own)
        if left > 0:
            less = volume - sum(region.volume for region in own)
            what = "gouges" if gouge else "places where material is left standing"
            yield Diagnostic(
                code="GS441" if gouge else "GS442",
                span=program,
                message=f"{left} smaller {what} beyond {tolerance / MM:g} mm, {less / MM3:.4g} mm³ together",
                hint="`results.json` has up to 100 of them, with their lines",
            )


def _finding(region: ToldRegion, tolerance: float, program: Span) -> Diagnostic:
    x, y, z = (f"{value / MM + 0.0:.6g}" for value in (round(c, 6) for c in region.at))
    size = f"{region.volume / MM3:.4g} mm³ on {region.area / MM2:.4g} mm²"
    place = f"X{x} Y{y} Z{z} ({region.system})"
    deep = f"{region.depth / MM:.3f} mm"
    if region.gouge:
        message = f"gouge, {deep} deep at {place}: {size} of the target are missing; {_blame(region)}{_others(region)}"
        hint = "compare the end of this line with the drawing, then tool and offsets"
        if region.guilty is None:
            hint = "is the stock as large as the target, and does it stand where the target does?"
    else:
        message = f"excess, {deep} above the target at {place}: {size} are left standing; {_blame(region)}"
        hint = "is an operation, a pass or a corner missing, or the tool too large for it?"
    return Diagnostic(
        code="GS441" if region.gouge else "GS442",
        span=region.guilty or program,
        message=message,
        hint=hint,
        time=region.time,
        value=region.depth,
        limit=tolerance,
        unit="m",
    )


def _blame(region: ToldRegion) -> str:
    """Who made it, in words."""
    if region.guilty is None:
        return "no line took it" if region.gouge else "no line comes near"
    tool = f"T{region.tool}"
    if region.gap is not None:
        return f"no line made this face, {tool} came nearest, {region.gap / MM:.3g} mm away"
    told = (line.span for line in region.lines if line.share >= _LEAST_SHARE)
    numbers = sorted({span.line for span in told if span.file == region.guilty.file})
    if len(numbers) < 2:
        return f"by {tool}"
    if len(numbers) > _MOST_LINES:
        return f"by {tool} and others in {len(numbers)} lines from {numbers[0]} to {numbers[-1]}"
    return f"by {tool} in lines {', '.join(map(str, numbers))}"


def _others(region: ToldRegion) -> str:
    """Who would gouge there without the line that is to blame, in words."""
    numbers = sorted({span.line for span in region.others})
    if not numbers:
        return ""
    some = ", ".join(map(str, numbers[:_MOST_LINES])) + (", …" if len(numbers) > _MOST_LINES else "")
    return f"; line {some} goes there as well" if len(numbers) == 1 else f"; lines {some} go there as well"


def loose_finding(loose: Sequence[tuple[float, str, Point]], program: Span) -> Iterator[Diagnostic]:
    """GS443: bodies of the stock that are apart from the part; volume [m³], work system and a point [m] of each."""
    if not loose:
        return
    volume, system, at = loose[0]
    x, y, z = (f"{value / MM + 0.0:.6g}" for value in (round(c, 6) for c in at))
    many = len(loose) > 1
    whole = f", {sum(each[0] for each in loose) / MM3:.4g} mm³ together" if many else ""
    yield Diagnostic(
        code="GS443",
        span=program,
        message=f"{len(loose)} loose {'pieces lie' if many else 'piece lies'} beside the part{whole}: "
        f"{'the greatest' if many else 'it'} has {volume / MM3:.4g} mm³, at X{x} Y{y} Z{z} ({system})",
        hint="they are not compared with the target; on the machine they are cut free: hold them, or leave tabs",
    )
