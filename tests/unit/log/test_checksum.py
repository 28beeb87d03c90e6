"""Checksums of logs are those of zlib, whoever makes them."""

import importlib
import sys
import zlib

import numpy as np

from gcodesim.log import checksum


def test_checksums_are_those_of_zlib_and_go_on():
    data = np.random.default_rng(8).integers(0, 256, 100_000, dtype=np.uint8).tobytes()
    for end in (0, 1, 15, 16, 17, 4096, 100_000):
        assert checksum.crc32(data[:end]) == zlib.crc32(data[:end])
        assert checksum.crc32(data[end:], checksum.crc32(data[:end])) == zlib.crc32(data)
    assert checksum.crc32(memoryview(data)[3:]) == zlib.crc32(data[3:])


def test_without_the_package_zlib_makes_them(monkeypatch):
    monkeypatch.setitem(sys.modules, "isal.isal_zlib", None)
    try:
        assert importlib.reload(checksum).crc32 is zlib.crc32
    finally:
        monkeypatch.undo()
        importlib.reload(checksum)
