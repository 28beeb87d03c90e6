"""Reading lines: both ways give the same block, and every fault has its place."""

import random

import pytest

from gcodesim.rs274.dialects import DIALECTS
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.reader import Reader, prepare, read_plain


def reader():
    return Reader(DIALECTS["linuxcnc"])


@pytest.mark.parametrize(
    "text",
    ["G1 X12.5 Y-3.25 F200", "n10g0x.5y5.", "  G01X+1Y-.5\tZ007.50 ", "N5", "G0 @10 ^30", "M3S1200T4"],
)
def test_scan_and_grammar_give_the_same_block(text):
    """The property that lets plain lines bypass the grammar."""
    plain = read_plain(1, text)
    by_grammar = reader()._read_by_grammar(1, text)

    assert plain is not None
    assert [tuple(word) for word in plain.words] == [tuple(word) for word in by_grammar.words]
    assert plain.places == by_grammar.places


def test_scan_and_grammar_agree_on_random_plain_lines():
    rng = random.Random(4)
    for _ in range(300):
        words = [
            rng.choice("GXYZABCIJKFSTPQRLDHEM")
            + rng.choice(["", "-", "+"])
            + rng.choice(["1", "2.5", ".75", "10.", "0"])
            for _ in range(rng.randint(1, 6))
        ]
        text = rng.choice(["", "N12 ", " "]) + rng.choice([" ", ""]).join(words)
        plain = read_plain(1, text)
        assert plain is not None
        slow = reader()._read_by_grammar(1, text)
        assert [tuple(w) for w in plain.words] == [tuple(w) for w in slow.words]
        assert plain.places == slow.places


def test_blanks_mean_nothing_inside_numbers_and_names():
    block = reader().read(1, "x 1 . 2 5 #<w i d> = 2")

    assert tuple(block.words[0]) == ("x", 1.25)
    assert block.settings[0].parameter.name == "wid"
    assert block.places == [(0, 9)]


@pytest.mark.parametrize(
    ("text", "code", "column"),
    [
        ("G0 X1 & Y2", "GS001", 6),
        ("G0 N10 X1", "GS001", 3),
        ("G0 X1 (no end", "GS003", 6),
        ("G0 X1 (a (b) c)", "GS003", 9),
        ("G1 X30 Y", "GS004", 7),
        ("G0 X Y1", "GS004", 3),
        ("G0 X-", "GS004", 4),
        ("G0 X1.2.3", "GS005", 4),
        ("N-10 G0 X1", "GS005", 0),
        ("G0 X[1+[2*3]", "GS006", 4),
        ("G0 X[CUBE[2]]", "GS006", 5),
        ("G0 X[7 DIV 2]", "GS006", 7),
        ("#1 5", "GS007", 3),
        ("#<depth=2", "GS007", 1),
        ("o1 loop [3]", "GS008", 3),
        ("o1 if [1] G0 X1", "GS008", 10),
        ("X1_0", "GS001", 2),
        ("X\u0661", "GS004", 0),
        ("\x00\x01\x02", "GS001", 0),
    ],
)
def test_a_malformed_line_gives_code_and_column(text, code, column):
    with pytest.raises(Fault) as caught:
        reader().read(1, text)

    assert caught.value.code == code
    assert caught.value.at[0] == column


def test_lines_longer_than_the_control_reads_are_refused_at_once():
    with pytest.raises(Fault) as caught:
        reader().read(1, "[" * 1_000_000)

    assert caught.value.code == "GS002"
    assert caught.value.limit == 252


def test_exactly_252_characters_are_read():
    assert reader().read(1, "G0 X1" + " " * 247).words


def test_comments_keep_their_text_and_case():
    squeezed, columns = prepare("G1 (Keep Me) X2 ;Tail")

    assert squeezed == "g1(Keep Me)x2;Tail"
    assert columns[squeezed.index("x")] == 13
