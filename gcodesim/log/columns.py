"""Collects the columns of log windows of any length into batches that are worth building."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import dots
from gcodesim.frames import canonical_quaternion
from gcodesim.log.description import PROCESS_COLUMNS, LogDescription, MotionColumns, array_of
from gcodesim.log.row_kernels import NOT_FINITE, UNIT, fault_of
from gcodesim.log.shop_units import JOINTS_SHOWN, MOTION_TWINS, PROCESS_TWINS

BATCH: Final = 512  # instants: about 1 MB of records, a chunk
_JOINTS: Final = ("joint_position", "joint_velocity", "joint_effort", "joint_command", *JOINTS_SHOWN)
_POSES: Final = ("tf", "target", "tcp")
_AT_PARENT: Final = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0)


class ColumnBatch:
    """Up to `BATCH` log instants: one matrix (BATCH, c), in which `columns` says where each array by name begins.

    It starts as if there had been one instant in which all frames are at their
    parents and everything else is 0, which is what a run shows if it fails
    before its first instant.
    """

    def __init__(self, description: LogDescription) -> None:
        widths = dict.fromkeys([*(field.name for field in fields(MotionColumns)), *PROCESS_COLUMNS], 1)
        widths |= {"position": 3, "wrench": 6, "tf": 7 * len(description.moving_frames), "target": 7, "tcp": 7}
        widths |= dict.fromkeys((twin.field for twin in (*MOTION_TWINS, *PROCESS_TWINS)), 1)
        widths |= dict.fromkeys(_JOINTS, len(description.joint_names))
        widths |= dict.fromkeys((array_of(field.name) for field in description.process_fields), 1)
        ends = np.cumsum(list(widths.values())).tolist()
        self.columns = {name: end - width for (name, width), end in zip(widths.items(), ends, strict=True)}
        self._widths = widths
        self._values = np.zeros((BATCH, ends[-1]))
        begins = [self.columns[name] + first for name in _POSES for first in range(0, widths[name], 7)]
        self._quaternions = np.array(begins, dtype=np.int64) + 3
        for first in begins:
            self._values[0, first : first + 7] = _AT_PARENT
        self._arrays = self._named()
        self._kinds = len(description.process_kinds)
        self._times = np.zeros(BATCH, dtype=np.int64)
        self._newest = 0  # row of the newest instant
        self.count = 0

    def _named(self) -> dict[str, NDArray[Any]]:
        """The arrays as parts of the matrix."""
        return {name: self._values[:, first : first + self._widths[name]] for name, first in self.columns.items()}

    @property
    def full(self) -> bool:
        return self.count == BATCH

    @property
    def first_ns(self) -> int | None:
        """The oldest instant in the batch, if any."""
        return int(self._times[0]) if self.count else None

    @property
    def newest(self) -> dict[str, NDArray[Any]]:
        """The newest instant there was, as columns of one row."""
        return {name: array[self._newest : self._newest + 1].copy() for name, array in self._arrays.items()}

    def put(self, times: NDArray[np.int64], columns: Mapping[str, Any], start: int) -> int:
        """Take instants from row `start` on as far as there is room; how many were taken."""
        n = len(times)
        taken = min(BATCH - self.count, n - start)
        into, out = slice(self.count, self.count + taken), slice(start, start + taken)
        for name, array in self._arrays.items():
            column = np.asarray(columns[name])
            if column.size != n * array.shape[1] or len(column) != n:
                raise ValueError(f"log column '{name}' has shape {column.shape}; wanted {n} rows of {array.shape[1]}")
            array[into] = column.reshape(n, array.shape[1])[out]
        self._times[into] = times[out]
        self.count += taken
        self._newest = self.count - 1
        return taken

    def take(self) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64]]:
        """Times (n,), kinds of process (n,) and the checked values (n, c), all copied; afterwards the batch is empty.

        ValueError for a number that is not finite, a quaternion that is not of
        unit length or an unknown kind of process.
        """
        times, values = self._times[: self.count].copy(), self._values[: self.count]
        self.count = 0
        fault = fault_of(values, self._quaternions)
        if fault == NOT_FINITE:
            row, column = np.argwhere(~np.isfinite(values))[0].tolist()
            raise ValueError(f"log column '{self._name(column)}' is not finite at {times[row] * 1e-9:.6f} s")
        if fault:
            for first in self._quaternions.tolist():
                q = values[:, first : first + 4]
                if not (np.abs(dots(q, q) - 1.0) < UNIT).all():
                    raise ValueError(f"log column '{self._name(first)}' has a quaternion that is not of unit length")
                q[:] = canonical_quaternion(q)
        kind = self._arrays["kind"][: len(times), 0].astype(np.int64)
        if not (kind.min() >= 0 and kind.max() < self._kinds):
            raise ValueError(f"a process kind is outside 0 … {self._kinds - 1}")
        self._values = np.empty_like(self._values)
        self._values[0] = values[self._newest]
        self._newest, self._arrays = 0, self._named()
        return times, kind, values

    def _name(self, column: int) -> str:
        """The array in which a column lies."""
        return max((first, name) for name, first in self.columns.items() if first <= column)[1]
