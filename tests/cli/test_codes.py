"""Every code that the sources use is explained, and every explained one is used."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import gcodesim
from gcodesim.diagnostics import codes
from gcodesim.diagnostics.examples import example_of

PACKAGE = Path(gcodesim.__file__).parent
CODES = list(codes())


def _used() -> set[str]:
    found: set[str] = set()
    for path in PACKAGE.rglob("*.py"):
        if "catalogue" not in path.parts:
            found |= set(re.findall(r"\"(GS\d{3})\"", path.read_text()))
    return found


def test_catalogue_and_sources_agree() -> None:
    known = {code.code for code in CODES}

    assert _used() - known == set()
    assert known - _used() == set()


def test_codes_are_unique_and_in_their_hundred() -> None:
    names = [code.code for code in CODES]
    assert len(names) == len(set(names))


@pytest.mark.parametrize("code", CODES, ids=lambda code: code.code)
def test_explain(cli, code) -> None:
    done = cli("explain", code.code.lower())

    assert done.status == 0
    assert done.out.startswith(f"{code.code}: {code.title} ({code.severity.word})\n")
    assert "Why it matters:" in done.out and "What to do:" in done.out
    prose, example, _ = done.out.partition("\nExample ")
    assert max(map(len, prose.splitlines())) <= 88
    if example_of(code.code) is not None:
        assert example and "What `gcodesim " in done.out and f" {code.code}: " in done.out


def test_list_names_all(cli) -> None:
    done = cli("list", "codes")
    assert [row.split()[0] for row in done.out.splitlines()] == sorted(code.code for code in CODES)


def test_a_near_code_is_proposed(cli) -> None:
    assert "did you mean" in cli("explain", "GS23").err
