"""Running: errors, recovery, bounds, feedback, and what the settings change."""

import pytest

from gcodesim import canon
from gcodesim.diagnostics import Severity, SourceText
from gcodesim.rs274 import MappedAction, Settings, ToolTable, canonical_m_code, interpret, lint, read_parameters

WRONG = """G21 G90
G0 X0 Y0 Z5
G1 Z0 F100
F300
G2 X10 Y0 I4
G1 X20
G1 Y5
G1 X30 Y
G1 X0
G0 Z5
G33.0 Z3
M2
"""


def test_a_program_with_three_mistakes_gives_exactly_three_errors(program):
    done = program(WRONG)

    assert [(f.code, f.span.line) for f in done.findings] == [("GS111", 5), ("GS004", 8), ("GS175", 11)]
    for number in ("4.000 mm", "6.000 mm", "2.000 mm"):
        assert number in done.findings[0].message
    assert "G0 Z3" in done.findings[2].hint
    assert done.run.failed_line == 5


def test_events_end_before_the_guilty_block(program):
    done = program(WRONG)

    assert max(event.span.line for event in done.raw) == 3


def test_a_skipped_block_causes_no_further_findings(program):
    """The arc of line 3 starts where the skipped line 2 would have led, as far as anybody can tell."""
    done = program("F100\nG1 X10 Y#<nothing>\nG2 X20 Y0 I5\nG1 X5\nM2")

    assert [f.span.line for f in done.errors] == [2]


def test_lint_gives_the_same_findings_as_a_run(program):
    assert list(lint(SourceText("p.ngc", WRONG.encode()))) == program(WRONG).findings


def test_after_a_fault_loops_and_calls_are_gone_through_once(program):
    """The counter in line 2 never grows; still the file is read to its end, and each fault is told once."""
    text = "o1 while [#1 LT 5]\n#1=[#1+1\no1 endwhile\nM98 P3 L3\no2 repeat [3]\nG0 Y\no2 endrepeat\nM2\nO3\nG0 X\nM99"
    done = program(text)

    assert [(f.code, f.span.line, f.count) for f in done.errors] == [("GS006", 2, 1), ("GS004", 6, 1), ("GS004", 10, 1)]


def test_a_subroutine_that_is_missing_hides_nothing_behind_its_call(program):
    """A control stops at the call; the reader goes on, names the next missing one and what else is wrong."""
    done = program("o100 call\nG0 X\no200 call\no3 if [1]\nG0 Y\nM2")

    assert [(f.code, f.span.line) for f in done.errors] == [("GS131", 1), ("GS004", 2), ("GS131", 3), ("GS004", 5)]
    assert done.run.failed_line == 6 and done.ends == []


def test_after_a_fault_each_subroutine_is_read_once(program):
    """Ten calls in each of ten subroutines would be 10**9 calls."""
    subs = "".join(f"o{n} sub\n" + f"o{n + 1} call\n" * 10 + f"o{n} endsub\n" for n in range(1, 9))
    done = program(f"{subs}o9 sub\nG0 X\no9 endsub\nG0 Y\no1 call\nM2")

    assert [(f.code, f.span.line, f.count) for f in done.errors] == [("GS004", 98, 1), ("GS004", 100, 1)]
    assert done.run.blocks < 300


def test_state_is_unchanged_by_a_guilty_block(program):
    """T is read before the fault of the block shows; still nothing of it stays."""
    done = program("T2 M6 G43 H77\nG0 Z1\nM6\nM2")

    assert done.errors[0].code == "GS160"
    assert done.acts("tool_change") == []


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_line_ends(program, end):
    assert program(end.join(["G0 X1", "G0 X2", "M2"])).ends == [[1, 0, 0], [2, 0, 0]]


@pytest.mark.parametrize(
    "raw", [b"\xef\xbb\xbfG0 X1\nM2", b"G0 X1 (f\xfcr)\nM2", b"G0\tX1\nM2", "G0 X1 (für)\nM2".encode()]
)
def test_encodings(program, raw):
    assert program(raw).ends == [[1, 0, 0]]


@pytest.mark.parametrize(
    ("text", "code", "line"),
    [
        ("G0 X1\nG0 X2", "GS010", 2),
        ("%\nG0 X1\n", "GS010", 2),
        ("G0 G1 X1", "GS011", 1),
        ("G34 X1", "GS012", 1),
        ("G1.5 X1", "GS012", 1),
        ("M12", "GS013", 1),
        ("M3 M8 M49 M6 M0 T1", "GS014", 1),
        ("X1", "GS101", 1),
        ("G0 G92 X1", "GS102", 1),
        ("G92", "GS103", 1),
        ("G0 X1 P2", "GS104", 1),
        ("G4", "GS105", 1),
        ("M19 R400", "GS106", 1),
        ("G1 X1", "GS107", 1),
        ("G95 F0.1\nG1 X1", "GS108", 2),
        ("G91\nG53 G0 X1", "GS109", 2),
        ("F1\nG2 X1 R1 I1", "GS110", 2),
        ("F1\nG2 X10 R4", "GS112", 2),
        ("G0 X#<a>", "GS120", 1),
        ("#0=1", "GS121", 1),
        ("#5420=1", "GS122", 1),
        ("G0 X[1/0]", "GS123", 1),
        ("G0 X[EXP[1000]]", "GS123", 1),
        ("o1 endif", "GS130", 1),
        ("o9 call", "GS131", 1),
        ("F1\nG82 X1 Z-1 R1", "GS140", 2),
        ("T1 M6 F9\nG41 G1 X9\nG55", "GS150", 3),
        ("G19\nG41 D1", "GS153", 2),
        ("T55", "GS160", 1),
        ("F1\nG5 X1 I1 P1 Q1", "GS170", 2),
        ("F1\nG38.2 X0", "GS180", 2),
        ("G18\nG0 @1 ^1", "GS185", 2),
        ("(abort,no)", "GS190", 1),
        ("M72", "GS191", 1),
    ],
)
def test_each_fault_has_its_code_and_line(program, text, code, line):
    done = program(text if "GS010" in code else text + "\nM2")

    assert (done.errors[0].code, done.errors[0].span.line) == (code, line)
    assert done.errors[0].span.column >= 1


def test_an_endless_loop_is_named(program):
    done = program("G0 X1\no1 while [1]\n#1=[#1+1]\no1 endwhile\nM2", max_blocks=500)

    assert done.errors[0].code == "GS134"
    assert done.errors[0].span.line == 2


def test_endless_recursion_is_named(program):
    done = program("o1 sub\no1 call\no1 endsub\no1 call\nM2")

    assert done.errors[0].code == "GS132"
    assert len(done.errors[0].span.callers) == 9


@pytest.mark.parametrize("raw", [bytes(range(256)) * 40, b"\x00" * 5000, b"[" * 100_000, b"o1 call\n" * 50, b"G" * 300])
def test_what_is_no_program_gives_findings_and_no_traceback(program, raw):
    assert program(raw, max_blocks=2000).errors


def test_a_finding_in_a_subroutine_names_its_callers(program, tmp_path):
    (tmp_path / "hole.ngc").write_text("o<hole> sub\nG1 X1\no<hole> endsub\nM2\n")
    error = program("G0 Z1\no<hole> call\nM2", subroutines=(tmp_path,)).errors[0]

    assert (error.span.file, error.span.line) == ("hole.ngc", 2)
    assert [(c.file, c.line, c.name) for c in error.span.callers] == [("p.ngc", 2, "o<hole>")]


def test_mapped_m_codes_become_actions(program):
    codes = {
        "M10": MappedAction(target="tool", verb="activate"),
        "M62 P1": MappedAction(target="gripper", verb="close"),
    }
    done = program("M10\nM62 P1\nM62 P2\nM2", m_codes=codes, has_cell=True)

    assert [(e["m"], e["verb"]) for e in done.acts("action")] == [(10, "activate"), (62, "close")]
    assert [e["index"] for e in done.acts("output")] == [2]
    assert list(done.run.not_simulated) == ["M62 P2"]


def test_user_m_codes_need_a_cell(program):
    assert program("M100\nM2").errors[0].code == "GS013"
    with_cell = program("M8\nM100\nM8\nM2", has_cell=True)
    assert not with_cell.errors
    assert with_cell.run.not_simulated["M8"][0] == 2
    assert {f.level for f in with_cell.findings} == {Severity.NOTE}


def test_tool_length_is_taken_along_when_the_program_never_says_g43(program):
    done = program("T1 M6\nG0 Z0\nM2", auto_length={1: 0.06})

    assert done.acts("tool_offset")[0]["offset"][2] == 60
    assert [f.code for f in done.findings] == ["GS195"]
    assert program("T1 M6\nG0 Z0\nM2", auto_length={1: 0.06}, tool_length="strict").acts("tool_offset") == []
    assert len(program("T1 M6\nG49\nG0 Z0\nM2", auto_length={1: 0.06}).acts("tool_offset")) == 1


def test_a_probe_takes_feedback():
    run = interpret(SourceText("p.ngc", b"F50\nG0 Z10\nG38.2 Z-5\nG91 G0 Z5\nM2"), Settings())
    events = iter(run)
    seen = []
    reply = None
    while True:
        try:
            event = events.send(reply)
        except StopIteration:
            break
        seen.append(event)
        reply = (0.0, 0.0, 0.002, 0.0, 0.0, 0.0) if isinstance(event, canon.ProbeMove) else None

    rapids = [e for e in seen if isinstance(e, canon.Rapid)]
    assert rapids[-1].end[2] == pytest.approx(0.007)
    assert run.parameters[5063] == pytest.approx(2.0)


def test_a_home_that_was_never_stored_is_named(program):
    rapids = [e for e in program("G28\nG28.1\nG28\nM2").raw if isinstance(e, canon.Rapid)]

    assert [e.home for e in rapids] == ["G28", ""]


def test_the_work_system_is_said_at_the_start_and_on_change(program):
    systems = program("G10 L2 P1 X5\nG55\nG92 X1\nM2").acts("work_system")

    assert [(s["index"], s["offset"][0], s["g92"][0]) for s in systems] == [
        (1, 0, 0),
        (1, 5, 0),
        (2, 0, 0),
        (2, 0, -1),
        (1, 5, -1),
    ]


def test_initial_path_control(program):
    assert program("G0 X1\nM2", path_control="G64 P0.02").acts("path_mode")[0]["tolerance"] == 0.02


def test_canonical_m_codes():
    assert canonical_m_code("m062p1.0") == "M62 P1"
    assert canonical_m_code(" M 8 ") == "M8"
    with pytest.raises(ValueError, match="no M-code"):
        canonical_m_code("G1")


def test_tool_table_file():
    table, findings = ToolTable.read(SourceText("tool.tbl", b"T1 P1 Z50.0 D6.0 ;mill\nT2 Q\n;only\nT1 Z1\n"))

    assert table[1].offset[2] == pytest.approx(0.05)
    assert table[1].diameter == pytest.approx(6e-3)
    assert [(f.code, f.span.line) for f in findings] == [("GS020", 2), ("GS020", 4)]


def test_parameter_file():
    values, findings = read_parameters(SourceText("a.var", b"5221\t100.5\n31 -2\nx 3\n29999 1\n5 1_0\n"))

    assert values == {5221: 100.5, 31: -2.0}
    assert [f.span.line for f in findings] == [3, 4, 5]


def test_a_tool_works_without_its_length_where_only_g49_is_said(program):
    def told(text, **settings):
        return [f.span.line for f in program(text, auto_length={1: 0.06, 2: 0.0}, **settings).findings]

    assert told("G49\nT1 M6\nG0 Z0\nT2 M6\nG0 Z0\nM2") == [2]
    assert told("G49\nT1 M6\nG43 H1\nG0 Z0\nM2") == []
    assert told("G49\nT1 M6\nG0 Z0 (never g43)\nM2") == [2]
    assert told("G49\nT1 M6\nG0 Z0\nM2", tool_length="strict") == []


def test_one_cause_is_one_finding(program) -> None:
    done = program("G0 X1\nM438\nG1 X2\nX3\nM438\nX4\nM2\n")

    assert [(f.code, f.span.line, f.count) for f in done.errors] == [("GS013", 2, 2), ("GS107", 3, 3)]


def test_a_file_that_is_a_subroutine_needs_no_end() -> None:
    from gcodesim.diagnostics import SourceText
    from gcodesim.rs274 import Settings, lint

    text = b"(along X)\no<along> sub\nG1 X[#1 F100\nG1 Y#2 Q\no<along> endsub\n; and so on\n"
    assert [(f.code, f.span.line) for f in lint(SourceText("along.ngc", text))] == [("GS006", 3), ("GS004", 4)]
    assert not list(lint(SourceText("along.ngc", b"o<along> sub\nG1 X#1 F9\no<along> endsub\n")))
    for name, body in (
        ("other.ngc", b"o<along> sub\nG1 X#1 F9\no<along> endsub\n"),
        ("along.ngc", b"o<along> sub\nG1 X#1 F9\no<along> endsub\nG0 X1\n"),
    ):
        assert [f.code for f in lint(SourceText(name, body))] == ["GS010"]
    within = Settings(has_cell=True)
    assert [f.code for f in lint(SourceText("along.ngc", b"o<along> sub\no<along> endsub\n"), within)] == ["GS010"]


@pytest.mark.parametrize(
    ("dialect", "called", "text"),
    [
        ("linuxcnc", "hole.ngc", "o<hole> sub\nG0 X1\no<hole> endsub\nM2\n"),
        ("fanuc", "O0020.nc", "O0020\nG0 X1\nM99\n"),
    ],
)
def test_a_subroutine_is_looked_for_beside_its_program(tmp_path, dialect, called, text):
    call = "o<hole> call" if dialect == "linuxcnc" else "M98 P20"
    (tmp_path / "main.nc").write_text(f"G21 G90\n{call}\nM30\n")
    source = SourceText.read(tmp_path / "main.nc")

    def errors(**more):
        found = lint(source, Settings(dialect=dialect, **more))
        return [(f.code, f.span.file) for f in found if f.level >= Severity.ERROR]

    assert errors() == [("GS131", "main.nc")]
    (tmp_path / called).write_text(text)
    assert not errors()
    (tmp_path / "own").mkdir()
    (tmp_path / "own" / called).write_text(text.replace("X1", "Y"))
    assert {file for _, file in errors(subroutines=(tmp_path / "own",))} == {called}  # a given folder comes first


def test_after_a_typo_what_is_certain_again_is_judged_again(program):
    """X is not known behind line 2; an arc from there is no fault for sure, the next ones are, as X is named again."""
    done = program("G21 G90 F100\nG1 X1..5\nG2 X10 I5\nG1 X20 Y0\nG2 X30 Y0 I1\nG0 X0\nG2 X5 I1\nM2")

    assert [(f.code, f.span.line) for f in done.errors] == [("GS005", 2), ("GS111", 5), ("GS111", 7)]


def test_a_feed_that_is_named_again_is_missed_no_more(program):
    done = program("G21 G90\nG1 X1 F\nG1 X2\nG1 X3 F100\nG93\nG1 X4\nM2")

    assert [(f.code, f.span.line) for f in done.errors] == [("GS004", 2), ("GS107", 6)]


def test_values_of_the_ini_file_are_read_only(program):
    done = program("G21\n#<_ini[axis_x]max> = 1\nM2")
    assert [(f.code, f.span.line, f.span.column) for f in done.errors] == [("GS122", 2, 1)]
    given = {"_ini[axis_x]max": 7.0}
    assert program("G21\nG0 X#<_ini[axis_x]max>\nM2", presets=given).ends == [[7, 0, 0]]
    assert [f.code for f in program("#<_ini[axis_x]max> = 1\nM2", presets=given).errors] == ["GS122"]
    assert [f.code for f in program("#<_hal[a.b]> = 1\nM2").errors] == ["GS122"]
    assert not program("#<_initial> = 1\nM2").findings


def test_r_of_g64_is_told_and_changes_no_path(program):
    done = program("G21\nG64 P0.01 R0.5\nG1 X1 F100\nM2")
    (note,) = done.findings
    assert (note.code, note.span.line, note.span.column) == ("GS913", 2, 11)
    assert "2.9 refuses it" in note.hint
    assert done.acts("path_mode") == program("G21\nG64 P0.01\nG1 X1 F100\nM2").acts("path_mode")
    assert "GS913" not in [f.code for f in program("M3 S100\nG64 R1 M19\nM2").findings]  # the angle of the spindle


@pytest.mark.parametrize("lane", ["grammar", "compiled"])
def test_a_subroutine_inside_a_called_one_is_executed_in_passing_and_told(program, tmp_path, lane):
    """LinuxCNC 2.9: the inner `endsub` returns from the outer one, as interp_o_word.cc has it; 2.10 refuses."""
    (tmp_path / "outer.ngc").write_text("o<outer> sub\nG0 X1\no<b> sub\nG0 X2\no<b> endsub\nG0 X3\no<outer> endsub\n")
    done = program("G21\no<outer> call\nG0 X9\nM2", subroutines=(tmp_path,), lane=lane)

    assert [end[0] for end in done.ends] == [1, 2, 9]
    (warning,) = done.findings
    assert (warning.code, warning.level, warning.span.file, warning.span.line) == (
        "GS130",
        Severity.WARNING,
        "outer.ngc",
        3,
    )
