"""Rows as CSV and Parquet: the same bytes in whatever order runs have ended."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Sequence
from contextlib import ExitStack
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Final

from gcodesim.diagnostics.plain import table_text
from gcodesim.files.output_folder import SWEEP_TABLES
from gcodesim.files.whole_file import whole_file
from gcodesim.numbers import clean
from gcodesim.sweep.row import Cell, ColumnHeading

_AT_ONCE: Final = 4096  # rows in memory


def write_tables(folder: Path, heads: Sequence[ColumnHeading], rows: Iterable[Sequence[Cell]]) -> list[Path]:
    """Write the rows into `folder`, row by row; the files. Parquet needs pyarrow, of the extra `scale`."""
    with ExitStack() as stack:
        sheet = io.TextIOWrapper(stack.enter_context(whole_file(folder / SWEEP_TABLES[0])), "utf-8", newline="")
        writer = csv.writer(sheet, lineterminator="\n")
        writer.writerow(table_text(head.name) for head in heads)
        parquet = None
        if find_spec("pyarrow") is not None:
            parquet = _Parquet(stack.enter_context(whole_file(folder / SWEEP_TABLES[1])), heads)
        for row in rows:
            writer.writerow(["" if cell is None else _shown(cell) for cell in row])
            if parquet is not None:
                parquet.add(row)
        sheet.flush()
        sheet.detach()
        if parquet is not None:
            parquet.close()
    return [folder / name for name in SWEEP_TABLES[: 1 if parquet is None else 2]]


def _shown(cell: Cell) -> Any:
    return table_text(cell) if isinstance(cell, str) else clean(cell)


class _Parquet:
    """A Parquet file that is written in groups of rows."""

    def __init__(self, file: Any, heads: Sequence[ColumnHeading]) -> None:
        import pyarrow
        import pyarrow.parquet

        kinds = {"number": pyarrow.float64(), "whole": pyarrow.int64(), "text": pyarrow.string()}
        self._schema = pyarrow.schema([(head.name, kinds[head.kind]) for head in heads])
        self._writer = pyarrow.parquet.ParquetWriter(file, self._schema)
        self._rows: list[Sequence[Cell]] = []

    def add(self, row: Sequence[Cell]) -> None:
        self._rows.append(row)
        if len(self._rows) == _AT_ONCE:
            self._flush()

    def close(self) -> None:
        self._flush()
        self._writer.close()

    def _flush(self) -> None:
        import pyarrow

        if self._rows:
            columns = zip(*self._rows, strict=True)
            arrays = [pyarrow.array(c, type=f.type) for c, f in zip(columns, self._schema, strict=True)]
            self._writer.write_table(pyarrow.Table.from_arrays(arrays, schema=self._schema))
            self._rows.clear()
