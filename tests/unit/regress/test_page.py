"""What `docs/regression.md` shows can be read, and its table is that of the code."""

from __future__ import annotations

import json
import re
from pathlib import Path

import jsonschema
import pytest
from ruamel.yaml import YAML

from gcodesim.cli import main
from gcodesim.diagnostics import SourceText
from gcodesim.regress.case_file import case_schema, read_case_file
from gcodesim.regress.expectation import expectations
from gcodesim.regress.tolerance import QUANTITIES
from gcodesim.regress.tolerance_kind import tolerance_from

PAGE = (Path(__file__).parents[3] / "docs" / "regression.md").read_text()


def test_the_test_file_reads_and_fits_its_schema(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (text,) = re.findall(r"```yaml\n(.*?)```", PAGE, re.DOTALL)
    read = read_case_file(SourceText("a.test.yaml", text.encode()), tmp_path)
    assert list(read.findings) == [] and read.content is not None
    assert read.content.options.block_delete is True and read.content.expect.values["time.total_s"].most == 60
    assert main(["cell", "schema", "--tests"]) == 0
    schema = json.loads(capsys.readouterr().out)
    assert schema == case_schema()
    jsonschema.Draft202012Validator(schema).validate(YAML(typ="safe").load(text))
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.Draft202012Validator(schema).validate({"cel": "a.yaml"})


def test_the_comments_are_expectations() -> None:
    block = PAGE.split("## Expectations in comments")[1].split("## ")[0]
    lines = "\n".join(re.findall(r"^    (.*)$", block, re.MULTILINE))
    found, faults = expectations(SourceText("a.nc", lines.encode()))
    assert [(one.finding.code, one.finding.line, one.finding.count) for one in found] == [
        ("GS012", 1, None),
        ("GS401", 2, None),
        ("GS501", 4, None),
        ("GS402", 4, 3),
    ]
    assert faults == []


def test_the_table_of_tolerances() -> None:
    rows = re.findall(r"^\| `(\w+)` \| (.*) \| (.*) \|$", PAGE, re.MULTILINE)
    named = {name: (what, default) for name, what, default in rows if name in QUANTITIES}
    assert set(named) == set(QUANTITIES)
    for name, quantity in QUANTITIES.items():
        what, default = named[name]
        assert what == quantity.what
        assert tolerance_from(name, default.replace("³", "^3")) == quantity.default, name
