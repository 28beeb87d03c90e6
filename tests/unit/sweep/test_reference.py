"""The page of the study file is made from the code."""

from pathlib import Path

from gcodesim.key_page import with_keys
from gcodesim.sweep.reference import reference

PAGE = Path(__file__).parents[3] / "docs" / "study.md"


def test_the_page_has_the_keys_of_the_code():
    """`python -m gcodesim.sweep.reference docs/study.md` rewrites it."""
    page = PAGE.read_text(encoding="utf-8")

    assert with_keys(page, reference()) == page
