"""The folder of the extension for Visual Studio Code: whole, and in step with the server and the language."""

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from gcodesim.editor.program_document import Choices
from gcodesim.regress.programs import PROGRAMS
from gcodesim.rs274.block import KEYWORDS
from gcodesim.rs274.dialects import DIALECTS

FOLDER = Path(__file__).parents[3] / "editors/vscode"
PACKAGE = json.loads((FOLDER / "package.json").read_text())
GRAMMAR = json.loads((FOLDER / "syntaxes/gcode.tmLanguage.json").read_text())


def test_all_files_that_it_names_are_there():
    bundled = PACKAGE["scripts"]["vscode:prepublish"].split()
    assert f"--outfile={PACKAGE['main'].removeprefix('./')}" in bundled
    named = [bundled[1], *(one["path"] for one in PACKAGE["contributes"]["grammars"])]
    named += [one["configuration"] for one in PACKAGE["contributes"]["languages"]]

    assert [name for name in named if not (FOLDER / name).is_file()] == []
    assert (FOLDER / "LICENSE").read_text() == (FOLDER.parents[1] / "LICENSE").read_text()
    json.loads((FOLDER / "language-configuration.json").read_text())


def test_settings_are_those_of_the_server():
    settings = {name.removeprefix("gcodesim.") for name in PACKAGE["contributes"]["configuration"]["properties"]}
    told = set(re.search(r"TOLD = \[(.*?)\]", (FOLDER / "extension.js").read_text())[1].replace("'", "").split(", "))

    assert told == set(Choices.__dataclass_fields__) - {"allow_paths"}
    assert settings == told | {"command", "cells"}
    dialects = PACKAGE["contributes"]["configuration"]["properties"]["gcodesim.dialect"]["enum"]
    assert dialects == ["", *sorted(DIALECTS)]
    texts = [extension for extension in PROGRAMS if extension != ".bgcode"]  # which no editor shows
    assert PACKAGE["contributes"]["languages"][0]["extensions"] == texts


def test_a_workspace_chooses_no_program():
    """What is started stands in the user's settings, and nothing starts in a workspace that is not trusted."""
    assert PACKAGE["contributes"]["configuration"]["properties"]["gcodesim.command"]["scope"] == "machine"
    assert PACKAGE["capabilities"]["untrustedWorkspaces"]["supported"] is False


def scope_of(text: str, word: str) -> str:
    """The scope in which a word stands, as an editor finds it: patterns in their order, at each place the first.

    Where a pattern matches nothing at all, the editor gives up the rest of the line.
    """
    at = 0
    patterns = [one for name in GRAMMAR["patterns"] for one in _flat(GRAMMAR["repository"][name["include"][1:]])]
    while at < len(text):
        best = None
        for pattern in patterns:
            found = re.compile(pattern["match"]).search(text, at)
            if found is not None and (best is None or found.start() < best[0].start()):
                best = found, pattern
        if best is None or best[0].end() == at:
            return ""
        found, pattern = best
        place = text.index(word)
        if found.start() <= place < found.end():
            inner = [
                scope["name"]
                for number, scope in pattern.get("captures", {}).items()
                if found.span(int(number))[0] <= place < found.span(int(number))[1]
            ]
            return (inner or [pattern.get("name", "")])[0]
        at = found.end()
    return ""


def _flat(rule):
    return [one for inner in rule["patterns"] for one in _flat(inner)] if "patterns" in rule else [rule]


@pytest.mark.parametrize(
    ("text", "word", "scope"),
    [
        ("N10 G1 X5 (note)", "N10", "entity.name.label.gcode"),
        ("N10 G1 X5 (note)", "G1", "keyword.other.preparatory.gcode"),
        ("N10 G1 X5 (note)", "X", "storage.type.word.gcode"),
        ("N10 G1 X5 (note)", "5", "constant.numeric.gcode"),
        ("N10 G1 X5 (note)", "(note)", "comment.block.gcode"),
        ("X1 (note)", "(note)", "comment.block.gcode"),
        ("/2 N10 G1", "/2", "keyword.operator.delete.gcode"),
        ("/ N10 G1", "N10", "entity.name.label.gcode"),
        ("/G1 X5", "G1", "keyword.other.preparatory.gcode"),
        ("(MSG, hello)", "MSG", "keyword.other.comment.gcode"),
        ("G0 X1 (open", "(open", "invalid.illegal.comment.gcode"),
        ("M30 ; end", "; end", "comment.line.semicolon.gcode"),
        ("T12 M6", "T12", "entity.name.tag.tool.gcode"),
        ("o<hole> call [1]", "o<hole>", "entity.name.function.gcode"),
        ("o<hole> call [1]", "call", "keyword.control.gcode"),
        ("IF [#1 GT 2] GOTO 20", "GOTO", "keyword.control.gcode"),
        ("IF [#1 GT 2] GOTO 20", "GT", "keyword.operator.gcode"),
        ("X[SIN[30]]", "SIN", "support.function.gcode"),
        ("#<_x y> = 3", "#<_x y>", "variable.other.gcode"),
        ("%", "%", "punctuation.definition.program.gcode"),
    ],
)
def test_words_get_their_colours(text, word, scope):
    assert scope_of(text, word) == scope


def test_every_keyword_has_a_colour():
    assert {word: scope_of(f"o1 {word}", word) for word in KEYWORDS} == dict.fromkeys(KEYWORDS, "keyword.control.gcode")


@pytest.mark.slow
def test_the_extension_talks_to_the_server() -> None:
    """With the client of Visual Studio Code, where `npm install` has been run in the folder."""
    node = shutil.which("node")
    if node is None or not (FOLDER / "node_modules/vscode-languageclient").is_dir():
        pytest.skip("node, or the client, is not installed")
    ran = subprocess.run(
        [node, "test/client.js"],
        cwd=FOLDER,
        env={**os.environ, "GCODESIM": str(Path(sys.executable).with_name("gcodesim"))},
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )

    assert ran.returncode == 0, ran.stdout + ran.stderr
