"""Conditions, loops, variables and expressions of RepRapFirmware."""

from __future__ import annotations

import math

import pytest

from gcodesim.canon.listing import as_json
from gcodesim.diagnostics import Severity, SourceText
from gcodesim.formatting import formatted
from gcodesim.formatting.style import Style
from gcodesim.rs274 import Settings, ToolTable, interpret, lint
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.incremental import LiveReading
from gcodesim.rs274.marlin.duet.syntax import parsed
from gcodesim.rs274.marlin.duet.values import evaluate, shown


class Nobody:
    def value(self, path):
        raise Fault("GS120", f"{path} has no value")

    def exists(self, path):
        return False


def value_of(text):
    node, end = parsed(text)
    assert not text[end:].strip()
    return evaluate(node, Nobody())


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1 + 2 * 3 - 4 / 8", 6.5),
        ("(1 + 2) * {3}", 9),
        ("7 - 2 - 1", 4),
        ("-2 * -3", 6),
        ("1 < 2 && 2 <= 2 && !(3 = 4)", True),
        ("1 = 1.0", True),
        ("1 != 2 == true", True),  # from left to right, since both have one priority
        ("true || nobody.asks", True),
        ("false & nobody.asks", False),
        ("1 > 2 ? nobody.asks : 3 > 2 ? 4 : 5", 4),
        ('"a" ^ 1 + 2 ^ 1.5 ^ true ^ null', "a31.5truenull"),
        ('"say ""yes"""', 'say "yes"'),
        ('#"four"', 4),
        ("#vector(3, 0)", 3),
        ("max(1, 7, 3) + min({4, 2})", 9),
        ("mod(-7, 3)", -1),
        ("mod(7.5, 2)", 1.5),
        ("pow(2, 10) + square(3) + sqrt(16)", 1037.0),
        ("floor(-1.5) + ceil(1.2) + round(2.5) + round(-2.5)", 0),
        ("degrees(atan2(1, 1))", 45.0),
        ("cos(radians(60))", 0.5),
        ("0x10 + 1e1", 26.0),
        ("null = null", True),
        ("null = 0", False),
        ("exists(var.a)", False),
    ],
)
def test_values(text, value):
    found = value_of(text)
    assert found == (pytest.approx(value, abs=1e-12) if type(value) is float else value)
    assert type(found) is type(value)


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("1 +", "GS006"),
        ("(1", "GS006"),
        ("{1, 2", "GS006"),
        ("1 ? 2", "GS006"),
        ("true ? 2", "GS006"),
        ("nothing(1)", "GS006"),
        ("sin(1, 2)", "GS006"),
        ("random(6)", "GS120"),
        ("1 && true", "GS123"),
        ("1 + true", "GS123"),
        ('1 = "1"', "GS123"),
        ("1 / 0", "GS123"),
        ("sqrt(-1)", "GS123"),
        ("acos(2)", "GS123"),
        ("log(0)", "GS123"),
        ("exp(1e6)", "GS123"),
        ("2147483647 + 2", "GS123"),
        ("vector(100000000, 0)", "GS123"),
    ],
)
def test_what_has_no_value_is_a_fault(text, code):
    with pytest.raises(Fault) as caught:
        value_of(text)
    assert caught.value.code == code


def test_shown_as_the_firmware_writes_it():
    assert shown((1, 0.1 + 0.2, "a", False)) == "[1,0.3,a,false]"


@pytest.fixture
def duet(program):
    def run(text, **settings):
        return program(text, dialect="reprapfirmware", **{"tool_table": ToolTable(), **settings})

    return run


def xs(done):
    assert not done.errors, done.errors
    return [end[0] for end in done.ends]


@pytest.mark.parametrize(("n", "ends"), [(1, [1, 5]), (2, [2, 5]), (3, [3, 5]), (4, [4, 5])])
def test_one_branch_is_taken(duet, n, ends):
    text = (
        f"var n = {n}\nif var.n = 1\n  G1 X1\nelif var.n = 2\n\tG1 X2\nelif var.n = 3\n  G1 X3\nelse\n  G1 X4\nG1 X5\n"
    )
    assert xs(duet(text)) == ends


def test_blocks_nest_and_comments_end_none(duet):
    text = "if true\n  if false\n    G1 X1\n; not indented\n\n    G1 X2\n  else\n    G1 X3\n  G1 X4\nelse\n  G1 X5\n"
    assert xs(duet(text)) == [3, 4]


def test_loops(duet):
    inner = "  while true\n    if iterations = 2\n      break\n    G1 X{10 + iterations}\n"
    text = f"G1 X9\nwhile iterations < 3\n  G1 X{{iterations}}\n{inner}"
    assert xs(duet(text)) == [9, 0, 10, 11, 1, 10, 11, 2, 10, 11]
    text = "while iterations < 4\n  if mod(iterations, 2) = 0\n    continue\n  G1 X{iterations}\nG1 X9\n"
    assert xs(duet(text)) == [1, 3, 9]
    assert xs(duet("while false\n  G1 X1\nG1 X2\n")) == [2]


def test_variables_live_as_long_as_their_block(duet):
    text = (
        "global far = 1\nvar a = 1\nwhile iterations < 2\n  var b = iterations\n  set var.a = var.a + var.b\n"
        "  set global.far = {var.b, 5}\nG1 X{var.a + global.far[1]}\n"
    )
    assert xs(duet(text)) == [7]
    gone = duet(text + "G1 X{var.b}\n")
    assert [(f.code, f.span.line, f.span.column, f.span.end_column) for f in gone.errors] == [("GS120", 8, 5, 12)]


def test_elements_of_arrays(duet):
    assert xs(duet("var a = vector(2, {1, 2})\nset var.a[1][0] = 8\nG1 X{var.a[0][0]}\nG1 X{var.a[1][0]}\n")) == [1, 8]
    (fault,) = duet("var a = vector(2, 0)\nset var.a[2] = 8\n").errors
    assert (fault.code, fault.message) == ("GS123", "var.a has no element [2]")


def test_expressions_in_words_keep_the_places_of_the_others(duet):
    done = duet("var a = 2\nG1 X{var.a * 3} Y-{1} E.5 F{600}\nG1 X{var.a} Y?\n")
    assert done.ends[0] == [6, -1, 0]
    assert [(f.code, f.span.line, f.span.column) for f in done.errors] == [("GS001", 3, 14)]


def test_words_may_be_computed_without_any_command(duet):
    assert xs(duet("G1 X{2 * 3} F600\n")) == [6]


def test_echo_and_messages(duet):
    done = duet('echo "a;b", 1 + 1 ; said\necho >"file.g" "G1"\nM117 {"n" ^ 3}\n')
    assert [e["text"] for e in done.acts("print", "message")] == ["a;b 2", "n3"]
    assert "echo >" in done.run.not_simulated


def test_abort_ends_the_program(duet):
    done = duet('G1 X1\nif 1 < 2\n  abort "enough"\nG1 X2\n')
    assert [(f.code, f.message) for f in done.errors] == [("GS190", "the program asks to stop: enough")]
    assert [end[0] for end in done.ends] == [1]


def test_what_only_the_printer_knows_is_told_and_its_block_passed_over(duet):
    done = duet("G92 X7\nif sensors.gpIn[0].value = 1\n  G1 X{nobody.knows}\nG1 X2\nG1 X{heat.heaters[0].current}\n")
    assert [(f.code, f.span.line) for f in done.errors] == [("GS120", 2), ("GS120", 5)]
    assert "`sensors.gpIn[0].value` is a value of the printer" in done.errors[0].message
    assert xs(duet("G92 X7\nG1 X{move.axes[0].userPosition + 1}\nG1 X{state.currentTool}\n")) == [
        1,
        -7,
    ]  # from machine zero


@pytest.mark.parametrize(
    ("text", "code", "line"),
    [
        ("else\n  G1 X1\n", "GS130", 1),
        ("if true\n  break\n", "GS130", 2),
        ("continue\nvar a = 1\n", "GS130", 1),
        ("var a = 1\nvar a = 2\n", "GS130", 2),
        ("set var.a = 2\n", "GS120", 1),
        ("var 1 = 2\n", "GS007", 1),
        ("set a = 2\n", "GS007", 1),
        ("if 1\n  G1 X1\n", "GS123", 1),
        ("if true false\n  G1 X1\n", "GS006", 1),
        ("var a = 1\nif true\n  G1 X1\nelse if true\n  G1 X1\n", "GS006", 4),
        ("IF true\n", "GS001", 1),
        ("var a = 1\nG1 X{var.a\n", "GS006", 2),
        ("var a = " + "(" * 5000 + "1\n", "GS123", 1),
        ('var a = 1\nG1 X{"a"}\n', "GS123", 2),
        ("var a = 1\nG1 X{null}\n", "GS123", 2),
    ],
)
def test_faults_have_their_line(duet, text, code, line):
    errors = duet(text).errors
    assert (errors[0].code, errors[0].span.line) == (code, line)


def test_a_loop_without_end_is_noticed(duet):
    done = duet("while true\n  G1 X1\n  G1 X2\n")
    assert [(f.code, f.level) for f in done.errors] == [("GS134", Severity.ERROR)]
    counting = duet("while iterations >= 0\n  G4 P0\n", max_blocks=5000)
    assert [f.code for f in counting.errors] == ["GS134"]


def test_after_a_fault_each_loop_is_read_once(duet):
    done = duet("set var.a = 1\nwhile true\n  G1 X{var.b}\n  while true\n    G1 X{var.c}\n    continue\nG1 X?\n")
    assert [(f.code, f.span.line, f.count) for f in done.errors] == [
        ("GS120", 1, 1),
        ("GS120", 3, 1),
        ("GS120", 5, 1),
        ("GS001", 7, 1),
    ]


def test_sines_are_those_of_the_library():
    assert value_of("sin(1)") == pytest.approx(math.sin(1), abs=1e-15)


DECIDES = "if 1 < 2\n    G1 X1   Y2 F600\n"


def test_fmt_leaves_a_program_that_decides_as_it_is():
    text = f"{DECIDES}g1 X{{1}}\n"
    settings = Settings(dialect="reprapfirmware")
    assert formatted(SourceText("p.g", text.encode()), settings, Style()).program.raw == text.encode()
    lonely = formatted(SourceText("p.g", b"g1  X{1 + 1}  y2\ng1  x3\n"), settings, Style()).program.raw
    assert lonely == b"g1  X{1 + 1}  y2\nG1 X3\n"


def test_nobody_can_begin_inside():
    source = SourceText("p.g", f"{DECIDES}G1 X5\nG1 X6\n".encode())
    run = interpret(source, Settings(dialect="reprapfirmware", until=4))
    list(run)
    assert run.halted is not None
    assert "the program has variables, conditions or loops" in next(iter(run.halted.own_obstacles(4)))


def test_an_edited_program_is_read_as_a_new_one():
    settings = Settings(dialect="reprapfirmware")
    plain = ["G1 X1 F600", *["G1 X2", "G1 X1"] * 300]
    decides = ["var a = 1", *plain, "while iterations < 3", "  set var.a = var.a + 1", "G1 X{var.a}"]
    broken = [*decides[:-2], "  set var.a = var.b", *decides[-1:]]
    reading = LiveReading(SourceText("p.g", "\n".join(plain).encode()), settings)
    for lines in (plain, decides, broken, plain, decides):
        source = SourceText("p.g", "\n".join(lines).encode())
        reading.update(source)
        reading.finish()
        assert [(f.code, f.span, f.message) for f in reading.findings] == [
            (f.code, f.span, f.message) for f in lint(source, settings)
        ]
        state = reading.executor.control.state
        fresh = interpret(source, settings)
        ends = [event for event in fresh if hasattr(event, "end")]
        assert lines is broken or state.current[0] == pytest.approx(1e3 * ends[-1].end[0])


def test_plain_moves_outside_of_blocks_may_be_read_as_columns():
    plain = "".join(f"G1 X{n % 7} Y{n % 5} E0.0{n % 9}\n" for n in range(300))
    loop = "while iterations < 3\n  G1 X{iterations} Y9\n  G1 X8\n  G1 Y8\nG1 X7\n"
    choice = "if false\n  G1 X1\n  G1 X2\nelse\n  G1 X3\n  G1 X4\nG1 X5\n"
    text = f"M83\nvar a = 1\n{plain}{loop}{plain}{choice}{plain}  var b = 2\n  G1 X{{var.b}}\n{plain}{loop}"
    source = SourceText("p.g", text.encode())
    runs = {lane: interpret(source, Settings(dialect="reprapfirmware", lane=lane)) for lane in ("grammar", "compiled")}
    told = {lane: [as_json(event) for event in run] for lane, run in runs.items()}

    assert told["compiled"] == told["grammar"] and len(told["grammar"]) > 1200
    assert not runs["compiled"].findings.has_errors()
