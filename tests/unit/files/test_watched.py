"""Which files have changed; unchanged ones are not read."""

import os

from gcodesim.files.watched import WatchedFiles


def test_changes_by_content(tmp_path):
    one, two, absent = tmp_path / "one", tmp_path / "two", tmp_path / "absent"
    one.write_text("1")
    two.write_text("2")
    watched = WatchedFiles([one, two, absent])
    assert watched.reads == 2
    assert watched.changed() == []
    assert watched.reads == 2

    two.write_text("22")
    absent.write_text("3")
    assert watched.changed() == [absent, two]
    assert watched.reads == 4
    assert watched.changed() == []


def test_a_touched_file_is_read_and_has_not_changed(tmp_path):
    one = tmp_path / "one"
    one.write_text("1")
    watched = WatchedFiles([one])
    os.utime(one, ns=(1, 1))

    assert watched.changed() == []
    assert watched.reads == 2


def test_a_file_that_is_written_anew(tmp_path):
    one = tmp_path / "one"
    one.write_text("1")
    watched = WatchedFiles([one])
    one.unlink()
    assert watched.changed() == []
    one.write_text("2")
    assert watched.changed() == [one]


def test_a_file_that_goes_has_changed_once(tmp_path):
    one = tmp_path / "one"
    one.write_text("1")
    watched = WatchedFiles([one])
    one.unlink()
    assert [watched.changed() for _ in range(4)] == [[], [one], [], []]
    one.write_text("1")
    assert watched.changed() == [one]


def test_a_file_that_another_one_replaces_under_its_name(tmp_path):
    """As editors save: a new file beside it, which then takes its name."""
    one, new = tmp_path / "one", tmp_path / "one.tmp"
    one.write_text("1")
    watched = WatchedFiles([one])
    new.write_text("22")
    new.replace(one)
    assert watched.changed() == [one]
    assert watched.changed() == []


def test_files_that_join_have_changed(tmp_path):
    one, two = tmp_path / "one", tmp_path / "two"
    one.write_text("1")
    watched = WatchedFiles([one])
    two.write_text("2")
    watched.join([one, two])
    assert watched.changed() == [two]


def test_files_that_are_watched_on_keep_their_states(tmp_path):
    one, two = tmp_path / "one", tmp_path / "two"
    one.write_text("1")
    watched = WatchedFiles([one])
    one.write_text("changed")
    two.write_text("2")
    watched.watch([one, two])

    assert watched.changed() == [one]
