"""Names and texts of a stranger's cell and program stay words: no command to a build server, no code for a terminal."""

from __future__ import annotations

import base64
import csv
import io
import json
import re
import unicodedata
import zlib
from pathlib import Path
from xml.etree import ElementTree

import pytest

from gcodesim.cli.main import main

NASTY = "x\n::stop-commands::y\n##[add-mask]z\x1b[2J\x1b]0;t\x07\x9b1m\u202e\u2028\u200f\x85w"
QUOTED = json.dumps(NASTY)
FILE = "y\n::error::z\x1b[2J\x9b\u202e##[group]"
HIDDEN = {"\u061c", "\u200b", *map(chr, range(0x200E, 0x2010)), *map(chr, range(0x202A, 0x202F)), "\u2066", "\u2069"}

CELL = f"""
gcodesim: 1
machine: gantry_xyz
stock: {{box: [30, 20, 8], zero: top-front-left, material: {QUOTED}, resolution: 1}}
materials: {{{QUOTED}: {{kc11: 700 N/mm^2, mc: 0.25, source: {QUOTED}}}}}
tools: {{1: {{type: flat_end_mill, name: {QUOTED}, diameter: 6, length: 40, flute_length: 20}}}}
suppress: [{{code: GS304, reason: {QUOTED}}}]
"""
PROGRAM = """
(::stop-commands::a ##[add-mask]b \x1b[2J\x1b]0;t\x07 \x9b \u202e \u2028 \x85)
(MSG,::error::a ##[group] \x1b[2J\u202e\u2028\x85)
(DEBUG,::error::a \x1b[2J)
G21 G90 G17 G64 P0.01
o<a::b\x1b> sub
o<a::b\x1b> endsub
T1 M6
G43 H1
S8000
G0 X5 Y5 Z5
G1 Z-1 F300
G1 X20 (::error::slot \x1b[2J\u202e##[group])
G0 Z5
\u202e::error::\x1b[2J##[group]
M2
"""
SLIP = "\u202e::error::\x1b[2J##[group]\n"
WRONG = f"""
gcodesim: 1
{QUOTED}: 1
machine: {QUOTED}
robots: {{arm: {{model: {QUOTED}}}, {QUOTED}: {{urdf: {QUOTED}}}}}
channels: {{{QUOTED}: {{}}}}
dialect: {QUOTED}
frames: {{{QUOTED}: {{in: {QUOTED}, xyz: [0, 0, {QUOTED}]}}}}
stock: {{{QUOTED}: {{box: [30, 20, 8], material: {QUOTED}, zero: {QUOTED}, {QUOTED}: 1}}}}
tools: {{1: {{type: {QUOTED}}}, {QUOTED}: {{type: drill}}, 2: {{type: drill, name: {QUOTED}, {QUOTED}: 2}}}}
fixtures: {{{QUOTED}: {{mesh: {QUOTED}}}}}
work_offsets: {{{QUOTED}: {{}}}}
tool_table: {QUOTED}
subroutines: [{QUOTED}]
parameters: {QUOTED}
packages: {{{QUOTED}: {QUOTED}}}
checks: {{{QUOTED}: {QUOTED}}}
m_codes: {{{QUOTED}: {QUOTED}}}
suppress: [{{code: {QUOTED}, reason: {QUOTED}}}]
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    top = tmp_path_factory.mktemp("strangers")
    (top / f"{FILE}.nc").write_text(PROGRAM, newline="")
    (top / f"{FILE}.yaml").write_text(CELL)
    (top / "wrong.yaml").write_text(WRONG)
    program, cell = json.dumps(f"{FILE}.nc"), json.dumps(f"{FILE}.yaml")
    (top / f"{FILE}.test.yaml").write_text(f"program: {program}\ncell: {cell}\n")
    wrong = f"program: {QUOTED}\ncell: {QUOTED}\n{QUOTED}: {QUOTED}\nresults: {{{QUOTED}: 1}}\n"
    (top / "wrong.test.yaml").write_text(wrong)
    (top / "mended.nc").write_text(PROGRAM.replace(SLIP, ""), newline="")
    run = ["run", "--cell", str(top / f"{FILE}.yaml"), "--out"]
    assert main([*run, str(top / "out"), str(top / "mended.nc")]) in (0, 1)
    assert main([*run, str(top / FILE), str(top / f"{FILE}.nc")]) == 1
    return top


def is_hidden(character: str) -> bool:
    return unicodedata.category(character) in ("Cc", "Zl", "Zp") or character in HIDDEN


def see(text: str, *, annotations: bool = False) -> None:
    """Fail when a terminal or a build server would do something."""
    assert text
    assert not {c for c in text if is_hidden(c)} - {"\n", "\t"}, text
    assert not re.search(r"##(\[|vso\[)", text), text
    for line in text.split("\n"):
        if line.lstrip().startswith("::"):
            assert annotations and re.match(r"::(error|warning|notice) file=[^:]*,title=GS\d{3} [^:]*::", line), line


COMMANDS = [
    f"{command} --format {form}"
    for command in (
        "lint P",
        "check P --cell C",
        "check P --cell W",
        "cell validate C W",
        "test .",
        "run P --cell C --out o",
    )
    for form in ("text", "json", "sarif", "junit", "github", "gitlab")
] + [
    "lint P --github",
    "check P --cell W --github",
    "test . --github -v",
    "canon P",
    "canon P --format json",
    "cell show C",
    "cell show C --format json",
    "cell show W",
    "info out",
    "info out --format json",
    "info F",
    "report out --times",
    "diff out F",
    "diff out F --format json",
    "diff out F --format markdown",
    "export out --to csv -o csv",
    "accept . --dry-run",
    "init --from P n",
    "run X --cell C",
    "run P --cell X",
    "test X",
    "info X",
    "lint P --dialect X",
]


@pytest.mark.parametrize("command", COMMANDS)
def test_what_is_printed(
    folder: Path, command: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.chdir(folder)
    names = {"P": f"{FILE}.nc", "C": f"{FILE}.yaml", "W": "wrong.yaml", "F": FILE, "X": NASTY}
    names |= {name: str(tmp_path / name) for name in ("o", "csv", "n")}
    try:
        status = main([names.get(word, word) for word in command.split(" ")])
    except SystemExit as end:
        status = end.code
    assert status in (0, 1, 2)
    out, err = capsys.readouterr()
    see(out + err, annotations="github" in command)
    if ("json" in command or "sarif" in command or "gitlab" in command) and status != 2:
        json.loads(out)
    if "junit" in command:
        ElementTree.fromstring(out)


def test_what_is_written(folder: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.chdir(folder)
    files = {name: tmp_path / name for name in ("junit", "sarif", "gitlab")}
    options = [word for name, path in files.items() for word in (f"--{name}", str(path))]
    assert main(["test", ".", *options]) == 1
    texts = {name: path.read_text() for name, path in files.items()}
    see(texts["junit"])
    for name in ("sarif", "gitlab"):
        json.loads(texts[name])


def test_what_a_page_shows(folder: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.chdir(folder)
    assert main(["report", "out", "-o", str(tmp_path / "page.html")]) == 0
    page = (tmp_path / "page.html").read_text()
    title = re.findall("<title>(.*?)</title>", page, re.DOTALL)
    packed = [re.findall(rf'id="{name}"[^>]*>([^<]*)<', page)[0] for name in ("index", "blob")]
    index, blob = (zlib.decompress(base64.b64decode(text)) for text in packed)
    content = json.loads(index)
    see(title[0])
    for text in texts_of(content):
        assert not any(map(is_hidden, text.replace("\n", ""))), text
    place = content["runs"][0]["files"][0]["text"]
    listing = blob[place["at"] : place["at"] + place["bytes"]].decode()
    assert "G1 X20 (::error::slot" in listing
    assert not any(map(is_hidden, listing.replace("\n", "")))


def texts_of(value: object) -> list[str]:
    if isinstance(value, dict):
        return [text for pair in value.items() for one in pair for text in texts_of(one)]
    if isinstance(value, list):
        return [text for one in value for text in texts_of(one)]
    return [value] if isinstance(value, str) else []


def test_no_cell_of_a_table_is_a_formula(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """A spreadsheet would execute it; numbers, of which many begin with a minus, stay as they are."""
    monkeypatch.chdir(tmp_path)
    formula = "=HYPERLINK(1)"
    (tmp_path / f"{formula}.nc").write_text(PROGRAM.replace("(MSG,", "(MSG,@SUM").replace(SLIP, ""), newline="")
    (tmp_path / "cell.yaml").write_text(CELL.replace(f"name: {QUOTED}", f"name: {formula}"))
    main(["run", f"{formula}.nc", "--cell", "cell.yaml", "--out", "out"])
    rows = list(csv.reader(io.StringIO((tmp_path / "out" / "lines.csv").read_text())))
    assert rows[1][0] == f"'{formula}.nc"
    negative = False
    for topic in ("", "/event", "/log"):
        assert main(["export", "out", "--to", "csv", "-o", "t.csv", *(["--topics", topic] if topic else [])]) == 0
        for row in csv.reader(io.StringIO((tmp_path / "t.csv").read_text())):
            for cell in row:
                if not re.fullmatch(r"-?[0-9.]+(e-?[0-9]+)?", cell):
                    assert not cell.startswith(tuple("=+-@\t\r")), cell
                negative |= cell.startswith("-")
    assert negative
    from gcodesim.playback import Recording

    lines = Recording.open(tmp_path / "out").line_rows
    assert lines is not None and lines[0]["file"] == f"{formula}.nc"
