"""One HTML file that shows a sweep without a network: a table with filters, any two columns, responses over inputs."""

from __future__ import annotations

import base64
import html
import json
import zlib
from collections.abc import Iterable, Mapping, Sequence
from importlib.resources import files
from itertools import islice
from typing import Final

from gcodesim.diagnostics.plain import one_line, plain_tree
from gcodesim.numbers import clean
from gcodesim.sweep.measure import figure, heading_of
from gcodesim.sweep.prepared import Prepared
from gcodesim.sweep.row import Cell, ColumnHeading, Row

_FOLDER: Final = "sweep_page"
_MOST_ROWS: Final = 20_000
"""More than a browser draws at once; of more rows each second, third … is shown."""


def write_page(
    ready: Prepared,
    heads: Sequence[ColumnHeading],
    rows: Iterable[Sequence[Cell]],
    links: Mapping[int, str],
    aim: str,
    count: int,
    best: int | None = None,
) -> str:
    """The page of `count` rows; `links` lead to the pages of runs, by number, `aim` is the column shown first.

    `best` is the run that a search found.

    The same rows give the same text.
    """
    columns = [head for head in heads if head.role != "hash"]
    places = [index for index, head in enumerate(heads) if head.role != "hash"]
    apart = max(-(-count // _MOST_ROWS), 1)
    content = {
        "study": ready.file.source.name,
        "aim": aim,
        "columns": [{"name": head.name, "kind": head.kind, "role": head.role} for head in columns],
        "apart": apart,
        "best": best,
        "rows": [[row[place] for place in places] for row in islice(rows, 0, None, apart)],
        "links": {str(number): link for number, link in links.items()},
        "limits": [limit.text for limit in ready.study.fail],
    }
    index = json.dumps(plain_tree(clean(content)), ensure_ascii=False, allow_nan=False)
    return _asset("page.html").format(
        title=html.escape(one_line(ready.file.source.name)),
        style=_asset("page.css"),
        index=base64.b64encode(zlib.compress(index.encode(), 9)).decode("ascii"),
        script=_asset("page.js"),
    )


def _asset(name: str) -> str:
    return (files("gcodesim") / "data" / _FOLDER / name).read_text(encoding="utf-8")


def aim_of(ready: Prepared, rows: Iterable[Row]) -> str:
    """The figure that the page shows first: that of the search, of the first limit, else the first that there is."""
    search, limits = ready.study.find, ready.study.fail
    asked = [search.least, search.most] if search is not None else []
    wanted = [name for name in (*asked, *(limit.what for limit in limits)) if name is not None]
    known = next((row.figures for row in rows if row.status != "failed"), {})
    return next((name for name in (*wanted, "force", "time") if figure(name, known) is not None), "time")


def column_of(name: str) -> str:
    """The column of a figure."""
    return name if "." in name else heading_of(name)
