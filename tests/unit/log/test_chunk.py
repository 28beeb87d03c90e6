"""The indexes of chunks point where they say: a viewer seeks by them."""

import struct
import zlib

import numpy as np
import pytest
import zstandard
from mcap.reader import make_reader
from mcap.records import Chunk, MessageIndex
from mcap.stream_reader import StreamReader

MS = 1_000_000


def chunks_with_indexes(path):
    found = []
    with open(path, "rb") as stream:
        for record in StreamReader(stream, emit_chunks=True, validate_crcs=True).records:
            if isinstance(record, Chunk):
                found.append((record, []))
            elif isinstance(record, MessageIndex):
                found[-1][1].append(record)
    return found


def test_message_indexes_name_every_message_and_its_place(run, tmp_path):
    kinds = np.random.default_rng(1).integers(0, 3, 1501)
    path = run.write(tmp_path / "run.mcap", seconds=3.0, period_ns=2 * MS, kinds=kinds, window=200)
    total = 0
    for chunk, indexes in chunks_with_indexes(path):
        data = zstandard.decompress(chunk.data, chunk.uncompressed_size)
        assert zlib.crc32(data) == chunk.uncompressed_crc
        places = set()
        for index in indexes:
            for t_ns, offset in index.records:
                opcode, _, channel, _, log_ns, publish_ns = struct.unpack_from("<BQHIQQ", data, offset)
                assert (opcode, channel, log_ns, publish_ns) == (5, index.channel_id, t_ns, t_ns)
                assert chunk.message_start_time <= t_ns <= chunk.message_end_time
                places.add(offset)
            assert [t for t, _ in index.records] == sorted(t for t, _ in index.records)
        at, records = 0, set()
        while at < len(data):
            records.add(at)
            at += 9 + struct.unpack_from("<Q", data, at + 1)[0]
        assert places == records
        total += len(records)
    with open(path, "rb") as stream:
        assert total == make_reader(stream).get_summary().statistics.message_count


def test_chunk_indexes_find_chunks_and_message_indexes(run, tmp_path):
    path = run.write(tmp_path / "run.mcap", seconds=3.0, period_ns=2 * MS)
    data = path.read_bytes()
    with open(path, "rb") as stream:
        chunk_indexes = make_reader(stream).get_summary().chunk_indexes
    assert len(chunk_indexes) > 2
    for index in chunk_indexes:
        opcode, length = struct.unpack_from("<BQ", data, index.chunk_start_offset)
        assert (opcode, length + 9) == (6, index.chunk_length)
        first = index.chunk_start_offset + index.chunk_length
        assert min(index.message_index_offsets.values()) == first
        for channel, offset in index.message_index_offsets.items():
            assert struct.unpack_from("<BQH", data, offset)[::2] == (7, channel)
            assert offset < first + index.message_index_length


@pytest.mark.filterwarnings("ignore:start_time is deprecated")  # its new name is not in older versions
@pytest.mark.filterwarnings("ignore:end_time is deprecated")
def test_a_jump_by_the_library_finds_the_time(run, tmp_path):
    path = run.write(tmp_path / "run.mcap", seconds=3.0, period_ns=2 * MS)
    with open(path, "rb") as stream:
        found = make_reader(stream).iter_messages(["/tcp"], start_time=1999 * MS, end_time=2007 * MS)
        assert [message.log_time for _, _, message in found] == [2000 * MS, 2002 * MS, 2004 * MS, 2006 * MS]
