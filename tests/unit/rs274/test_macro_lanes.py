"""Expressions, parameters, loops and calls say the same in both lanes: events, findings, memory."""

import random

import pytest

from tests.unit.rs274.lanes import assert_same, moves_in_batches, mutated

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
        elif pick < 0.95 and self.subs:
            name = rng.choice(self.subs)
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
