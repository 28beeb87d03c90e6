"""Runs that are done, whatever ended the process that did them."""

from __future__ import annotations

from pathlib import Path

import pytest

from gcodesim.sweep.journal import HEAD, NAME, ForeignJournalError, Journal

KEYS = [f"{number:064x}" for number in range(3)]


def filled(folder: Path) -> bytes:
    journal = Journal(folder)
    for key in KEYS:
        journal.add(key, {"key": key, "ä": 1.5})
    journal.close()
    return (folder / NAME).read_bytes()


def test_each_cut_leaves_the_whole_lines_and_the_rest_can_be_done_again(tmp_path: Path):
    whole = filled(tmp_path)
    for end in range(0, len(whole), 7):
        (tmp_path / NAME).write_bytes(whole[:end])
        known = max(whole[:end].count(b"\n") - 1, 0)

        journal = Journal(tmp_path)

        assert [key for key in KEYS if journal.row(key)] == KEYS[:known]
        for key in KEYS:
            journal.add(key, {"key": key, "ä": 1.5})
        journal.close()
        assert (tmp_path / NAME).read_bytes() == whole


def test_a_known_run_is_kept_once(tmp_path: Path):
    whole = filled(tmp_path)

    assert filled(tmp_path) == whole


def test_a_damaged_line_is_done_again(tmp_path: Path):
    whole = filled(tmp_path)
    (tmp_path / NAME).write_bytes(whole.replace(f'"{KEYS[1]}", "row": {{'.encode(), f'"{KEYS[1]}", "row": ['.encode()))

    journal = Journal(tmp_path)
    assert [journal.row(key) is not None for key in KEYS] == [True, False, True]
    journal.add(KEYS[1], {"again": 1})
    journal.close()

    assert Journal(tmp_path).row(KEYS[1]) == {"again": 1}


@pytest.mark.parametrize("content", [b"mine", HEAD[:5] + b"x"])
def test_a_file_of_somebody_else_stays_as_it_is(tmp_path: Path, content: bytes):
    (tmp_path / NAME).write_bytes(content)

    with pytest.raises(ForeignJournalError):
        Journal(tmp_path)
    assert (tmp_path / NAME).read_bytes() == content
