"""A program in an editor: meanings, places, names, and the findings of `lint`."""

import json
import re
import sys
from pathlib import Path

import pytest
from markdown_it import MarkdownIt

sys.path.insert(0, str(Path(__file__).parent))

from documents import CELL, PROGRAM, at, program

from gcodesim.cli import main
from gcodesim.diagnostics.show import as_json
from gcodesim.editor.completion import offers
from gcodesim.editor.fixes import fixes_of
from gcodesim.editor.hover import hover
from gcodesim.editor.outline import parts_of
from gcodesim.editor.parameters import CannotRenameError, renamed
from gcodesim.editor.program_document import Choices, ProgramDocument
from gcodesim.editor.targets import target_of
from gcodesim.numbers import clean
from gcodesim.regress.programs import programs_in

DATA = Path(__file__).parents[2] / "data/programs"


def text_at(document, needle, nth=0):
    return hover(document, *at(document.source.text, needle, nth)).text


def test_hover_tells_what_a_word_means_and_what_its_line_does(tmp_path):
    document = program(tmp_path)

    assert text_at(document, "G1 Z").startswith("**G1** straight move at feed")
    assert "F0 → F200" in text_at(document, "G1 Z")
    assert "line " in text_at(document, "G1 Z")
    assert "(of G0): " not in text_at(document, "X10")
    assert text_at(document, "X10").startswith("**X10** end of the move along X (of G0)")
    assert "none → T1 (Schlichter, flat_end_mill)" in text_at(document, "T1 M6")
    assert r"**#\<depth>** is 3" in text_at(document, "#<depth> F200")
    assert "**#100** is not set, then 5" in text_at(document, "#100=5") or "is 0, then 5" in text_at(document, "#100=5")


def test_names_of_a_stranger_are_no_markdown(tmp_path):
    """An editor would load the picture of another host, and offer the command as a link."""
    name = "[go](command:x) ![y](http://evil.example/y) <img/src=//evil.example> `a`|\\n# b"
    cell = CELL.replace("Schlichter", f'"{name}"')
    text = "T1 M6\n#<[go](command:x)>=1\no<![y](//evil)> sub\no<![y](//evil)> endsub\nM2\n"
    document = program(tmp_path, text, cell)

    shown = [hover(document, line, column).text for line in range(4) for column in (1, 3, 8)]
    assert any("/evil.example/" in text for text in shown)
    for text in shown:
        page = MarkdownIt("commonmark").enable("table").render(text)
        assert set(re.findall(r"<(\w+)", page)) <= {
            "p",
            "strong",
            "table",
            "thead",
            "tbody",
            "tr",
            "th",
            "td",
            "pre",
            "code",
        }
        assert "|" not in re.sub(r"`a`\|", "", page)


def test_hover_in_a_faulty_line_and_in_none(tmp_path):
    document = program(tmp_path, "G0 X1\nG1 X\n\nM2\n")

    assert hover(document, 1, 3) is None
    assert hover(document, 2, 0) is None
    assert hover(document, 77, 0) is None


@pytest.mark.parametrize(
    ("dialect", "text", "meaning"),
    [
        ("fanuc", "G65 P2 A1.", "**G65** call macro P once"),
        ("fanuc_lathe", "G71 U1. R1.", "**G71** rough along Z to the contour of blocks P to Q"),
        ("marlin", "M104 S200", "**M104** heat the nozzle to S, and go on"),
        ("linuxcnc", "G33.1 Z-1 K1", "**G33.1** rigid tapping"),
    ],
)
def test_codes_of_each_dialect(tmp_path, dialect, text, meaning):
    document = program(tmp_path, f"{text}\nM30\n", cell="", dialect=dialect)

    assert hover(document, 0, 1).text.startswith(meaning)


def names(document, text, column=None):
    lines = document.source.text.split("\n")
    return [one.text for one in offers(document, lines.index(text), len(text) if column is None else column)]


def test_offers(tmp_path):
    document = program(tmp_path, f"{PROGRAM}G4\nT\nX#\nX#<\no<\no7 \nG1 (X\n")

    assert {"G4", "G43.1", "G90"} <= set(names(document, "G4"))
    assert names(document, "T") == ["T1", "T12"]
    assert {"100", "<depth>", "<_x>"} <= set(names(document, "X#"))
    assert names(document, "o<") == ["<hole>"]
    assert {"while", "call", "sub"} <= set(names(document, "o7 "))
    assert names(document, "G1 (X") == []


def test_where_words_lead(tmp_path):
    document = program(tmp_path)
    text = document.source.text

    assert target_of(document, *at(text, "o<HOLE>")).range.line == at(text, "o<hole> sub")[0]
    tool = target_of(document, *at(text, "T12"))
    assert (tool.path.name, tool.range.line) == (
        "cell.yaml",
        CELL.splitlines().index("  12: {type: flat_end_mill, diameter: 10 mm}"),
    )
    assert target_of(document, *at(text, "#100]")).range.line == at(text, "#100=5")[0]
    assert target_of(document, *at(text, "#<depth> F200")).range.line == at(text, "#<depth>=[")[0]
    assert target_of(document, *at(text, "G21")) is None


def test_where_a_subroutine_in_a_file_of_its_own_is(tmp_path):
    (tmp_path / "deep.ngc").write_text("(a comment)\no<deep> sub\nG0 X1\no<deep> endsub\nM2\n")
    document = program(tmp_path, "o<deep> call\nM2\n")
    found = target_of(document, 0, 3)

    assert (found.path, found.range.line) == (tmp_path / "deep.ngc", 1)


def test_where_goto_and_m98_lead(tmp_path):
    text = "O1\nN5 G0 X1.\nIF [1 EQ 0] GOTO 5\nM98 P200\nM30\nO0200\nM99\n"
    document = program(tmp_path, text, cell="", dialect="fanuc")

    assert target_of(document, *at(text, "GOTO")).range.line == 1
    assert target_of(document, *at(text, "P200")).range.line == 5


def test_outline(tmp_path):
    parts = [(one.kind, one.name, one.line, one.last) for one in parts_of(program(tmp_path))]

    assert ("comment", "pocket", 0, 1) in parts
    assert ("tool", "T1 finisher", 2, 10) in parts
    assert ("subroutine", "o<hole>", 7, 10) in parts
    assert ("comment", "holes", 11, 13) in parts


def test_rename_stays_in_its_subroutine(tmp_path):
    document = program(tmp_path)
    text = document.source.text
    inside = renamed(document, *at(text, "#<depth>=["), "deep")
    outside = renamed(document, *at(text, "#<depth>=2"), "<deep>")
    numbered = renamed(document, *at(text, "#100=5"), "#101")

    assert [(place.line, new) for place, new in inside] == [(8, "<deep>"), (9, "<deep>")]
    assert {place.line for place, _ in numbered} == {6, 12, 16}
    assert {place.line for place, _ in outside} == {5, 16}
    for wrong in ("_all", "<a#b>", ""):
        with pytest.raises(CannotRenameError):
            renamed(document, *at(text, "#<depth>=2"), wrong)
    with pytest.raises(CannotRenameError, match="another parameter"):
        renamed(document, *at(text, "#100=5"), "1")


def test_fixes(tmp_path):
    for wrong, right in (
        ("GO X1\nM2\n", "G0 X1\nM2\n"),
        ("G0 X1 (a\nM2\n", "G0 X1 (a)\nM2\n"),
        ("G0 X1\n", "G0 X1\nM2\n"),
    ):
        document = program(tmp_path, wrong)
        (fix,) = [fix for finding in document.findings for fix in fixes_of(finding, document.source)]
        lines = wrong.split("\n")
        line = lines[fix.range.line]
        lines[fix.range.line] = line[: fix.range.column] + fix.text + line[fix.range.end_column :]
        assert "\n".join(lines) == right


def test_a_changed_cell_is_read_again(tmp_path):
    document = program(tmp_path)
    assert not any(one.code == "GS141" for one in document.findings)
    (tmp_path / "cell.yaml").write_text(CELL.replace("12:", "13:"))
    document.look_at_cell()
    document.go_on(1_000)

    assert [one.span.line for one in document.findings if one.level.word == "error"]


def findings_agree(tmp_path, capsys, cell, step):
    """Faulty and clean programs of the tests, as `lint` reports them."""
    paths = [path for folder in ("broken", "clean") for path in programs_in(DATA / folder)]
    beside = tmp_path / "mill.yaml"
    beside.write_text(CELL)
    count = 0
    for path in paths[::step]:
        if path.stat().st_size > 30_000:
            continue
        options = ["--cell", str(beside)] if cell else []
        capsys.readouterr()
        main(["lint", str(path), "--format", "json", *options])
        expected = json.loads(capsys.readouterr().out)["findings"]
        if not path.read_bytes().isascii() or b"\r" in path.read_bytes():
            continue  # an editor has the text in its own encoding
        document = ProgramDocument(path, path.read_text(), Choices(cell=beside if cell else None))
        document.go_on(10_000_000)
        assert [clean(as_json(one)) for one in document.findings] == expected, path.name
        count += 1

    assert count > 10


@pytest.mark.parametrize("cell", ["", CELL])
def test_findings_are_those_of_lint(tmp_path, capsys, cell):
    findings_agree(tmp_path, capsys, cell, 5)


@pytest.mark.slow
@pytest.mark.parametrize("cell", ["", CELL])
def test_all_findings_are_those_of_lint(tmp_path, capsys, cell):
    findings_agree(tmp_path, capsys, cell, 1)
