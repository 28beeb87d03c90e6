"""The texts of many lines at once are those that a source gives line by line."""

import numpy as np
import pytest

from gcodesim.diagnostics import SourceText
from gcodesim.recorder.lines import texts_of

BLANKS = "\t \x0b\x0c\x1c\x1d\x1e\x1f"


def sources():
    rng = np.random.default_rng(11)
    words = ["G1 X1.5", "(größer)", "", "M2", "\u00a0G4 P1\u00a0", "( a  b )", "%", "\u2003X1"]
    ends = ["\n", "\r\n", "\r"]

    def program(encoding, words):
        lines = []
        for _ in range(300):
            before, after = ("".join(rng.choice(list(BLANKS), rng.integers(0, 4))) for _ in range(2))
            lines.append(before + words[rng.integers(len(words))] + after + ends[rng.integers(3)])
        return "".join(lines).encode(encoding)

    utf8, latin = program("utf-8", words), program("latin-1", words[:-1])
    yield SourceText("a.nc", utf8)
    yield SourceText("b.nc", b"\xef\xbb\xbf" + utf8)
    yield SourceText("c.nc", latin)
    yield SourceText("d.nc", b"")
    yield SourceText("e.nc", b"M2")


def test_texts_are_those_of_the_lines():
    given = {source.name: source for source in sources()}
    names = [*given, "missing.nc"]
    rng = np.random.default_rng(3)
    file, line = rng.integers(0, len(names), 4000), rng.integers(0, 420, 4000)
    expected = []
    for number, at in zip(file.tolist(), line.tolist(), strict=True):
        source = given.get(names[number])
        expected.append(source.line(at).strip() if source is not None else "")
    assert [text.decode() for text in texts_of(given, names, file, line)] == expected
    assert sum(map(bool, expected)) > 1000


@pytest.mark.parametrize("count", [0, 1])
def test_few(count):
    source = SourceText("a.nc", b"  G0 X1 \n")
    some = texts_of({"a.nc": source}, ["a.nc"], np.zeros(count, dtype=np.int64), np.ones(count, dtype=np.int64))
    assert list(some) == [b"G0 X1"] * count
