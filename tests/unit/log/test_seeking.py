"""A log of three hours: what is read of it is its summary and the chunks that are shown, not the file."""

import io
from pathlib import Path

import numpy as np
import pytest
from mcap.reader import make_reader

from gcodesim.log import LogWriter
from gcodesim.log.summary import summary

S = 1_000_000_000
HOURS = 3
END = HOURS * 3600 * S
PERIOD = S // 5
BLOCK = 2 * S


class Counting(io.BufferedReader):
    """A file that counts the bytes that are read of it."""

    def __init__(self, path):
        super().__init__(io.FileIO(path))
        self.count = 0

    def read(self, size=-1):
        data = super().read(size)
        self.count += len(data)
        return data


@pytest.fixture(scope="module")
def long_log(run, tmp_path_factory):
    """Three hours at 5 Hz, a block each 2 s, a look at the part each 90 s, a finding at the end of each hour."""
    path = tmp_path_factory.mktemp("long") / "run.mcap"
    log = LogWriter(path, run.description(stock_tiles=16, added_tiles=0))
    tiles = [run.tile(0.02 * i, 1e-3, n=40) for i in range(16)]
    for i, tile in enumerate(tiles):
        log.stock_tile(0, i, tile)
    for first in range(0, END, 90 * S):
        t = np.arange(first, first + 90 * S, PERIOD)
        log.window(t, **run.columns(t))
        for at in range(first, first + 90 * S, BLOCK):
            log.program(at, file="part.nc", line=at // BLOCK + 1, text=f"G1 X{at // BLOCK}", block=at // BLOCK)
        log.stock_tile(first + 90 * S, first // (90 * S) % 16, tiles[first // (90 * S) % 16])
        if (first + 90 * S) % (3600 * S) == 0:
            log.event(first + 90 * S, "GS401", "rapid", severity="error", file="part.nc", line=at // BLOCK + 1)
    log.close(END, "finished", {}, {"results.json": b"{}"})
    return path


@pytest.mark.filterwarnings("ignore:start_time is deprecated")  # its new name is not in older versions
@pytest.mark.filterwarnings("ignore:end_time is deprecated")
def test_opening_and_jumping_read_a_small_part(long_log):
    size = long_log.stat().st_size
    with Counting(long_log) as stream:
        reader = make_reader(stream)
        found = reader.get_summary()
        opened = stream.count
        chunks = found.chunk_indexes
        assert found.statistics.message_end_time == END and len(chunks) > 100
        assert opened < 0.03 * size

        largest = max(chunk.chunk_length for chunk in chunks)
        for hours in (1.5, 2.9, 0.1):  # to and fro
            before = stream.count
            begin = round(hours * 3600) * S
            shown = list(reader.iter_messages(start_time=begin, end_time=begin + 5 * S))
            assert {channel.topic for _, channel, _ in shown} >= {"/tf", "/tcp", "/process", "/program"}
            touched = [c for c in chunks if c.message_end_time >= begin and c.message_start_time <= begin + 5 * S]
            assert stream.count - before <= len(touched) * (largest + 64)
            assert len(touched) <= 3


def test_what_a_jump_has_to_look_for_is_near(long_log):
    """The last message of each topic before a moment, as a viewer fetches it: its index names the chunks to read."""
    with Counting(long_log) as stream:
        reader = make_reader(stream)
        found = reader.get_summary()
        at, needed = 2 * 3600 * S, set()
        size = long_log.stat().st_size
        for number in found.channels:
            holders = [
                i
                for i, chunk in enumerate(found.chunk_indexes)
                if number in chunk.message_index_offsets and chunk.message_start_time <= at
            ]
            assert holders, found.channels[number].topic
            needed.add(holders[-1])
        # a chunk lasts about as long as a tile waits for the next: one for each tile, for what came once, and for now
        assert len(needed) <= 16 + 2
        read = sum(found.chunk_indexes[i].chunk_length for i in needed)
        assert read <= (16 + 2) * max(chunk.chunk_length for chunk in found.chunk_indexes) < 0.15 * size


def test_a_quick_look_reads_a_small_part(long_log, monkeypatch):
    streams = []

    def counting(self, mode="r"):
        assert mode == "rb"
        streams.append(Counting(self))
        return streams[-1]

    monkeypatch.setattr(Path, "open", counting)
    facts = summary(long_log, check=False)
    assert facts.complete and facts.duration_ns == END and len(facts.findings) == HOURS
    assert facts.stopped_at.line == END // BLOCK
    assert 0 < sum(stream.count for stream in streams) < 0.1 * long_log.stat().st_size
