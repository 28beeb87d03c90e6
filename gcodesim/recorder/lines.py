"""The texts of many program lines at once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.distinct import distinct
from gcodesim.log import ByteStrings
from gcodesim.recorder.line_kernels import trim

if TYPE_CHECKING:
    from gcodesim.diagnostics import SourceText

Ints = NDArray[np.int64]


def texts_of(sources: Mapping[str, SourceText], names: Sequence[str], file: Ints, line: Ints) -> ByteStrings:
    """Line `line` (m,), from 1, of file `names[file]` (m,), without blanks around it, in UTF-8.

    Empty if there is no such file or line.
    """
    groups = []
    for number in distinct(file).tolist():
        places = np.flatnonzero(file == number)
        source = sources.get(names[number])
        lines = line[places] if source is not None else np.zeros(len(places), dtype=np.int64)
        groups.append((places, _of_lines(source, lines)))
    return ByteStrings.mixed(groups)


def _of_lines(source: SourceText | None, line: Ints) -> ByteStrings:
    if source is None:
        return ByteStrings.of([b""] * len(line))
    starts = source.table.starts
    there = (line >= 1) & (line < len(starts))
    begin = np.where(there, starts[np.where(there, line - 1, 0)], 0)
    end = np.where(there, starts[np.where(there, line, 0)], 0)
    plain = np.empty(len(line), dtype=bool)
    data = np.frombuffer(bytearray(source.raw), dtype=np.uint8)
    trim(begin, end, data, plain)
    found = np.flatnonzero(plain)
    other = np.flatnonzero(~plain)
    exact = ByteStrings.of(source.line(number).strip().encode() for number in line[other].tolist())
    return ByteStrings.mixed([(found, ByteStrings.cut(data, begin[found], end[found])), (other, exact)])
