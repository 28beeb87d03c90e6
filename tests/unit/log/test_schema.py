"""The schemas that a log stores can be read without gcodesim."""

import pytest
from google.protobuf import descriptor_pool, message_factory
from google.protobuf.descriptor_pb2 import FileDescriptorSet

from gcodesim.log.schema import decoder, message_class, proto_text, read_proto, schema_data
from gcodesim.log.topics import topic_table

SCHEMAS = sorted({topic.schema for topic in topic_table(1, 1)})


@pytest.mark.parametrize("schema", SCHEMAS)
def test_dependencies_come_first(schema):
    known = set()
    for file in FileDescriptorSet.FromString(schema_data(schema)).file:
        assert set(file.dependency) <= known
        known.add(file.name)


@pytest.mark.parametrize("schema", SCHEMAS)
def test_a_fresh_pool_understands_the_stored_schema(schema):
    pool = descriptor_pool.DescriptorPool()
    for file in FileDescriptorSet.FromString(schema_data(schema)).file:
        pool.Add(file)
    fresh = message_factory.GetMessageClass(pool.FindMessageTypeByName(schema))

    fields = {f.name: f.number for f in fresh.DESCRIPTOR.fields}
    assert fields == {f.name: f.number for f in message_class(schema).DESCRIPTOR.fields}


def test_own_messages_have_the_fields_of_the_definition():
    program = message_class("gcodesim.Program")(file="a.nc", line=7, tool=3, feed_m_s=0.5, state="running", block=9)
    program.timestamp.FromNanoseconds(1_500_000_000)
    back = decoder("gcodesim.Program", schema_data("gcodesim.Program")).FromString(program.SerializeToString())

    assert (back.file, back.line, back.tool, back.feed_m_s, back.block) == ("a.nc", 7, 3, 0.5, 9)
    assert back.timestamp.seconds == 1 and back.timestamp.nanos == 500_000_000
    event = message_class("gcodesim.Event")(bodies=["a", "b"])
    assert list(event.bodies) == ["a", "b"]


def test_the_reader_of_definitions_refuses_what_it_does_not_know():
    assert [m.name for m in read_proto(proto_text()).message_type] == (
        ["Program", "Output", "Motion", "Joint", "Process", "Wrench", "Vector", "Event"]
    )
    with pytest.raises(ValueError, match="oneof"):
        read_proto("message A {\n oneof x {\n}\n")
