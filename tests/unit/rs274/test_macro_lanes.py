"""Expressions, parameters, loops and calls say the same in both lanes: events, findings, memory."""

import random

import pytest

from gcodesim.canon.batch import MoveBatch
from tests.unit.rs274.lanes import assert_same, both, moves_in_batches, mutated, run_of

HEAD = "G21 G90 G17 G94\nS1000 M3\nF300\n"

FUNCTIONS = ("abs", "acos", "asin", "cos", "exp", "fix", "fup", "ln", "round", "sin", "sqrt", "tan")
OPERATORS = ("+", "-", "*", "/", "mod", "**", "eq", "ne", "gt", "ge", "lt", "le", "and", "or", "xor")
NAMES = ("a", "b", "long_name", "_g", "_h", "A", " b", "_Shared one")
PREDEFINED = ("_x", "_y", "_a", "_feed", "_value", "_value_returned", "_call_level", "_line", "_metric", "_rpm", "_u")


def number(rng):
    return rng.choice([str(rng.randint(0, 9)), f"{rng.uniform(0, 20):.3f}", ".5", "3.", "0", "1", "45", "90"])


def expression(rng, depth=3):
    """A value; now and then it has none."""
    pick = rng.random()
    if depth == 0 or pick < 0.3:
        return number(rng)
    if pick < 0.5:
        return f"#{rng.choice([1, 2, 3, 3, 4, 30, 31, 31, 100, 5420, 5421, 5422, 5423, 5400, 5599, 5221, 5390])}"
    if pick < 0.6:
        return f"#<{rng.choice(NAMES[:5])}>"
    if pick < 0.63:
        return f"#<{rng.choice(PREDEFINED)}>"
    if pick < 0.66:
        return rng.choice(["#[1+2]", "##4", "-#1", "exists[#<a>]", "exists[#<zz>]", "exists[#<_x>]", "#3.00001", "+#2"])
    inner = [expression(rng, depth - 1) for _ in range(2)]
    if rng.random() < 0.01:  # whatever comes of it
        return f"{rng.choice(FUNCTIONS)}[{inner[0]} {rng.choice(OPERATORS)} {inner[1]}]"
    if pick < 0.75:
        kind = rng.choice(FUNCTIONS)
        within = {"sqrt": "abs[{}]", "ln": "1+abs[{}]", "exp": "sin[{}]", "tan": "[{}] mod 80", "acos": "cos[{}]"}
        return f"{kind}[{within.get(kind, 'sin[{}]' if kind == 'asin' else '{}').format(inner[0])}]"
    if pick < 0.78:
        return f"atan[{inner[0]}]/[{inner[1]}]"
    parts = [inner[0]]
    for each in (inner[1], *(expression(rng, depth - 1) for _ in range(rng.randint(0, 2)))):
        operator = rng.choice(OPERATORS[:3]) if rng.random() < 0.6 else rng.choice(OPERATORS[4:])
        each = rng.choice("123") if operator == "**" else f"[{each} + 100]" if operator == "mod" else each
        if operator == "**" and parts[-1][0] not in "0123456789":
            operator = "*"
        parts += [rng.choice(["", " "]), operator, rng.choice(["", " ", "-"]) if operator in "+-*" else " ", each]
    text = f"[{''.join(parts)}]"
    return text.upper() if rng.random() < 0.1 else text


def setting(rng):
    target = rng.choice(["#1", "#2", "#3", "#4", "#31", "#100", "#<a>", "#<b>", "#<_g>", "# < long_name >", "#[30+1]"])
    return f"{target}{rng.choice(['=', ' = '])}[{expression(rng)} mod 1000]"


def move(rng):
    def value():
        pick = rng.random()
        if pick < 0.5:
            return f"{rng.uniform(-20, 20):.3f}"
        return (
            rng.choice(["[", "[ "]) + f"{expression(rng, 2)}-{rng.randint(0, 9)}]"
            if pick < 0.9
            else f"-[{expression(rng)}]"
        )

    words = [f"{axis}{value()}" for axis in rng.sample("XYZABC", rng.randint(1, 3))]
    head = rng.choice(
        [[], ["G1"], ["G0"], ["G[1]"], ["G1", "F[100+#3]"], ["N9", "G1"], ["G90"], ["G91"], ["G0", setting(rng)]]
    )
    return " ".join([*head, *words, *rng.choice([[], [], ["(said)"], ["; said"], [setting(rng)]])])


OTHERS = [
    "", "(note)", "(MSG, hello)", "(DEBUG, #1 #<a>)", "(PRINT, #31)", "(LOGOPEN, x)", "(probeopen x)", "M8",
    "G4 P#31", "G92 X#1", "G92.1", "G54", "G55", "G10 L2 P1 X[#3]", "M70", "M72", "M73", "S#31", "T1", "M0", "G20",
    "G21", "G18", "G17", "G2 X[#<_x>+4] I2", "G3 R30 X[#<_x>+4]", "G81 X1 Z-2 R1", "X5", "G80", "G64 P.1",
    "G41.1 D2 G1 X#1", "G40", "#5399=1", "#5420=1", "#<_x>=1", "#5602=1", "#0=1", "#<a>=1 #<a>=2", "#7=#<a> #<a>=3",
    "#<q>=[exists[#<q>]+1]", "#<n>=#<n>", "X[1 2]", "X--1", "X[1/0]", "X[1", "Y#<never>", "o<none> call", "G43 H1",
    "G5.1 X1 Y1 I1 J1", "M98 P7", "G38.2 Z-5 F9", "#1=#5063", "/X1", "N5 X1", "G[0.5+0.5] X1", "M[2+1]", "F0", "G93",
    "G94", "G95",
]  # fmt: skip


class Program:
    """Grows line by line; labels are mostly used once."""

    def __init__(self, rng):
        self.rng = rng
        self.lines = []
        self.label = 0
        self.subs = []
        self.oddness = rng.choice([0.0, 0.0, 1.0])

    def say(self, line):
        if self.rng.random() < 0.03:
            line = "N1 " + line
        if self.rng.random() < 0.03:
            line = " \t" + line + " "
        self.lines.append(line)

    def o(self, label, keyword, rest=""):
        rng = self.rng
        letter = rng.choice("ooO")
        keyword = keyword if rng.random() < 0.9 else keyword.upper()
        gap = rng.choice([" ", " ", " ", "\t", "  "])
        self.say(f"{letter}{label}{gap}{keyword}{gap if rest else ''}{rest}{rng.choice(['', '', '', ' (c)', ' ; c'])}")

    def fresh(self):
        rng = self.rng
        if rng.random() < 0.05 * self.oddness and self.label:
            return str(rng.randint(1, self.label))
        self.label += 1
        return str(self.label) if rng.random() < 0.7 else f"<l{self.label}>"

    def block(self, depth, in_loop=None):
        for _ in range(self.rng.randint(1, 4)):
            self.statement(depth, in_loop)

    def statement(self, depth, in_loop):
        rng = self.rng
        pick = rng.random()
        if pick < 0.3 or depth == 0:
            self.say(move(rng))
        elif pick < 0.45:
            self.say(" ".join(setting(rng) for _ in range(rng.choice([1, 1, 1, 2, 3]))))
        elif pick < 0.47:
            self.say(
                rng.choice(OTHERS)
                if rng.random() < self.oddness
                else rng.choice(["", "(note)", "G90", "(MSG, a)", "M8"])
            )
        elif pick < 0.62:
            self.branch(depth, in_loop)
        elif pick < 0.85:
            self.loop(depth)
        elif pick < 0.95:
            name = rng.choice([*self.subs, *self.subs, "777", "<vis_square>"])
            arguments = " ".join(f"[{expression(rng, 2)}]" for _ in range(rng.randint(0, 4)))
            self.o(name, "call", arguments)
        elif in_loop is not None:
            label = self.fresh()
            self.o(label, "if", f"[#{rng.randint(1, 4)} GT {expression(rng, 1)}]")
            self.o(in_loop, rng.choice(["break", "continue"]))
            self.o(label, "endif")
        else:
            self.say(move(rng))

    def branch(self, depth, in_loop):
        rng, label = self.rng, self.fresh()
        self.o(label, "if", f"[{expression(rng, 2)} {rng.choice(OPERATORS[6:12])} {expression(rng, 2)}]")
        self.block(depth - 1, in_loop)
        while rng.random() < 0.3:
            self.o(label, "elseif", f"[{expression(rng, 2)}]")
            self.block(depth - 1, in_loop)
        if rng.random() < 0.5:
            self.o(label, "else")
            self.block(depth - 1, in_loop)
        self.o(label, "endif")

    def loop(self, depth):
        rng, label = self.rng, self.fresh()
        kind = rng.choice(["while", "do", "repeat"])
        counter, rounds = 40 + self.label, rng.randint(0, 5)
        self.say(f"#{counter}=0")
        if kind == "repeat":
            self.o(label, "repeat", f"[{rounds}]")
            self.block(depth - 1, None)
            self.o(label, "endrepeat")
            return
        test = f"[#{counter} LT {rounds}]"
        self.o(label, kind, test if kind == "while" else "")
        self.say(f"#{counter}=[#{counter}+1]")
        self.block(depth - 1, label)
        self.o(label, "endwhile" if kind == "while" else "while", "" if kind == "while" else test)

    def sub(self):
        rng = self.rng
        name = f"<s{len(self.subs)}>" if rng.random() < 0.7 else str(900 + len(self.subs))
        self.o(name, "sub")
        if rng.random() < 0.95:
            self.say("#<a>=#1 #<b>=6 #<long_name>=[#2 mod 50]")
        self.block(2, None)
        if rng.random() < 0.3:
            label = self.fresh()
            self.o(label, "if", f"[{expression(rng, 1)} GT #1]")
            if rng.random() < 0.5:
                self.o(name, "call", "[#1-1]")
            else:
                self.o(name, "return", rng.choice(["", "[#2]", "[1/3]"]))
            self.o(label, "endif")
        self.o(name, "endsub", rng.choice(["", "", "[#1+#2]", "[0]"]))
        self.subs.append(name)


def random_program(rng):
    """A program with all that the compiled lane knows of macros and some that it does not; mostly right."""
    program = Program(rng)
    program.lines += [
        rng.choice(["G21", "G20"]),
        "G90 G17 F100 S500 M3",
        "#1=1 #2=2.5 #3=3 #4=4 #<a>=1 #<b>=-2 #<_g>=7",
    ]
    program.lines += ["#<long_name>=.25 #<_h>=0 #31=12 #100=8", "G0 X0 Y0"]
    for _ in range(rng.randint(0, 3)):
        program.sub()
    program.block(3)
    program.block(3)
    program.block(3)
    return "\n".join([*program.lines, "M2"]) + "\n"


MACROS = {
    "nothing but numbers": "#1=5 #2=[#1*2] #3=[2**3**2-7/2 MOD 3]\nG1 X#1 Y[#2-#3] Z-#1\n"
    "X[#1 EQ 5] Y[#1 AND 0 OR 1 XOR 1]\n",
    "a parameter of a parameter": "#1=2 #2=3 #3=7\nG1 X##1 Y##[#1] Z#[#1+1]\n##1=9\nX#3\n",
    "what a line sets counts from the next": "#1=1\n#1=2 G1 X#1\nX#1 #1=[#1+1] #2=#1\nX#1 Y#2\n",
    "set twice": "#1=1 #1=2\nG1 X#1\n#<a>=1 #<a>=[5]\nX#<a>\n",
    "functions": "#1=[abs[-2]+acos[.3]+asin[.3]+cos[33]+exp[.7]+fix[-2.5]+fup[-2.5]+ln[3]]\nG1 X#1\n"
    "X[round[-2.5]+sin[33]+sqrt[2]+tan[33]+atan[1]/[-3]] Y[fix[-.5]] Z[round[-.3]]\n",
    "names": "#<Big Name>=4 #<_all>=5\nG1 X#<bigname> Y#<_ALL> Z[exists[#<big name>]+exists[#<no>]]\nX1\n",
    "positions": "G1 X3 Y4 Z5\nX[#<_x>+1] Y#5420 Z[#5422*2]\nG91 X#<_y>\nG90 A#<_feed> B#<_call_level>\n",
    "a spiral": "#1=0\no1 while [#1 LT 50]\nG1 X[#1*cos[#1*20]] Y[#1*sin[#1*20]]\n#1=[#1+1]\no1 endwhile\n",
    "arcs by expressions": "G0 X0 Y0\n#1=5\no1 repeat [4]\nG2 X[#<_x>+2*#1] I#1\n"
    "G3 X[#<_x>+2*#1] R[#1]\no1 endrepeat\n",
    "do": "#1=0\no1 do\nG1 X#1\n#1=[#1+1]\no1 while [#1 LT 4]\no2 do\nX9\no2 break\nX8\no2 while [1]\n"
    "o3 do\nX7\no3 while [0]\n",
    "break and continue": "#1=0\no1 while [#1 LT 9]\n#1=[#1+1]\no2 if [#1 EQ 3]\no1 continue\no2 endif\n"
    "o3 if [#1 EQ 6]\no1 break\no3 endif\nG1 X#1\no1 endwhile\nX99\n",
    "branches": "#1=0\no1 repeat [6]\n#1=[#1+1]\no2 if [#1 EQ 1]\nG1 X1\no2 elseif [#1 EQ 2]\nG1 X2\n"
    "o2 elseif [#1 LT 5]\nG1 X34\no2 else\nG1 X#1\no2 endif\no1 endrepeat\n",
    "calls that return values": "o<f> sub\no1 if [#1 LE 1]\no<f> return [1]\no1 endif\n#2=#1\no<f> call [#1-1]\n"
    "o<f> endsub [#2*#<_value>]\n#1=77\no<f> call [5]\nG1 X#<_value> Y#<_value_returned> Z#1\nX1\n",
    "names of a call": "o1 sub\n#<a>=[#1+1]\nG1 X#<a>\n#<_kept>=#<a>\no1 endsub\n#<a>=50\no2 repeat [3]\n"
    "o1 call [#<a>]\n#<a>=[#<a>+1]\no2 endrepeat\nG1 Y#<a> Z#<_kept>\n",
    "subroutines in files": "o3 repeat [4]\no777 call [8]\nG1 Y#<_value>\no<vis_square> call [#<_value>] [2]\n"
    "o3 endrepeat\n",
    "deep calls": "".join(
        f"o<s{n}> sub\nG1 X#{n + 1}\n{f'o<s{n - 1}> call [1] [2] [3] [#1]' if n else ''}\nY#{n + 1}\no<s{n}> endsub\n"
        for n in range(8)
    )
    + "o1 repeat [3]\no<s7> call [9]\no1 endrepeat\n",
    "a label of two subroutines": "o<a> sub\no1 repeat [2]\nG1 X1\no1 endrepeat\no<a> endsub\no<b> sub\n"
    "o1 repeat [3]\nG1 X2\no<a> call\no1 endrepeat\no<b> endsub\no1 repeat [2]\no<b> call\no1 endrepeat\n",
    "modes that come back": "o1 sub\nM73\nG91 G1 X1 F50\nX1\no1 endsub\no2 repeat [3]\no1 call\nG1 X[#<_x>+1]\n"
    "o2 endrepeat\n",
    "an M98 between": "o1 repeat [3]\nM98 P1000\nG1 X#1\no1 endrepeat\nM2\nO1000\n#1=[#1+1]\no2 repeat [2]\nG1 Y#1\n"
    "o2 endrepeat\nM99\n",
    "beside a contour": "#1=0\nG0 X-9 Y-9\nG41 D1 G1 X0 Y0\no1 while [#1 LT 6]\nX[#1*9+9] Y[[#1 MOD 2]*9]\n"
    "#1=[#1+1]\no1 endwhile\nG40 X99\n",
    "holes in a loop": "G0 Z9\nG81 X0 Z-2 R3\n#1=0\no1 while [#1 LT 5]\nX[#1*2] Y#1\n#1=[#1+1]\no1 endwhile\nG80\n",
}


@pytest.mark.parametrize("name", MACROS)
def test_macros_are_the_same_to_the_last_bit(name):
    stream = assert_same(HEAD + MACROS[name] + "M2\n")

    assert moves_in_batches(stream) >= 2


def test_a_loop_stays_in_the_compiled_lane():
    """What the lane is for: no line of the loop goes through the grammar's, so its moves come in few batches."""
    _, _, stream = both(HEAD + MACROS["a spiral"].replace("LT 50", "LT 5000") + "M2\n", max_blocks=10**6)
    batches = [item for item in stream if isinstance(item, MoveBatch)]

    assert sum(len(batch) for batch in batches) == 5000
    assert len(batches) <= 3


def test_calls_stay_in_the_compiled_lane():
    """Moves of several subroutines, in several files, stand in one batch."""
    text = "o<f> sub\nG1 X#1\no777 call [#1]\no<f> endsub\no1 repeat [500]\no<f> call [7]\nG1 X0\no1 endrepeat\nM2\n"
    batches = [item for item in assert_same(HEAD + text) if isinstance(item, MoveBatch)]

    assert max(len(batch.origins) for batch in batches) == 3
    assert {origin[0] for batch in batches for origin in batch.origins} == {"p.ngc", "777.ngc"}
    assert len(batches) <= 9


def test_budgets_end_both_lanes_at_the_same_block():
    text = "o<f> sub\nG1 X#1\n#2=[#1/3]\no<f> endsub\n#1=0\no1 while [1]\n#1=[#1+1]\no<f> call [#1]\no1 endwhile\nM2\n"
    for most in (*range(5, 40), 1000):
        assert_same(HEAD + text, max_blocks=most)


@pytest.mark.parametrize("lane", ["grammar", "compiled"])
def test_a_loop_without_moves_meets_the_clock(lane):
    text = "#1=0\no1 while [1]\n#1=[#1+1]\no1 endwhile\nM2\n"
    run = run_of(text, lane=lane, max_blocks=10**12, time_limit=0.1)

    assert list(run.stream())
    assert [finding.code for finding in run.findings] == ["GS135"]


def test_more_names_than_the_tables_hold():
    many = "".join(f"#<name{n}>={n} #<_name{n}>={n}\n" for n in range(1500))
    last = "G1 X[#<name3>+#<_name1400>]\nX#<name1499>\nY#<_name7>\n#<name3>=5\nX#<name3>\nM2\n"

    assert_same(HEAD + many + last)


def test_more_chains_of_callers_than_the_tables_hold():
    calls = "o<g> call\n" * 70
    text = f"o<g> sub\nG1 X#1\no<g> endsub\no<h> sub\n{calls}o<h> endsub\n" + "o<h> call\n" * 60 + "G1 X5\nM2\n"

    assert moves_in_batches(assert_same(HEAD + text)) > 4000


@pytest.mark.parametrize("line", OTHERS)
def test_a_line_in_a_loop_that_is_left_to_the_grammar(line):
    loop = f"o1 while [#1 LT 3]\nG1 X#1\n{line}\n#1=[#1+1]\no1 endwhile\n"

    assert_same(HEAD + f"#1=0 #3=3 #31=1\n#<a>=1\n{loop}G40 G80 G1 X9\nM2\n", max_blocks=500)


def test_random_programs():
    rng = random.Random(11)
    batched = 0
    for _ in range(60):
        batched += moves_in_batches(assert_same(random_program(rng), max_blocks=3000))
    assert batched > 250


def test_mutated_programs():
    rng = random.Random(12)
    for _ in range(60):
        assert_same(mutated(rng, random_program(rng)), max_blocks=3000)


@pytest.mark.slow
def test_many_random_and_mutated_programs():
    rng = random.Random(13)
    for _ in range(3000):
        text = random_program(rng)
        assert_same(text if rng.random() < 0.5 else mutated(rng, text), max_blocks=rng.choice([100, 3000]))
