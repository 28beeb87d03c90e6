"""What the last run says of lines."""

import hashlib
import json

import pytest

from gcodesim.diagnostics.plain import table_text
from gcodesim.editor.last_run import line_uses
from gcodesim.editor.program_document import Choices, ProgramDocument

PROGRAM = "G21 G90\nG0 X1\nM2\n"


@pytest.mark.parametrize("name", ["part.nc", "-part.nc", "=a,\n::b.nc"])
def test_rows_of_the_document_are_found_by_its_name(tmp_path, name):
    path, out = tmp_path / name, tmp_path / "out"
    path.write_text(PROGRAM)
    out.mkdir()
    digest = hashlib.sha256(PROGRAM.encode()).hexdigest()
    (out / "results.json").write_text(json.dumps({"inputs": {"program": {"sha256": digest}}}))
    shown = table_text(name).replace('"', '""')
    (out / "lines.csv").write_text(f'file,line,time_s,removed_mm3\n"{shown}",2,1.5,0\n"other.nc",1,9,0\n')
    document = ProgramDocument(path, PROGRAM, Choices())

    assert [(use.line, use.text) for use in line_uses(document)] == [(1, "1.5 s")]
