"""What is packed for a page comes out as the page's own reader has it."""

import base64
import zlib

import numpy as np
import pytest

from gcodesim.report.pack import Pack


def unpacked(blob, entry):
    """Step by step what `data.js` does."""
    data = zlib.decompress(base64.b64decode(blob))[entry["at"] : entry["at"] + entry["bytes"]]
    if entry["type"] == "text":
        return data.decode()
    size, n, k = int(entry["type"][1:]) // 8, entry["rows"], entry["columns"]
    columns = []
    for c in range(k):
        total, column = 0, []
        for i in range(n):
            total += sum(data[b * n * k + c * n + i] << 8 * b for b in range(size))
            total %= 1 << 8 * size
            column.append(total)
        columns.append(column)
    values = np.array(columns, dtype=float).reshape(k, n).T
    if "step" in entry:
        return values * np.array(entry["step"]) + np.array(entry["low"])
    return values + entry.get("base", 0)


@pytest.mark.parametrize("most", [200, 60_000, 4_000_000_000])
def test_whole_numbers_are_exact(most):
    rng = np.random.default_rng(3)
    values = rng.integers(-7, most, size=(300, 3))
    pack = Pack()
    entry = pack.integers(values)

    assert np.array_equal(unpacked(pack.base64(), entry), values)


def test_numbers_are_right_to_a_65535th_of_their_range():
    rng = np.random.default_rng(4)
    values = rng.normal(size=(500, 3)) * [1e-6, 1.0, 1e9] + [5.0, 0.0, -1e9]
    values = np.concatenate([values, np.full((500, 1), 3.25)], axis=1)
    pack = Pack()
    pack.text("something before")
    entry = pack.numbers(values)

    back = unpacked(pack.base64(), entry)

    assert (np.abs(back - values) <= np.ptp(values, axis=0) / 65535 * 0.5001 + 1e-12 * np.abs(values)).all()
    assert (back[:, 3] == 3.25).all()


def test_texts_and_nothing_at_all():
    pack = Pack()
    text, empty, none = (
        pack.text("G1 X1 (größer)\n"),
        pack.integers(np.zeros((0, 3), int)),
        pack.numbers(np.zeros((0, 2))),
    )
    blob = pack.base64()

    assert unpacked(blob, text) == "G1 X1 (größer)\n"
    assert empty["rows"] == none["rows"] == 0


def test_more_than_32_bits_are_refused():
    with pytest.raises(ValueError):
        Pack().integers(np.array([0, 2**33]))
