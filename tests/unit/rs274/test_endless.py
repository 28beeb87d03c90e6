"""GS134: a program that never ends is known by its state; one that may end is let go on."""

import pytest


def found(done):
    return [(f.code, f.span.line) for f in done.errors]


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("#1=0\no1 while [#1 LT 10]\no2 repeat [3]\nG0 X1\nG0 X0\no2 endrepeat\no1 endwhile\nM2", 2),
        ("o1 do\no1 while [1]\nM2", 1),
        ("o1 sub\nG0 X1\no1 endsub\no2 while [1]\no1 call\no2 endwhile\nM2", 4),
        # it turns round for a while before it stays the same
        ("#1=9000\no1 while [1]\n#1=[#1*0.5]\no2 if [#1 LT 1]\n#1=1\no2 endif\no1 endwhile\nM2", 2),
    ],
)
def test_a_state_that_comes_back_is_proof(program, text, line):
    done = program(text)

    assert found(done) == [("GS134", line)]
    assert done.errors[0].message.startswith("the program never ends: ")
    assert done.run.blocks < 60_000


def test_so_it_is_on_fanuc(program):
    done = program("O1\nN1 G0 X1.\nM98 P2\nGOTO 1\nM30\nO2\n#1=1\nM99\n", dialect="fanuc")

    assert found(done) == [("GS134", 2)]
    assert not done.errors[0].span.callers


def test_programs_that_end_may_be_long(program):
    """A walk of 200,000 rounds, more than half a million blocks."""
    text = "#1=0\n#2=1\no1 while [#1 LT 200000]\n#1=[#1+1]\n#2=[[#2*16807] MOD 2147483647]\no1 endwhile\nG0 X#1\nM2"

    assert program(text).ends == [[200000, 0, 0]]


def test_what_still_changes_is_told(program):
    done = program("#1=0\no1 while [#1 LT 10]\n#1=[#1-1]\no1 endwhile\nM2", max_blocks=5000)

    assert done.errors[0].message == "the program did not end within 5000 blocks"
    assert done.errors[0].hint.startswith("the loop that begins here still changes #1 (now -")
    moving = program("o1 while [1]\nG91 G0 X1\no1 endwhile\nM2", max_blocks=5000)
    assert "positions or modes" in moving.errors[0].hint


def test_a_loop_that_probes_depends_on_more_than_itself(program):
    text = "F100\no1 while [#5070 EQ 0]\nG0 Z1\nG38.3 Z0\no1 endwhile\nM2"
    done = program(text, max_blocks=30_000)

    assert not any("never ends" in f.message for f in done.errors)


def test_probes_that_need_not_trip_miss_where_the_program_would_go_in_circles(program):
    """It backs off until the probe is free, as LinuxCNC's own program for scanning a surface does."""
    done = program(
        "G21 F100\n#5070=1\no1 while [#5070 NE 0]\nG38.5 Z10\nG38.3 X5\no1 endwhile\nG38.2 Z-1\nG0 X#5070\nM2"
    )

    assert not done.errors
    assert done.ends[-1] == [1, 0, -1]
    assert all("in circles" in f.hint for f in done.run.findings if f.message.startswith(("G38.3", "G38.5")))


def test_probes_alone_are_no_excuse(program):
    done = program("G21 F100\no1 while [1]\nG38.3 Z-1\nG0 Z0\no1 endwhile\nM2")

    assert found(done) == [("GS134", 2)]
