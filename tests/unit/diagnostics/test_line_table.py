"""Lines of a long text: going through them is asking for each."""

from gcodesim.diagnostics.line_table import LineTable


def test_lines_by_turns_and_by_index(monkeypatch):
    monkeypatch.setattr("gcodesim.diagnostics.line_table._TOGETHER", 3)
    for raw in (b"", b"\n", b"a", b"G0\r\nG1\n\n\rM2\r", "X1 (ä)\nY2\r\n\nZ3\nA\nB\nC\n".encode()):
        table = LineTable(raw, 0, "utf-8")
        expected = [table[index] for index in range(len(table))]
        assert list(table) == expected
        assert table[1:4] == expected[1:4]
        assert table[::-2] == expected[::-2]
        assert table[-2:] == expected[-2:]
