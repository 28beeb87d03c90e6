"""A file of a subroutine may be a link, but only to what lies in a folder of subroutines: a program is a stranger's."""

from __future__ import annotations

from pathlib import Path

import pytest

from gcodesim.diagnostics import SourceText
from gcodesim.rs274 import Settings, interpret

DIALECTS = {
    "linuxcnc": ("o<x> call\nM2\n", "x.ngc", "o<x> sub\nG0 X1\no<x> endsub\n"),
    "fanuc": ("O1\nM98 P7\nM30\n", "O0007.nc", "O7\nG0 X1.\nM99\n"),
}


@pytest.mark.parametrize("dialect", DIALECTS)
def test_a_link_leads_nowhere_else(tmp_path: Path, dialect: str) -> None:
    program, name, text = DIALECTS[dialect]
    beside, library, away = (tmp_path / part for part in ("beside", "library", "away"))
    for folder in (beside, library, away):
        folder.mkdir()
    source = SourceText("p.nc", program.encode(), beside)

    def findings() -> list[str]:
        run = interpret(source, Settings(dialect=dialect, subroutines=(library,)))
        list(run)
        return [finding.code for finding in run.findings if finding.level.word == "error"]

    (away / name).write_text(text)
    (beside / name).symlink_to(away / name)
    assert findings() and str(away) not in str(findings())
    (beside / name).unlink()
    (library / f"real_{name}").write_text(text)
    (beside / name).symlink_to(library / f"real_{name}")
    assert findings() == []
