"""The files beside the log: results, lines, and the shapes of stocks and films."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from gcodesim.files.output_folder import FILM_SUFFIXES, LINES_NAME, RESULTS_NAME, SKIN_SUFFIX
from gcodesim.files.whole_file import whole_file, write_whole
from gcodesim.jobs.results import Results
from gcodesim.material.skin import PaintedSkin
from gcodesim.shop import Shop


def write_files(
    out: Path,
    shop: Shop,
    results: Results,
    skins: Mapping[str, PaintedSkin],
    *,
    text: bytes | None = None,
    shapes: bool = True,
) -> None:
    """Write the results of a run in `shop` into the folder `out`, with `shapes` those of stocks and films, too.

    `skins` are those of the stocks that were compared with a target, by their names; `text` is that of the results,
    from whoever has it already.
    """
    write_whole(out / RESULTS_NAME, results.text().encode() if text is None else text)
    write_whole(out / LINES_NAME, results.lines_csv().encode())
    if shapes:
        _write_stocks(out, shop)
        _write_films(out, shop)
        _write_skins(out, skins)


def _write_stocks(out: Path, shop: Shop) -> None:
    from gcodesim.material.stl import write_stl
    from gcodesim.material.stock_file import SUFFIX
    from gcodesim.material.true_volume import surface_for_files
    from gcodesim.recorder.dose_maps import write_doses

    for name, placed in shop.stocks.items():
        with whole_file(out / f"{name}.stl") as file:
            write_stl(surface_for_files(placed.stock), file)
        placed.stock.save(out / f"{name}{SUFFIX}")
        if not placed.revolved:
            write_doses(placed.stock, name, out)


def _write_films(out: Path, shop: Shop) -> None:
    from gcodesim.jobs.coating import film_name
    from gcodesim.material.film_file import write_mesh, write_table

    for coated in shop.coated.values():
        film = coated.film
        if film is None:
            continue
        name, spec = film_name(coated, shop), shop.cell.coats[coated.frame]
        top = max(float(film.coat.dry.max()), spec.bare) if spec.most is None else spec.most
        mesh, table = (out / f"{name}{suffix}" for suffix in FILM_SUFFIXES)
        with whole_file(mesh) as file:
            write_mesh(film, file, top=top, bare=spec.bare, in_part=coated.in_part)
        with whole_file(table) as file:
            write_table(film, file, in_part=coated.in_part)


def _write_skins(out: Path, skins: Mapping[str, PaintedSkin]) -> None:
    for name, skin in skins.items():
        from gcodesim.material.skin_file import write_skin

        with whole_file(out / f"{name}{SKIN_SUFFIX}") as file:
            write_skin(skin, file)
