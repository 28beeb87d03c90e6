"""Messages of fixed width say the same as messages made by protobuf."""

import numpy as np
import pytest
from google.protobuf.timestamp_pb2 import Timestamp

from gcodesim.log.schema import message_class
from gcodesim.log.template import (
    Template,
    TemplatePiece,
    bool_slot,
    double_slot,
    nested,
    padded_stamps,
    padded_varints,
    stamp_slot,
    text_piece,
)
from gcodesim.log.wire import varint

TIMES = np.array([0, 1, 999_999_999, 10**9, 86_400 * 10**9 + 5, 2**63 - 1], dtype=np.int64)


def test_padded_stamps_are_stamps():
    for t_ns, row in zip(TIMES, padded_stamps(TIMES), strict=True):
        stamp = Timestamp.FromString(row.tobytes())
        assert stamp.seconds * 10**9 + stamp.nanos == t_ns


def test_padded_integers_are_integers():
    values = np.array([0, 1, 127, 128, 16384, 2**32 - 1])
    for value, row in zip(values, padded_varints(12, values), strict=True):
        assert message_class("gcodesim.Program").FromString(row.tobytes()).block == value


@pytest.mark.parametrize(("value", "data"), [(0, "00"), (127, "7f"), (128, "8001"), (300, "ac02"), (2**21, "80808001")])
def test_the_shortest_form_of_integers(value, data):
    assert varint(value).hex() == data


def test_a_template_fills_the_columns_into_their_fields():
    force = nested(3, *(double_slot(i + 1, "wrench", i) for i in range(3)))
    torque = nested(4, *(double_slot(i + 1, "wrench", 5 - i) for i in range(3)))
    template = Template(stamp_slot(1) + text_piece(2, "tool") + force + torque)
    values = np.random.default_rng(4).normal(size=(len(TIMES), 6))
    values[0] = 0.0

    for t_ns, value, row in zip(TIMES, values, template.fill(TIMES, values), strict=True):
        wrench = message_class("gcodesim.Wrench").FromString(row.tobytes())
        assert wrench.timestamp.seconds * 10**9 + wrench.timestamp.nanos == t_ns
        assert [wrench.force.x, wrench.force.y, wrench.force.z] == value[:3].tolist()
        assert [wrench.torque.z, wrench.torque.y, wrench.torque.x] == value[3:].tolist()
        assert wrench.frame_id == "tool" and wrench.HasField("force")


def test_flags_and_long_messages():
    """Above 127 bytes the length of a message takes two bytes."""
    body = [double_slot(i, "values", i - 4) for i in range(4, 10)]
    template = Template(
        text_piece(2, "k" * 300)
        + bool_slot(3, "flag")
        + TemplatePiece(b"")
        + body[0]
        + sum(body[1:], TemplatePiece(b""))
    )
    data = template.fill(np.zeros(2, dtype=np.int64), np.concatenate([[[1.0], [0.0]], np.eye(2, 6)], axis=1))

    first, second = (message_class("gcodesim.Process").FromString(row.tobytes()) for row in data)
    assert first.kind == "k" * 300 and first.engaged and not second.engaged
    assert (first.spindle_rad_s, first.force_n, second.spindle_rad_s, second.force_n) == (1.0, 0.0, 0.0, 1.0)
