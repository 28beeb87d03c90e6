"""Both lanes, the grammar's and the compiled one, say the same of any program: events, findings, memory."""

import math
import random

import numpy as np
import pytest

from gcodesim import canon
from gcodesim.canon.batch import MoveBatch
from gcodesim.diagnostics import SourceText
from gcodesim.motion import build_tool_path
from gcodesim.rs274 import Settings, interpret
from tests.unit.rs274.lanes import CORPUS, assert_same, both, moves_in_batches, mutated

HEAD = "G21 G90 G17 G94\nS1000 M3\nF300\n"


PLAIN = {
    "straight moves": "G0 X1 Y2 Z3\nG1 X4.5 F100\nY-.25\nz+7. a10\nB-5 C1\nX4.5\n\n(c) G1 Z1 (d)\nN7 Z2 ; e, f\n",
    "rotary alone": "G1 A10 F5\nA20\nX1 A30\nA30\n",
    "modal arcs": "G0 X0 Y0\nG2 X10 I5\nX0 I-5\nI5\nG3 X10 Y10 R10\nX0 Y0 R-20\nG2 X10 Y0 I5 P3\nG1 X0\n",
    "helix": "G0 X0 Y0 Z0\nG3 X10 Z5 I5 J0\nG2 X0 I-5 Z0\nX0 I5 P2 Z9\n",
    "planes": "G18 G0 X0 Z0\nG2 X10 I5\nG3 X0 Z3 R7\nG19\nG1 Y0 Z0\nG2 Y10 J5\nG17 G2 X5 Y5 R30\n",
    "incremental": "G91\nG1 X1 Y1\nX1\nG2 X2 I1\nG90\nX5 I1 J0.5 Y8\nG91 G1 A1\nA1\nG90 X0\n",
    "absolute centre": "G0 X0 Y0\nG90.1\nG2 X10 I5 J0\nG91.1 X0 I-5\n",
    "inverse time": "G93\nG1 X10 F2\nX20 F3\nA10 F2\nG2 X30 I5 F1\nX30 A10 F1\nG0 X1\n",
    "feeds": "G1 X1 F10\nG94\nG1 X2 F10\nG95 F.1\nX3\nX3 A5\nA7\n",
    "inches": "G20 G1 X1 F10\nY2\nG2 X2 I.5\nG21 G1 X10\nX20\n",
    "numbers": "G1 X0.1 Y-0. Z00012.500\nX123456789012345 Y.000000000000001\nX1234567890123456\nX0.30000000000000004\n",
    "redundant codes": "G90 G1 X1\nG1 G90 G17 G21 G40 X2\nG94 F200 X2.5\nG01 X3\nG1.0 X4\nG001 X5\n",
    "frames": "G10 L2 P1 X1.5 Y-2 R30\nG54\nG1 X10\nY10\nG17 G3 X5 Y5 R9\nG92 X1 Y1\nX2\nG92.1\nX3\n",
    "turned planes": "G10 L2 P1 X1.5 Y-2 R30\nG54\nG1 X10\nG18 G2 X0 Z0 I-5 K0\nG19 G3 Y5 Z5 R9\n",
    "holes": "G0 Z9\nG81 X1 Y1 Z-2 R3\nX2\nY2\nZ-3\nX5 R4\nX6 F50\nG80\nG0 X0\n",
    "holes, back to R": "G0 Z9\nG99 G82 X1 Z-2 R3 P.5\nX2\nX3 Y4\nG98\nX5\nG61\nX7\nX8\nG64 P.1\nX9\n",
    "holes from below": "G0 Z1\nG81 X1 Z-2 R3\nX2\nG99\nX3\nX4\n",
    "pecks": "G0 Z9\nG83 X1 Z-5 R1 Q1.5\nX2\nX3 Z-1\nG73 X4 Z-4 R2 Q.7\nX5\nX6\n",
    "boring": "G0 Z9\nG85 X1 Z-5 R1\nX2\nG89 X3 Z-4 R2 P1\nX5\nX6 Y1\n",
    "incremental holes": "G0 Z9\nG91\nG81 X1 Z-5 R-2\nX2.1\nY.3\nX.1 Y.1\nG90 X3\nX4\n",
    "holes in planes": "G18 G0 Y9\nG81 X1 Z1 Y-2 R3\nX2\nZ5\nY-4\nG80\nG19 G0 X5\nG83 Y1 Z1 X-2 R3 Q2\nY2\nZ2\n",
    "holes in one plane after the other": "G19 G0 X5\nG89 Y1 Z1 X-2 R3 P1\nY2\nG80\nG0 X9 Z9\nG17\nG81 X1 Y1 Z-2 R3\n"
    "X2\nM8\nX3\nG80\nG18\nG83 X1 Z1 Y-5 R1 Q2\nX4\n(MSG, x)\nX5\nG1 X0\n",
    "holes in inches": "G20 G0 Z1\nG83 X1 Z-1 R.1 Q.3\nX2\nX3\nG21\nX50\nX60\n",
    "beside a contour": "G0 X-9 Y-9\nG41 D1 G1 X0 Y0\nX20\nY20\nX10\nY30\nX-5 F50\n"
    "G3 X-5 Y10 I0 J-10\nG1 Y-20\nG40 X-30\n",
    "arcs beside": "G0 X-9\nG42 D1 G1 X0 Y0\nG2 X20 Y0 I10\nG3 X40 I10\nG2 X40 Y-40 R20\n"
    "G1 X30 Y-39\nX20 Y-50\nG3 X0 R10\n"
    "G3 X0 Y0 J25\nG2 Z-3 X9 Y-9 J-9\nG1 X30\nG0 X40\nY9\nG1 X0\nG40 Y90\n",
    "beside with a tool of radius 0": "G41.1 D0 G1 X0 Y0\n"
    "X20\nY20\nX10\nG3 X-5 Y10 R30\nG93 G1 Y-20 F2\nG94 F9\nX7\nG40 X-30\nY2\n",
    "beside in other frames": "G10 L2 P1 X1 R30\n"
    "G54\nG18 G0 X-9 Z-9\nG42 D1 G1 X0 Z0\nX20\nZ20\nG2 X9 Z31 I-11\nG1 X0 Y7\nG91 X-5 Z9\n"
    "F7\nX-9\nZ-60\nG40 X-9\nX9\n",
    "no motion word": "G1\nX1\nG0\nX2\nF20\nG1 F30\nX3\n",
}


@pytest.mark.parametrize("name", PLAIN)
def test_plain_moves_are_the_same_to_the_last_bit(name):
    stream = assert_same(HEAD + PLAIN[name] + "M2\n")

    assert moves_in_batches(stream) >= 2


GUILTY = [
    "G2 X10", "G2 X10 I5 K1", "G2 X20 I5", "G2 R5", "G2 X10 R1", "G2 X10 I5 R5", "G2 X10 I5 P0", "G2 X10 I5 P1.5",
    "G1 X1 I2", "G0 X1 R2", "X1 X2", "G1 G1 X1", "G1 G2 X1", "G90 G91 X1", "F-1 X1", "G1 X1 F0", "G1X1X", "X1.2.3",
    "X--1", "X1 N5", "G17.5 X1", "G-1 X1", "X", "(open", "(a (b)", "G1 X1 &", "x 1 . 5", "N10.5 X1", "O5", "/X3", "%",
    "T1 M6", "#1=5", "X#1", "X[1+2]", "(MSG, hello)", "(debug, #5420)", "(a, b)", "M0", "S5", "U1", "G53 G0 X0",
    "G41 D1", "G81 X1 Z-1 R1", "X99999999999999999999", "G5.1 X1 Y1 I1 J1", "X1" + " " * 260, "G1 X1 ;" + "c" * 300,
    "G81 X1 Z-2 R1\nX2\nX3 L2\nX4 P1\nA5\nX5 R-9\nX6 Q1\nX7 G98\nF0\nX8", "G83 X1 Z-2 R1 Q0.00001\nX2", "G81 X1\nX2",
    "G41.1 D0 X9\nX8\nG18\nX7\nG40 X3\nX4\nG42.1 D0 X2\nX9\nG81 Z-1 R3\nX4\nG18",
    "G41 D1 X9 Y9\nX20\nY20\nZ1\nX9\nY5\nG40 X0", "G42 D1 X9 Y9\nX20\nX20.1 Y1\nX20\nY30\nX0",
    "G41 D1 X9\nY9\nX9\nG1\nG18 X2",
    "G41 D1 X9 Y9\nX20 Y8\nG3 X20 Y8.5 J.25\nG1 X0",
    "G41 D1 X9 Y9\nX20 Y8\nX19 Y20\nG93 X2 F1\nY1 F2\nG94 F9\nY9\nG40 G1",
    "G41 D1 X9 Y9\nX20 Y8\nY20\n(MSG, x)\nX5\nM0\nX3\nY9\nG20\nX2\nY3\nG0 X9\nY9\nX22\nZ4\nX30\nM30",
    "G84 X1 Z-2 R1\nX2", "G83 X1 Z-2 R1 Q1\nX2\nZ-9999\nX3", "x1 \x0b", "x1 (ä)", "x1\x00", "G1 X1 E5",
]  # fmt: skip


@pytest.mark.parametrize("line", GUILTY)
def test_a_line_that_is_not_plain_is_left_to_the_grammar(line):
    text = HEAD + "G0 X0 Y0 Z0\nG1 X5\n" + line + "\nX6\nG1 X7 F200\nY8\nG40 G80 G0 X9\nM2\n"

    assert_same(text)


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("last", ["", "END"])
def test_line_ends(end, last):
    text = end.join(["G0 X1", "  G1 X2 F3", "", "\tX3  ", "G1 X4 (ä)", "X5", "M2"]) + last.replace("END", end)

    assert_same(text)
    assert_same(text.encode("latin-1"))
    assert_same(b"\xef\xbb\xbf" + text.encode())


def test_loops_and_calls_have_spans_with_callers():
    body = "\n".join(f"G1 X{n} Y{n}.5" for n in range(20))
    text = f"F100\nO1 sub\n{body}\nO1 endsub\nO2 repeat [3]\nO1 call\nG0 Z1\nO2 endrepeat\nM2\n"

    stream = assert_same(text)

    callers = {origin[1] for item in stream if isinstance(item, MoveBatch) for origin in item.origins}
    assert any(chain for chain in callers)


def test_budget_ends_both_lanes_at_the_same_block():
    text = "F100\n" + "G1 X1\nG1 X2\n" * 50 + "M2\n"
    for limit in (1, 2, 17, 50, 101, 102, 103):
        assert_same(text, max_blocks=limit)
    assert_same("F100\nO1 while [1]\nG1 X1\nX2\nO1 endwhile\nM2\n", max_blocks=300)


def test_after_an_error_no_more_moves_come_but_later_faults_are_found():
    text = HEAD + "G1 X1\nX2\nX3 Q5\nX4\nX5\nY1 Y2\nX6\nM2\n"

    stream = assert_same(text)

    assert moves_in_batches(stream) == 2


PLANES = {"G17": ("XY", "IJ", "K"), "G18": ("XZ", "IK", "J"), "G19": ("YZ", "JK", "I")}
OTHERS = [
    "(note)", "", "F250", "N5", "X[1+1]", "#3=7", "G92 X1", "G54", "G55", "M8", "(MSG, x)", "G40", "G80", "G4 P1",
    "G1 X#3 Y2", "G28", "G81 X1 Y1 Z-2 R1", "G0 X1", "G43 H1", "T2 M6", "G64 P.1", "G52 X2", "G91.1", "G94", "G95",
    "M5", "M3", "G1 Z-1", "G1 Z-2", "G0 Z5",
]  # fmt: skip

SPEEDS = [*[[]] * 6, ["S0"], ["S700.5"]]


def random_program(rng):
    """A program with all that the compiled lane knows and some that it does not; mostly right."""
    plane = rng.choice(list(PLANES))
    lines = [rng.choice(["G21", "G20"]), rng.choice(["G90", "G91"]), plane, "F100", "S500 M3"]
    if rng.random() < 0.2:
        lines.append(f"G10 L2 P1 X1 Y2 Z3 R{rng.choice([0, 30, -45.5])} G54")

    def number():
        some = [str(rng.randint(-9, 9)), f"{rng.uniform(-20, 20):.3f}", f"{rng.uniform(-1, 1):.5f}", ".5", "-3."]
        return rng.choice(some)

    for _ in range(rng.randint(20, 60)):
        pick = rng.random()
        (a, b), (i, j), across = PLANES[plane]
        if pick < 0.45:
            words = [f"{axis}{number()}" for axis in rng.sample("XYZABC", rng.randint(1, 3))]
            lines.append(" ".join([*rng.choice([[], ["G1"], ["G0"], ["g01"]]), *words, *rng.choice(SPEEDS)]))
        elif pick < 0.6:
            radius = rng.choice(["90", "-90.5", "90", "200", number()])
            lines.append(
                f"{rng.choice(['G2', 'G3'])} {a}{number()} {b}{number()} R{radius} {rng.choice(['', '', 'F9'])}"
            )
        elif pick < 0.8:
            centre = f"{i}{rng.choice(['5', '-7.25', number()])} {j}{rng.choice(['3', '-1.5'])}"
            third = {"K": "Z", "J": "Y", "I": "X"}[across]
            lines.append(f"{rng.choice(['G2', 'G3'])} {centre} {rng.choice(['', 'P2', third + number()])}")
        elif pick < 0.86:
            plane = rng.choice(list(PLANES))
            lines.append(plane)
        elif pick < 0.92:
            lines.append(rng.choice(["G90", "G91", "G90.1", "G91.1", "G20", "G21", "G93", "G94", "G95"]))
        elif pick < 0.94:
            lines += holes(rng, plane, number)
        elif pick < 0.95:
            lines += contour(rng, plane, number)
        elif pick < 0.98:
            lines.append(rng.choice(OTHERS))
        else:
            lines.append(rng.choice(["%", "G41 D2", "M0", "o9 call [1]", "G2 X1", "X1 X1"]))
    return "\n".join([*lines, "M2"]) + "\n"


def holes(rng, plane, number):
    """A canned cycle and the places at which it runs again."""
    (a, b), _, across = PLANES[plane]
    normal = {"K": "Z", "J": "Y", "I": "X"}[across]
    code = rng.choice(["G81", "G82 P.1", "G83 Q.7", "G73 Q2", "G85", "G89 P.2", "G81"])
    yield f"{code} {a}{number()} {normal}-{rng.randint(1, 5)} R{rng.choice([1, 3, 8])} {rng.choice(['G98', 'G99', ''])}"
    for _ in range(rng.randint(1, 6)):
        places = [f"{a}{number()}", f"{b}{number()}", f"{a}{number()} {b}{number()}", f"{normal}-2.5", f"{a}1 R2"]
        yield rng.choice(places)


MODES = ["G95 F1", "G94 F99", "G92 X1", "G80 F7", "G0", "G1", "M8", ""]


def chain_of_holes(rng):
    """A program of holes: cycles that begin, go on and end, with their modes and now and then a wrong word."""
    plane = rng.choice(["G17", "G17", "G18", "G19"])
    normal = {"G17": "Z", "G18": "Y", "G19": "X"}[plane]
    places = "XYZ".replace(normal, "")

    def hole():
        code = rng.choice(["", "", "", "G81", "G81", "G82", "G83", "G73", "G85", "G89", "G86"])
        odd = rng.random() < 0.03
        words = [f"{axis}{rng.choice(['1', '-2.5', '7'])}" for axis in rng.sample(places, rng.randint(not code, 2))]
        words += [f"{normal}{rng.choice(['-2', '-3.5', '9' if odd else '-5'])}"] * (bool(code) != odd)
        words += [f"R{rng.choice(['1', '3', '-3' if odd else '2'])}"] * (bool(code) or rng.random() < 0.1)
        words += [f"P{rng.choice(['.5', '1', '0', '-1' if odd else '2'])}"] * (code in ("G82", "G89", "G86") or odd)
        words += [f"Q{rng.choice(['.7', '2', '0' if odd else '1'])}"] * (code in ("G83", "G73") or odd)
        words += [rng.choice(["L2", "L1", "A1", "I1", "F0", "Q1", "P1"])] * odd + ["F50"] * (rng.random() < 0.06)
        modes = [rng.choice(group) for group in (["G98", "G99"], ["G90", "G90", "G91"], [plane]) if rng.random() < 0.2]
        if odd:
            modes.append(rng.choice(["G90.1", "G18", "G80", "G98"]))
        return " ".join([*modes, code, *words][:: rng.choice([1, 1, -1])])

    lines = [rng.choice(["G21", "G20"]), plane, "F100 S500 M3", f"G0 {normal}{rng.choice([0, 2, 5])}"]
    for _ in range(rng.randint(5, 40)):
        pick = rng.random()
        if pick < 0.8:
            lines.append(hole())
        elif pick < 0.9:
            lines.append(f"G{rng.choice([0, 1])} {rng.choice('XYZ')}{rng.randint(-3, 9)}")
        else:
            lines.append(rng.choice(["G80", "G80", "G98", "G99", "G17", "G18", "G90", "G61", "G64 P.1", *MODES]))
    return "\n".join([*lines, "M2"]) + "\n"


def contour(rng, plane, number):
    """A path with cutter compensation: mostly long moves, now and then short ones and corners that do not fit."""
    (a, b), (i, j), _ = PLANES[plane]
    x = y = 0.0
    heading, straight = 0.8, True
    yield f"G40 G90 G94 G0 {a}-50 {b}-50"
    on = rng.choice(["41 D1", "42 D1", "41 D3", "42 D3", "41.1 D0", "42.1 D.5"])
    yield f"G{on} G1 {a}0 {b}0 F90"
    for _ in range(rng.randint(1, 20)):
        heading += rng.choice([rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0), 0.02, 3.1, 1.5])
        length = rng.choice([20.0, 30.0, 30.0, rng.uniform(2.0, 9.0)])
        to_x, to_y = round(x + length * math.cos(heading), 3), round(y + length * math.sin(heading), 3)
        pick = rng.random()
        if pick < 0.6:
            turn = rng.choice(["", "", "", "", f" C{number()}"])
            yield f"{rng.choice(['', 'G1', 'G0']) if straight else 'G1'} {a}{to_x:.3f} {b}{to_y:.3f}{turn}"
            straight = True
        elif pick < 0.8:
            straight = False
            size = rng.choice([1, 1, 1, -1]) * round(0.5 * length * rng.uniform(1, 4) + 0.002, 3)
            yield f"{rng.choice(['G2', 'G3'])} {a}{to_x:.3f} {b}{to_y:.3f} R{size}"
        elif pick < 0.84:
            to_x, to_y, straight = x, y, False
            yield f"{rng.choice(['G2', 'G3'])} {i}{rng.choice([9, -20.5])} {j}{rng.choice([0, 5])}"
        else:
            to_x, to_y = x, y
            yield rng.choice(["F44", "G91.1", "(x)", "N9", "F20", "G1 F9", "", "G4 P1", "M8", "Z-2"])
        x, y = to_x, to_y
    yield f"G40 G0 {a}{number()}"


def test_random_programs():
    rng = random.Random(5)
    batched = 0
    for _ in range(60):
        batched += moves_in_batches(assert_same(random_program(rng)))
    assert batched > 250


def test_mutated_programs():
    rng = random.Random(6)
    for _ in range(120):
        assert_same(mutated(rng, random_program(rng)))


def test_random_holes():
    rng = random.Random(9)
    assert sum(moves_in_batches(assert_same(chain_of_holes(rng))) for _ in range(60)) > 250


@pytest.mark.slow
def test_many_random_and_mutated_programs():
    rng = random.Random(7)
    for _ in range(4000):
        text = chain_of_holes(rng) if rng.random() < 0.3 else random_program(rng)
        assert_same(mutated(rng, text))


@pytest.mark.parametrize("block_delete", [False, True])
@pytest.mark.parametrize("kind", ["valid", "invalid"])
@pytest.mark.parametrize("corpus", ["rs274", "differences"])
def test_corpus(corpus, kind, block_delete):
    programs = sorted((CORPUS.parent / corpus / kind).glob("*.ngc"))
    assert len(programs) > 10
    for program in programs:
        assert_same(program.read_bytes(), block_delete=block_delete)


@pytest.mark.parametrize("dialect", ["rs274", "linuxcnc"])
def test_broken_programs(dialect):
    programs = sorted((CORPUS.parents[1] / "programs" / "broken").glob("*.nc"))
    assert len(programs) > 50
    for program in programs:
        assert_same(program.read_bytes(), dialect=dialect, max_blocks=5000)


def test_a_batch_builds_the_path_that_its_events_build():
    rng = random.Random(8)
    for _ in range(20):
        _, _, stream = both(random_program(rng))
        singly = [event for item in stream for event in (item.events() if isinstance(item, MoveBatch) else [item])]
        batches, events = build_tool_path(stream), build_tool_path(singly)
        for name in ("kind", "start", "end", "center", "normal", "sweep", "feed", "rotary_feed", "mode", "tolerance",
                     "naive", "state", "source", "block", "active", "stop"):  # fmt: skip
            assert np.array_equal(getattr(batches, name), getattr(events, name)), name
        assert batches.states == events.states
        assert batches.events == events.events
        assert list(batches.spans) == list(events.spans)


def test_feedback_reaches_a_probe_between_batches():
    source = SourceText("p.ngc", b"F100\nG1 X1\nX2\nG38.2 Z-10\n#1=#5063\nG1 X3\nG1 X#1\nM2\n")
    run = iter(interpret(source, Settings(lane="compiled")))
    reply, ends = None, []
    while True:
        try:
            event = run.send(reply)
        except StopIteration:
            break
        reply = (0.002, 0.0, -0.004, 0.0, 0.0, 0.0) if isinstance(event, canon.ProbeMove) else None
        if isinstance(event, canon.LinearFeed):
            ends.append(event.end[0])
    assert ends[-1] == pytest.approx(-0.004)
