"""Text of others does nothing but be read."""

from __future__ import annotations

import io
import json
import unicodedata

import pytest

from gcodesim.diagnostics.plain import PlainStream, excerpt_of, lines, one_line, raw, table_text, text_of_table

BIDI = "\u061c\u200e\u200f\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069"


@pytest.mark.parametrize("text", ["", "Fräser 6 mm", "a: b # c", "日本", "👩‍🔧", "C:\\x", "a::b", "## note", "می‌خواهم"])
def test_what_is_fit_stays(text: str) -> None:
    assert one_line(text) == lines(text) == text


def test_every_control_character_is_shown_by_its_number() -> None:
    for number in range(0x110000):
        character = chr(number)
        hidden = unicodedata.category(character) in ("Cc", "Zl", "Zp") or character in BIDI
        shown = one_line(f"a{character}b")
        if hidden:
            assert shown.isprintable() and shown != f"a{character}b", hex(number)
            assert json.loads(f'"{shown}"') == f"a{character}b"
            if character not in "\t\n":
                assert lines(f"a{character}b") == shown if character != "\r" else True
        else:
            assert not unicodedata.category(character).startswith("L") or shown == f"a{character}b"


def test_no_piece_of_a_line_is_a_command_to_a_build_server() -> None:
    assert one_line("::error::x") == "\\u003a:error::x"
    assert one_line("  ::error::x") == "  \\u003a:error::x"
    assert one_line(" \t::error::x") == " \\t::error::x"
    assert one_line("\n::error::x") == "\\n::error::x"
    assert (
        one_line("x ##[add-mask]y ##vso[task.setvariable]z") == "x #\\u0023[add-mask]y #\\u0023vso[task.setvariable]z"
    )
    assert lines("a\n  ::stop-commands::x\n\t::y") == "a\n  \\u003a:stop-commands::x\n\t\\u003a:y"


def test_an_excerpt_keeps_its_columns() -> None:
    text = "(##[group]\x1b[2J \u202e\tx)"
    shown = excerpt_of(text)
    assert len(shown) == len(text) and "##[" not in shown and "\x1b" not in shown and "\t" in shown


def test_a_stream() -> None:
    below = io.StringIO()
    stream = PlainStream(below)
    for text in ("  ", "::a\n", "b ", "::c", "\n", "\x1b[2J\u202e", "\n::d\n\t::e\n", "f\n"):
        stream.write(text)
    assert below.getvalue() == "  \\u003a:a\nb ::c\n\\u001b[2J\\u202e\n\\u003a:d\n\t\\u003a:e\nf\n"
    assert raw(stream) is below and raw(below) is below and not stream.isatty()
    print(json.dumps({"a": "\x9b\u202e##[x]"}, ensure_ascii=False), file=stream)
    assert json.loads(below.getvalue().splitlines()[-1]) == {"a": "\x9b\u202e##[x]"}


@pytest.mark.parametrize("text", ["=1", "+1", "-1", "@x", "＝1", "'=1", "''-x"])
def test_a_cell_that_a_spreadsheet_would_compute(text: str) -> None:
    assert table_text(text) == f"'{text}" and text_of_table(table_text(text)) == text


def test_a_cell_is_one_line_without_hidden_characters() -> None:
    assert table_text("=a\n::error::b\x1b[2J\u202e\t\r") == "'=a\\n::error::b\\u001b[2J\\u202e\\t\\r"
    assert table_text("::a") == "\\u003a:a"


@pytest.mark.parametrize("text", ["", "a=1", "'a", "part.nc", "Ø6"])
def test_a_cell_that_none_would(text: str) -> None:
    assert table_text(text) == text == text_of_table(text)
