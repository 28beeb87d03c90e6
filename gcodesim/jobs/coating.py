"""What a coat came to: film on each body, where the paint went, and what is wrong with it."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.diagnostics import Diagnostic
from gcodesim.frames import Array
from gcodesim.numbers import rounded
from gcodesim.tools.spray_gun import SprayGun
from gcodesim.units import MM, MM3, UM

if TYPE_CHECKING:
    from gcodesim.cell.film import FilmSpec
    from gcodesim.executor.totals import RowTotals
    from gcodesim.material.film import BodyFilm
    from gcodesim.scene.coated import Coated
    from gcodesim.shop import Shop

Flags = NDArray[np.bool_]

_MM2: Final = MM * MM


def coating_of(shop: Shop, totals: Sequence[RowTotals]) -> dict[str, Any] | None:
    """The part `coating` of the results, None of a run in which no gun sprayed; `totals` are those of all channels.

    All volumes but the first are of solids: what was sprayed is on bodies, bounced off them, or went past.
    """
    if not any("sprayed" in each.columns for each in totals):
        return None

    def whole(name: str) -> float:
        return sum(float(each[name].sum()) for each in totals if name in each.columns)

    solids, met = whole("solids"), whole("met")
    if not solids > 0.0:
        return None
    bodies = {film_name(each, shop): _body(each, _spec(shop, each)) for each in shop.coated.values() if each.film}
    film = sum(each.film.volume for each in shop.coated.values() if each.film is not None)
    return {
        "sprayed_mm3": rounded(whole("sprayed") / MM3),
        "solids_mm3": rounded(solids / MM3),
        "film_mm3": rounded(film / MM3),
        "bounced_mm3": rounded((met - film) / MM3),
        "overspray_mm3": rounded((solids - met) / MM3),
        "transfer_share": rounded(film / solids),
        "overspray_share": rounded((solids - met) / solids),
        "bodies": bodies,
    }


def _body(coated: Coated, spec: FilmSpec) -> dict[str, Any]:
    film = coated.film
    assert film is not None
    counts = counting(coated, film, spec)
    dry, area = film.coat.dry, film.coat.area
    figures = film.figures(counts)

    def over(flags: Flags) -> float:
        return rounded(float(area[counts & flags].sum()) / _MM2)

    thickness = (None, None, None) if figures is None else (figures.least, figures.mean, figures.most)
    whole = 0.0 if figures is None else figures.area
    bare = over(dry < spec.bare)
    return {
        "faces": len(film),
        "resolution_mm": rounded(film.size / MM),
        "volume_mm3": rounded(film.volume / MM3),
        "area_mm2": rounded(whole / _MM2),
        **{
            f"{name}_um": None if value is None else rounded(value / UM)
            for name, value in zip(("least", "mean", "most"), thickness, strict=True)
        },
        "uncovered_mm2": bare,
        "uncovered_share": rounded(bare * _MM2 / whole) if whole else 0.0,
        "below_mm2": over(dry < (spec.least or 0.0)),
        "above_mm2": over(dry > (spec.most or np.inf)),
        "runs_mm2": over(film.runs(spec.sag)) if spec.sag is not None else 0.0,
    }


def counting(coated: Coated, film: BodyFilm, spec: FilmSpec) -> Flags:
    """The faces (n,) on which the film of a body is judged."""
    counts = np.ones(len(film), dtype=np.bool_) if spec.faces == "all" else film.facing()
    if spec.inside is not None:
        at = coated.in_part(film.coat.middle)
        counts &= ((at >= np.array(spec.inside.min)) & (at <= np.array(spec.inside.max))).all(axis=1)
    return counts


def film_findings(shop: Shop) -> Iterator[Diagnostic]:
    """GS530 to GS532 and GS536 to GS538: film that is not as the cell wants it, or that could not be followed."""
    if not shop.coated and any(isinstance(tool, SprayGun) for tool in shop.cell.tools.values()):
        yield Diagnostic(
            code="GS536",
            span=shop.cell.span("tools"),
            message="a spray gun has nothing to coat in this cell",
            hint="describe the work as `stock` or under `parts`; a fixture is coated if it has the key `film`",
        )
    for coated in shop.coated.values():
        spec, film = _spec(shop, coated), coated.film
        if coated.too_fine is not None:
            yield _too_fine(shop, coated)
        if film is None:
            continue
        counts = counting(coated, film, spec)
        if coated.cut_since:
            yield Diagnostic(
                code="GS538",
                span=_span(shop, coated),
                message=f"`{coated.name}` was cut after it had been sprayed; its film is that of the surface before",
                hint="coat it after it is machined, in one program or in a run of its own (`stock: {from: DIR}`)",
            )
        dry = film.coat.dry
        if spec.least is not None:
            yield from _off_band(shop, coated, film, counts, dry < spec.least, spec.least, "below")
        if spec.most is not None:
            yield from _off_band(shop, coated, film, counts, dry > spec.most, spec.most, "above")
        if spec.sag is not None:
            yield from _runs(shop, coated, film, counts & film.runs(spec.sag), spec.sag)


def _off_band(
    shop: Shop, coated: Coated, film: BodyFilm, counts: Flags, off: Flags, limit: float, side: str
) -> Iterator[Diagnostic]:
    """GS530 or GS531 where film that counts is below or above a limit."""
    figures = film.figures(counts)
    if figures is None or not (off & counts).any():
        return
    low = side == "below"
    value, at = (figures.least, figures.least_at) if low else (figures.most, figures.most_at)
    share = float(film.coat.area[off & counts].sum()) / figures.area
    yield Diagnostic(
        code="GS530" if low else "GS531",
        span=_span(shop, coated, "least" if low else "most"),
        message=f"film {side} {limit / UM:g} µm on `{coated.name}`: {value / UM:.1f} µm at {_place(coated, at)}, "
        f"{side} on {_percent(share)} of {figures.area:.3g} m²",
        hint="bring passes nearer together, spray slower or with more flow, or go beyond the edges"
        if low
        else "spray faster, with less flow, or keep passes farther apart",
        value=value / UM,
        limit=limit / UM,
        unit="µm",
    )


def _runs(shop: Shop, coated: Coated, film: BodyFilm, runs: Flags, sag: float) -> Iterator[Diagnostic]:
    """GS532 where wet film runs."""
    if not runs.any():
        return
    wet = np.where(runs, film.coat.wet, 0.0)
    worst = int(np.argmax(wet))
    yield Diagnostic(
        code="GS532",
        span=_span(shop, coated, "sag"),
        message=f"paint runs on `{coated.name}`: {wet[worst] / UM:.0f} µm of wet film at "
        f"{_place(coated, film.coat.middle[worst])}, on {float(film.coat.area[runs].sum()) / _MM2:.4g} mm² in all",
        hint="lay it in several coats, or thinner; turn the face so that it lies flatter",
        value=float(wet[worst]) / UM,
        limit=sag / UM,
        unit="µm",
    )


def _too_fine(shop: Shop, coated: Coated) -> Diagnostic:
    from gcodesim.material.film import MOST_FACES

    assert coated.too_fine is not None
    needed = coated.too_fine.needed
    coarsest = coated.size * float(np.sqrt(needed / MOST_FACES))
    return Diagnostic(
        code="GS537",
        span=_span(shop, coated, "resolution"),
        message=f"a film on `{coated.name}` with faces of {coated.size / MM:g} mm needs about {needed} faces; "
        f"{MOST_FACES} are allowed, so nothing was laid on it",
        hint=f"`film: {{resolution: {1.2 * coarsest / MM:.2g} mm}}` would do",
        value=float(needed),
        limit=float(MOST_FACES),
    )


def _spec(shop: Shop, coated: Coated) -> FilmSpec:
    return shop.cell.coats[coated.frame]


def film_names(frames: Collection[str]) -> list[str]:
    """Names of the films on bodies by their frames: as in the cell, with the sort where two bodies have the same."""
    own = [frame.rpartition("/")[2] for frame in frames]
    return [name if own.count(name) == 1 else frame.replace("/", "_") for frame, name in zip(frames, own, strict=True)]


def film_name(coated: Coated, shop: Shop) -> str:
    """The name of the film on one body."""
    frames = [*shop.cell.coats]
    return film_names(frames)[frames.index(coated.frame)]


def _span(shop: Shop, coated: Coated, *keys: str) -> Any:
    """The place of a key of a body's `film`, or of what is around it, in the cell."""
    sort = {"stock": "stock", "part": "parts", "fixture": "fixtures"}[coated.frame.partition("/")[0]]
    cell = shop.cell
    own = (sort, coated.name) if (sort, coated.name) in cell.spans or sort != "stock" else (sort,)
    return cell.span(*own, "film", *keys)


def _place(coated: Coated, at: Array) -> str:
    x, y, z = (coated.in_part(at[None])[0] / MM + 0.0).tolist()
    return f"X{x:.1f} Y{y:.1f} Z{z:.1f} of it"


def _percent(share: float) -> str:
    return f"{100.0 * share:.1f} %" if share >= 1e-3 else "less than 0.1 %"


def summary_of(coating: Mapping[str, Any]) -> list[list[str]]:
    """Rows of the table that ends a run: a name, a value, a remark."""
    rows = [
        ["sprayed", f"{coating['sprayed_mm3'] / 1e3:.4g} cm³", f"{coating['solids_mm3'] / 1e3:.4g} cm³ of solids"],
        ["  on surfaces", f"{coating['film_mm3'] / 1e3:.4g} cm³", f"transfer {100 * coating['transfer_share']:.1f} %"],
        [
            "  overspray",
            f"{100 * coating['overspray_share']:.1f} %",
            f"{coating['overspray_mm3'] / 1e3:.4g} cm³ went past",
        ],
        ["  bounced off", f"{coating['bounced_mm3'] / 1e3:.4g} cm³"],
    ]
    for name, body in coating["bodies"].items():
        if body["least_um"] is None:
            continue
        rows.append(
            [
                f"{name}: film",
                f"{body['least_um']:.1f} … {body['most_um']:.1f} µm",
                f"mean {body['mean_um']:.1f} µm on {body['area_mm2'] / 1e6:.3g} m²",
            ]
        )
        rows.append(
            [f"{name}: uncovered", f"{100 * body['uncovered_share']:.1f} %", f"{body['uncovered_mm2']:.4g} mm²"]
        )
    return rows
