"""The page of findings says what the catalogue says."""

import subprocess
import sys
from pathlib import Path

from gcodesim.diagnostics import codes

ROOT = Path(__file__).resolve().parents[3]


def test_the_page_is_up_to_date(tmp_path):
    """`python scripts/make_findings_page.py` writes it."""
    fresh = tmp_path / "findings.md"
    subprocess.run([sys.executable, str(ROOT / "scripts" / "make_findings_page.py"), str(fresh)], check=True)

    assert (ROOT / "docs" / "findings.md").read_text(encoding="utf-8") == fresh.read_text(encoding="utf-8")


def test_every_code_has_its_texts_and_stands_once():
    known = list(codes())

    assert len({code.code for code in known}) == len(known)
    for code in known:
        assert code.title and code.what and code.remedy, code.code
