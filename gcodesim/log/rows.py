"""The messages that come every log period, built for many instants at once.

All seven periodic messages of one instant, with their record headers, have a
fixed length, so a log window is a template repeated n times and filled by
columns. Only the word for the kind of process varies in length; there is one
template for each kind.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.log.description import LogDescription, array_of
from gcodesim.log.schema import FIRST_MORE
from gcodesim.log.shop_units import MOTION_TWINS, PROCESS_TWINS
from gcodesim.log.template import Slot, Template, TemplatePiece, bool_slot, double_slot, nested, stamp_slot, text_piece
from gcodesim.log.topics import PERIODIC

Ints = NDArray[np.int64]

MESSAGE_OPCODE: Final = 5
RECORD_HEAD: Final = 9  # opcode and length, in front of every record
MESSAGE_HEAD: Final = 22  # channel, sequence, log time, publish time


def _vector(number: int, array: str, first: int, names: int = 3) -> TemplatePiece:
    return nested(number, *(double_slot(i + 1, array, first + i) for i in range(names)))


def _pose_parts(array: str, first: int) -> tuple[TemplatePiece, TemplatePiece]:
    """Position and orientation as fields 1 and 2."""
    return _vector(1, array, first), _vector(2, array, first + 3, 4)


def _messages(description: LogDescription, kind: str) -> tuple[TemplatePiece, ...]:
    """The periodic messages in the order of `PERIODIC`; field numbers are those of the schemas."""
    transforms = TemplatePiece(b"")
    for i, (parent, child) in enumerate(description.moving_frames):
        position, rotation = _vector(4, "tf", 7 * i), _vector(5, "tf", 7 * i + 3, 4)
        transforms += nested(1, stamp_slot(1), text_piece(2, parent), text_piece(3, child), position, rotation)
    states = stamp_slot(1)
    for i, name in enumerate(description.joint_names):
        numbers = ((2, "joint_position"), (3, "joint_velocity"), (5, "joint_effort"))
        states += nested(2, text_piece(1, name), *(double_slot(number, array, i) for number, array in numbers))
    poses = [stamp_slot(1) + text_piece(2, "world") + nested(3, *_pose_parts(array, 0)) for array in ("target", "tcp")]
    motion = stamp_slot(1)
    for number, array, column in (
        (2, "feed", 0),
        (3, "feed_command", 0),
        (4, "position_error", 0),
        (5, "orientation_error", 0),
        (6, "block_fraction", 0),
        (7, "position", 0),
        (8, "position", 1),
        (9, "position", 2),
    ):
        motion += double_slot(number, array, column)
    motion += bool_slot(10, "limit")
    for number, array in enumerate(("travel_used", "speed_used", "effort_used"), start=11):
        motion += double_slot(number, array)
    for number, twin in enumerate(MOTION_TWINS, start=14):
        motion += double_slot(number, twin.field)
    for i, name in enumerate(description.joint_names):
        numbers = ((2, "joint_command"), (3, "joint_shown"), (4, "joint_command_shown"))
        motion += nested(21, text_piece(1, name), *(double_slot(number, array, i) for number, array in numbers))
    process = stamp_slot(1) + text_piece(2, kind) + bool_slot(3, "engaged")
    arrays = ("spindle", "force", "torque", "power", "removal", "removed", "max_force", "max_torque", "max_power")
    for number, array in enumerate(arrays, start=4):
        process += double_slot(number, array)
    for number, twin in enumerate(PROCESS_TWINS, start=13):
        process += double_slot(number, twin.field)
    for number, field in enumerate(description.process_fields, start=FIRST_MORE):
        slot = bool_slot if field.flag else double_slot
        process += slot(number, array_of(field.name))
    wrench = stamp_slot(1) + text_piece(2, description.wrench_frame)
    wrench += _vector(3, "wrench", 0) + _vector(4, "wrench", 3)
    return transforms, states, *poses, motion, process, wrench


class RecordRows(NamedTuple):
    """Records of n instants, one a row of `template.width` bytes, in which message m begins at `template.starts[m]`.

    They are made where they belong; before that they are numbers: `times` (n,) [ns], `sequence` (n,), `values` (n, c).
    """

    times: Ints
    sequence: Ints
    values: NDArray[np.float64]
    template: RowTemplate

    @property
    def width(self) -> int:
        return self.template.width

    @property
    def starts(self) -> tuple[int, ...]:
        return self.template.starts

    def part(self, first: int, last: int) -> RecordRows:
        """Instants first ≤ i < last, sharing memory."""
        here = slice(first, last)
        return RecordRows(self.times[here], self.sequence[here], self.values[here], self.template)

    def write(self, out: NDArray[np.uint8], at: Ints) -> None:
        """Write each row to `out` from its `at` (n,) on."""
        self.template.fill_in(out, at, self.times, self.sequence, self.values)

    def matrix(self) -> NDArray[np.uint8]:
        """The rows as (n, width) bytes."""
        out = np.empty((len(self.times), self.width), dtype=np.uint8)
        self.write(out.reshape(-1), np.arange(len(self.times)) * self.width)
        return out


class RowTemplate(Template):
    """The records of one instant for one kind of process."""

    def __init__(
        self, description: LogDescription, kind: str, channel_ids: tuple[int, ...], columns: Mapping[str, int]
    ) -> None:
        row, starts = TemplatePiece(b""), []
        for channel, message in zip(channel_ids, _messages(description, kind), strict=True):
            starts.append(len(row.data))
            length = MESSAGE_HEAD + len(message.data)
            head = bytes((MESSAGE_OPCODE,)) + length.to_bytes(8, "little") + channel.to_bytes(2, "little")
            row += TemplatePiece(head)
            row += TemplatePiece(bytes(20), (Slot(0, "sequence"), Slot(4, "time"), Slot(12, "time")))
            row += message
        self.starts = tuple(starts)
        super().__init__(row, columns)


class RowBuilder:
    """Rows for all kinds of process; counts the sequence, which is the same for all periodic topics."""

    def __init__(self, description: LogDescription, channel_ids: tuple[int, ...], columns: Mapping[str, int]) -> None:
        """`columns`: with which column of the values each array begins."""
        if len(channel_ids) != len(PERIODIC):
            raise ValueError("one channel for each periodic topic")
        kinds = description.process_kinds
        self._templates = [RowTemplate(description, kind, channel_ids, columns) for kind in kinds]
        self.count = 0

    def build(self, t_ns: Ints, kind: Ints, values: NDArray[np.float64]) -> list[RecordRows]:
        """Rows of n instants with `values` (n, c), which they keep, in time order, split where the kind changes."""
        n = len(t_ns)
        sequence = self.count + np.arange(n, dtype=np.int64)
        self.count += n
        borders = np.concatenate([[0], np.flatnonzero(np.diff(kind)) + 1, [n]]).tolist()
        return [
            RecordRows(t_ns[i:j], sequence[i:j], values[i:j], self._templates[int(kind[i])])
            for i, j in pairwise(borders)
        ]
