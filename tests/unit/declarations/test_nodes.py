"""YAML with places: what nodes hold, and that no text whatsoever makes the reader fail."""

from __future__ import annotations

import random
from pathlib import Path

import pytest

from gcodesim.cell import read_cell
from gcodesim.declarations.nodes import Listing, Mapping, Scalar, compose
from gcodesim.diagnostics import Findings, SourceText

ROOT = Path(__file__).parents[3]
SOUND = ROOT / "tests" / "data" / "cells" / "sound" / "everything.yaml"


def composed(text: str) -> tuple[Mapping | None, list[str]]:
    findings = Findings()
    return compose(SourceText("c.yaml", text.encode()), findings), [f.code for f in findings]


def test_scalars_keep_their_text_and_place() -> None:
    root, codes = composed("a: on\nb: [1e3, '2', 2027-01-01]\n")

    assert root is not None and codes == []
    a, b = root.get("a"), root.get("b")
    assert a == Scalar(span=a.span, text="on") if isinstance(a, Scalar) else False
    assert isinstance(b, Listing)
    assert [(item.text, item.plain) for item in b.items if isinstance(item, Scalar)] == [
        ("1e3", True),
        ("2", False),
        ("2027-01-01", True),
    ]
    assert [(item.span.line, item.span.column, item.span.end_column) for item in b.items] == [
        (2, 5, 8),
        (2, 10, 13),
        (2, 15, 25),
    ]


def test_a_character_that_json_escapes_in_two_halves_is_one() -> None:
    """A cell that a script wrote as JSON is YAML too."""
    root, codes = composed('a: "x\\ud83d\\ude00y"\n')
    assert root is not None and codes == []
    assert isinstance(a := root.get("a"), Scalar) and a.text == "x\U0001f600y"


@pytest.mark.parametrize("half", ["\\ud83d", "\\ude00", "\\ude00\\ud83d", "\\ud83d\\ud83d\\ude00"])
def test_half_a_character_is_no_text(half: str) -> None:
    """No file could hold it, nor its name."""
    assert composed(f'a: "x{half}y"\n')[1] == ["GS701"]
    root, codes = composed(f'"{half}": 1\n')
    assert codes == ["GS701"] and root is not None and root.entries[0][0].text.encode()


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_every_line_end_counts_the_same(end: str) -> None:
    root, codes = composed(end.join(["# first", "a: 1", "", "b: {c: 2}"]))

    assert root is not None and codes == []
    b = root.get("b")
    assert isinstance(b, Mapping) and (b.entries[0][0].span.line, b.entries[0][0].span.column) == (4, 5)


def test_separators_of_other_scripts_end_no_line() -> None:
    root, codes = composed("a: 1 # x\u2028y: [\u0085\nb: 2\n")

    assert root is not None and codes == []
    assert [key.text for key, _ in root.entries] == ["a", "b"]
    assert root.entries[1][0].span.line == 2


def test_plain_aliases_are_allowed() -> None:
    root, codes = composed("a: &x {b: 1}\nc: *x\n")

    assert root is not None and codes == []
    assert root.get("a") == root.get("c")


def test_the_first_of_two_keys_is_kept() -> None:
    root, codes = composed("a: 1\na: 2\n")

    assert root is not None and codes == ["GS702"]
    assert [value.text for _, value in root.entries if isinstance(value, Scalar)] == ["1"]


def test_a_bomb_costs_nothing() -> None:
    lines = ["a0: &a0 [x, x, x, x, x, x, x, x, x, x]"]
    lines += [f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 10)}]" for i in range(1, 12)]

    root, codes = composed("\n".join(lines))

    assert root is None and codes == ["GS703"]


def test_deep_nesting_is_a_finding_and_no_crash() -> None:
    assert composed("a: " + "[" * 20_000)[1] == ["GS703"]
    assert composed("a: " + "{b: " * 20_000)[1] == ["GS703"]


def test_damaged_cells_give_findings_and_never_a_traceback() -> None:
    """Three hundred random damages to a large cell: bytes replaced, lines dropped, doubled, swapped, text inserted."""
    source = SOUND.read_bytes()
    inserts = [
        b"{",
        b"}",
        b"[",
        b"]",
        b":",
        b"- ",
        b"\t",
        b"\r",
        b"*a",
        b"&a ",
        b"!!int ",
        b"1e999",
        b"null",
        b"~",
        b"\xff",
        b"\xe2\x80\xa8",
        b"'",
        b'"',
        b"|",
        b"%",
        b"\0",
        b"<<: *a",
        b"-1",
        b"0",
        b".nan",
    ]
    chance = random.Random(20)
    for _ in range(300):
        damaged = bytearray(source)
        for _ in range(chance.randint(1, 4)):
            at = chance.randrange(len(damaged))
            kind = chance.randrange(4)
            if kind == 0:
                damaged[at] = chance.randrange(256)
            elif kind == 1:
                damaged[at:at] = chance.choice(inserts)
            elif kind == 2:
                del damaged[at : at + chance.randint(1, 30)]
            else:
                lines = bytes(damaged).split(b"\n")
                lines[chance.randrange(len(lines))] = lines[chance.randrange(len(lines))]
                damaged = bytearray(b"\n".join(lines))
        result = read_cell(SourceText("cell.yaml", bytes(damaged)), SOUND)
        assert (result.cell is None) == result.findings.has_errors()
        for finding in result.findings:
            assert "\n" not in finding.message
