"""Lines of one shape are parsed once, and come out as if each had been parsed itself."""

import random

import pytest

from gcodesim.rs274.dialects import DIALECTS
from gcodesim.rs274.grammar import Unreadable, parser_of
from gcodesim.rs274.shapes import Shapes

LINES = {
    "rs274": [
        "g1x#1y[2.5+#2*cos[30]]f[1500/2]", "#1=2.5", "#[3+#4]=[1]#5=-6.25", "n10g1x[-5]", "n9.5x[1]", "x-[2]y+#3",
        "x--5", "#1=[atan[3]/[-4]]", "#1=[exists[#3]+exists[#<a>]]", "x[1mod2]z[2**-1]", "x1.2.3y[1]", "x[1..2]",
        "n1n2x[1]", "o100if[#1gt2]", "/x[1]", "x[1]n5", "x[00.50]", "g1x[.5]y.5", "x[1]y", "#1", "#1=", "x[1",
        "(1)x[2]", "x[2];5", "#<a1>=5", "x#<a1>", "m98p[1000]l2", "#-0=1", "x-0y-[0]", "@5^[30]", "x[1]x[2]y0z000",
    ],
    "fanuc": [
        "#1=#2+3.", "if[#1gt5]goto10", "while[#1lt5]do1", "x[#1+2]y-#3", "n10goto20", "#100=[1-2]*3", "/2x[1]", "end1",
        "#1=round[2.5]", "o0100", ":5", "g65p100a[1]b-2", "if[#1eq#0]then#2=5", "#1=atan[1]/[2]", "#1=pow[2,3]",
    ],
    "grbl": ["g1x-5y.5", "n10g1x5.", "x--1", "x1.2.3", "/x5", "n10.5x1"],
}  # fmt: skip


def outcome(parse, line):
    try:
        return repr(parse(line))
    except Unreadable as problem:
        return problem.column, problem.found, problem.expected


@pytest.mark.parametrize("grammar", LINES)
def test_a_remembered_shape_gives_what_the_parser_gives(grammar):
    """Each line twice over, with numbers of other lengths and values, by the shapes and by the parser alone."""
    rng = random.Random(3)
    parse = parser_of(grammar, DIALECTS[grammar].grammar_parts)
    shapes = Shapes(parse)
    for _ in range(60):
        for line in LINES[grammar]:
            out = ""
            for char in line:
                some = rng.choice(["7", "12", "0", "5", "345"]) if char.isdigit() and rng.random() < 0.5 else char
                out += "" if rng.random() < 0.01 else some
            assert outcome(shapes.parsed, out) == outcome(parse, out), out


def test_the_parser_sees_a_shape_once():
    seen = []

    def parse(line):
        seen.append(line)
        return parser_of("rs274")(line)

    shapes = Shapes(parse)
    for number in range(50):
        (word,) = shapes.parsed(f"n{number}x[{number}.5+#{number + 1}]").words
        assert word[0] == len(f"n{number}")
        assert (word[1].value.left, word[1].value.right.index) == (number + 0.5, number + 1.0)

    assert len(seen) == 1
