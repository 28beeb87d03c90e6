"""A log as lines of JSON."""

import io
import json

import pytest

from gcodesim.export.lines import write_lines
from gcodesim.export.select import TimeRange
from gcodesim.export.table import NoTableError


def lines(recording, *arguments):
    out = io.StringIO()
    count = write_lines(recording, out, *arguments)
    found = [json.loads(line) for line in out.getvalue().splitlines()]
    assert len(found) == count
    return found


def test_lines_hold_topic_time_and_message(slot):
    found = lines(slot, ["/program", "/event"])

    assert {line["topic"] for line in found} == {"/program", "/event"}
    assert [line["t_ns"] for line in found] == sorted(line["t_ns"] for line in found)
    start = next(line for line in found if line["topic"] == "/event")
    assert start["message"]["code"] == "start" and start["message"]["line"] == 0  # also what is 0 is written


def test_without_topics_every_message_comes(slot):
    assert len(lines(slot)) == sum(slot.log.counts.values())


def test_a_period_thins_every_topic(slot):
    part = TimeRange(first_ns=5_000_000_000, last_ns=6_000_000_000, period_ns=200_000_000)
    found = lines(slot, ["/tcp", "/wrench"], part)

    assert [line["t_ns"] for line in found if line["topic"] == "/tcp"] == [
        5_000_000_000 + k * 200_000_000 for k in range(6)
    ]


def test_a_topic_that_is_not_there_is_refused(slot):
    with pytest.raises(NoTableError, match="/nothing"):
        lines(slot, ["/nothing"])


def test_fields_stand_in_the_order_of_their_schema_whatever_is_zero(slot):
    from gcodesim.log.schema import decoder

    def orders(value, kind):
        yield kind.full_name, tuple(value), kind
        for field in kind.fields:
            inner = value.get(field.name)
            for one in inner if isinstance(inner, list) else [inner]:
                if isinstance(one, dict) and field.message_type is not None:
                    yield from orders(one, field.message_type)

    log = slot.log
    for topic in ("/tcp", "/process", "/joint_states", "/program", "/scene/tool", "/tf"):
        schema = log.schemas[log.channels[log.channel_id(topic)].schema_id]
        top = decoder(schema.name, schema.data).DESCRIPTOR
        for line in lines(slot, [topic])[:200]:
            for name, keys, kind in orders(line["message"], top):
                assert list(keys) == [field.name for field in kind.fields if field.name in keys], (topic, name)
