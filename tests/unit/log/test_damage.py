"""Logs with damage inside: what is left can be read, and what is not is told."""

import struct
from pathlib import Path

import numpy as np
import pytest

from gcodesim.log.logfile import LogFile, LogReadError
from gcodesim.log.series import read_series
from gcodesim.log.summary import summary
from tests.log_columns import read_columns

MS = 1_000_000


@pytest.fixture(scope="module")
def whole(run, tmp_path_factory):
    """Several chunks."""
    return run.write(tmp_path_factory.mktemp("log") / "run.mcap", seconds=6.0, period_ns=2 * MS)


def harmed(whole: Path, path: Path, at: int, data: bytes, end: int | None = None) -> Path:
    """A copy with `data` at byte `at`, up to byte `end`."""
    held = bytearray(whole.read_bytes())
    held[at : at + len(data)] = data
    path.write_bytes(held[:end])
    return path


def flipped(whole: Path, at: int) -> bytes:
    return bytes([whole.read_bytes()[at] ^ 0x40])


def test_a_damaged_chunk_costs_its_own_messages_only(whole, tmp_path):
    chunks = LogFile.open(whole).chunks
    assert len(chunks) > 3
    bad = chunks[2]
    path = harmed(whole, tmp_path / "run.mcap", bad.offset + 1000, flipped(whole, bad.offset + 1000))
    log = LogFile.open(path, lenient=True)
    found = read_series(log, ["/process"])["/process"]

    truth = read_series(LogFile.open(whole), ["/process"])["/process"]
    lost = ~np.isin(truth.t_ns, found.t_ns)
    assert lost.any() and np.array_equal(found.values, truth.values[~lost])
    assert truth.t_ns[lost].min() >= bad.first_ns and truth.t_ns[lost].max() <= bad.last_ns
    (damage,) = log.damage
    assert (damage.what, damage.offset) == ("chunk", bad.offset)
    assert (damage.first_ns, damage.last_ns) == (bad.first_ns, bad.last_ns)
    with pytest.raises(LogReadError, match=f"the chunk at byte {bad.offset} does not agree with its checksum"):
        read_columns(path, "/process", ["force_n"])


def test_the_summary_tells_which_time_is_missing(whole, tmp_path):
    chunks = LogFile.open(whole).chunks
    bad = chunks[2]
    path = harmed(whole, tmp_path / "run.mcap", bad.offset, bytes(4096))  # not even its length is left
    found = summary(path)

    assert not found.complete and found.state == "finished"
    assert found.verdict == "finished, but the file is damaged" and found.problem == "1 part of it cannot be read"
    (told,) = found.missing
    assert told.startswith(f"{bad.first_ns * 1e-9:.3f} to {bad.last_ns * 1e-9:.3f} s, in or after part.nc:")
    assert f"chunk 3 of {len(chunks)}, at byte {bad.offset}, is damaged" in told


def test_a_quick_look_does_not_see_what_it_does_not_read(whole, tmp_path):
    file = LogFile.open(whole)
    shown = {file.channel_id("/event"), file.channel_id("/program")}
    bad = next(chunk for chunk in file.chunks if not chunk.channels & shown)
    path = harmed(whole, tmp_path / "run.mcap", bad.offset, bytes(4096))

    assert summary(path, check=False).complete and not summary(path).complete


def test_a_cut_log_is_read_beyond_a_damaged_chunk(whole, tmp_path):
    chunks = LogFile.open(whole).chunks
    bad = chunks[2]
    path = harmed(whole, tmp_path / "run.mcap", bad.offset + 9, b"\xff" * 40, end=chunks[-1].offset)
    found = summary(path)

    assert found.duration_ns >= chunks[-2].first_ns and "ends before its index" in found.problem
    (damage,) = found.damage
    assert chunks[1].first_ns <= damage.first_ns <= bad.first_ns and bad.last_ns <= damage.last_ns <= chunks[3].last_ns
    t = read_series(LogFile.open(path, lenient=True), ["/tf"])["/tf"].t_ns
    assert (t < bad.first_ns).any() and (t > bad.last_ns).any()


def test_a_damaged_attachment_is_told_and_never_handed_out(whole, tmp_path):
    offset = LogFile.open(whole).attachments["program.nc"][0]
    path = harmed(whole, tmp_path / "run.mcap", offset + 80, flipped(whole, offset + 80))
    log = LogFile.open(path, lenient=True)

    with pytest.raises(LogReadError, match=r"program\.nc is damaged"):
        log.attachment("program.nc")
    assert log.attached("program.nc") is None and log.attached("nothing") is None
    assert log.attached("cell.yaml") is not None
    assert [damage.what for damage in log.damage] == ["program.nc"]
    assert summary(path).missing == (f"program.nc, attached at byte {offset}, is damaged",)


def test_an_attachment_without_its_head_is_damaged(whole, tmp_path):
    offset = LogFile.open(whole).attachments["program.nc"][0]
    path = harmed(whole, tmp_path / "run.mcap", offset, b"\xff" * 12)
    assert [damage.what for damage in summary(path).damage] == ["program.nc"]
    with pytest.raises(LogReadError, match=r"program\.nc is damaged"):
        LogFile.open(path).attachment("program.nc")


def test_other_records_are_seen_by_the_checksum_of_the_file(whole, tmp_path):
    at = whole.read_bytes().index(b"gcodesim.run") + 30
    path = harmed(whole, tmp_path / "run.mcap", at, flipped(whole, at))

    assert summary(path, check=False).problem == ""
    found = summary(path)
    assert not found.complete and [damage.what for damage in found.damage] == ["record"]


def test_a_record_that_claims_to_be_huge_is_not_believed(whole, tmp_path):
    chunks = LogFile.open(whole).chunks
    for at, value in ((1, 1 << 60), (9 + 16, 1 << 50)):  # length of the record, size of the chunk unpacked
        path = harmed(whole, tmp_path / "run.mcap", chunks[1].offset + at, struct.pack("<Q", value))
        assert [damage.offset for damage in summary(path).damage] == [chunks[1].offset]


def test_a_sound_log_is_read_once(whole, monkeypatch):
    read = 0
    opened = Path.open

    def counting(self, *arguments, **options):
        nonlocal read
        stream = opened(self, *arguments, **options)
        given = stream.read

        class Stream:
            def __enter__(self):
                return self

            def __exit__(self, *_):
                stream.close()

            def seek(self, *where):
                return stream.seek(*where)

            def read(self, size=-1):
                nonlocal read
                data = given(size)
                read += len(data)
                return data

        return Stream()

    log = LogFile.open(whole)
    monkeypatch.setattr(Path, "open", counting)
    log.check()
    assert log.damage == [] and whole.stat().st_size * 0.9 < read <= whole.stat().st_size


def test_damage_anywhere_leaves_true_values_or_none(run, tmp_path):
    path = run.write(tmp_path / "run.mcap", seconds=1.0)
    truth = read_columns(path, "/process", ["force_n"])
    at_time = dict(zip(truth["t_ns"].tolist(), truth["force_n"].tolist(), strict=True))
    whole = path.read_bytes()
    rng = np.random.default_rng(12)
    told = 0
    for _ in range(150):
        data = bytearray(whole)
        at = int(rng.integers(8, len(data)))
        data[at : at + int(rng.integers(1, 200))] = rng.bytes(8) if rng.random() < 0.5 else bytes(16)
        path.write_bytes(data)
        found = summary(path)
        told += not found.complete
        log = LogFile.open(path, lenient=True)
        try:
            series = read_series(log, ["/process"]).get("/process")
        except LogReadError:  # the schema itself
            continue
        if series is not None and len(series.t_ns):
            assert [at_time[t] for t in series.t_ns.tolist()] == series.column("force_n").tolist()
    assert told > 140  # a few bytes happen to be replaced by themselves
