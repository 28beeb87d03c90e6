"""A topic of a log as columns, message after message: slow, and plain enough to compare `log/series.py` with."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gcodesim.log.fields import parse_path, value_at
from gcodesim.log.reader import read_messages


def read_columns(path: Path, topic: str, fields: Sequence[str]) -> dict[str, NDArray[Any]]:
    """Numbers and texts of a topic over time: `t_ns` (n,) and one array for each of `fields`.

    A field is a path such as `force_n`, `force.x`, `joints[2].position` or
    `joints[arm/joint_1].position`. A repeated field without an item gives an
    axis: `joints.position` is (n, j).
    KeyError when the log has no such topic, ValueError when its messages have
    no such field, or not equally many of a repeated one.
    """
    paths = [parse_path(field) for field in fields]
    times: list[int] = []
    values: list[list[Any]] = [[] for _ in fields]
    for t_ns, message in read_messages(path, topic):
        times.append(t_ns)
        for column, parts in zip(values, paths, strict=True):
            column.append(value_at(message, parts))
    columns: dict[str, NDArray[Any]] = {"t_ns": np.array(times, dtype=np.int64)}
    for name, column in zip(fields, values, strict=True):
        try:
            columns[name] = np.array(column, dtype=object if _holds_text(column) else None)
        except ValueError as error:
            raise ValueError(f"{topic}: not equally many of '{name}' in every message") from error
    return columns


def _holds_text(column: Any) -> bool:
    while isinstance(column, list) and column:
        column = column[0]
    return isinstance(column, str)
