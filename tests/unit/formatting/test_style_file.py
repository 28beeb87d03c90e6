"""The style of a shop, in one file for all programs below."""

from pathlib import Path

import pytest

from gcodesim.diagnostics import SourceText
from gcodesim.formatting.style import Style
from gcodesim.formatting.style_file import read_style, style_for


def test_the_nearest_file_up_to_the_repository_holds(tmp_path):
    below = tmp_path / "shop" / "parts"
    below.mkdir(parents=True)
    (tmp_path / "gcodesim.yaml").write_text("format: {case: lower}\n")
    assert style_for(below / "a.nc").style == Style(case="lower")

    (tmp_path / "shop" / ".git").mkdir()
    assert style_for(below / "a.nc").style == Style()

    (tmp_path / "shop" / "gcodesim.yaml").write_text(
        "format: {spaces: false, indent: 4, code_digits: 2, decimals: 3, renumber: 5}\n"
    )
    assert style_for(below / "a.nc").style == Style(spaces=False, indent=4, code_digits=2, decimals=3, step=5)


@pytest.mark.parametrize(
    ("text", "code", "place"),
    [
        ("format: {casing: lower}\n", "GS704", 10),
        ("format: {case: Lower}\n", "GS711", 16),
        ("format: {decimals: 9}\n", "GS710", 20),
        ("formats: {}\n", "GS704", 1),
        ("gcodesim-settings: 2\n", "GS711", 20),
        ("- 1\n", "GS706", 1),
        ("", "GS705", 1),
        ("format: {", "GS701", 9),
    ],
)
def test_faults_bear_their_place(text, code, place):
    found = read_style(SourceText("gcodesim.yaml", text.encode()), Path())

    assert found.style is None
    assert [(one.code, one.span.column) for one in found.findings] == [(code, place)]
