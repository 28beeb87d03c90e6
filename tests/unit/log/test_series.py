"""Columns of periodic topics come out as reading message by message has them."""

import numpy as np
import pytest

from gcodesim.log.logfile import LogFile
from gcodesim.log.series import Series, read_series
from tests.log_columns import read_columns


@pytest.fixture(scope="module")
def log(run, tmp_path_factory):
    return run.write(tmp_path_factory.mktemp("log") / "run.mcap")


@pytest.mark.parametrize("topic", ["/tf", "/joint_states", "/target", "/tcp", "/motion", "/process", "/wrench"])
def test_every_number_is_that_of_protobuf(log, topic):
    series = read_series(LogFile.open(log), [topic])[topic]
    truth = read_columns(log, topic, series.names)

    assert len(series.names) > 5
    assert np.array_equal(series.t_ns, truth["t_ns"])
    for name in series.names:
        assert np.array_equal(series.column(name), truth[name].astype(float)), name


def test_messages_of_different_builds_are_put_together(slot_folder):
    log = slot_folder / "run.mcap"
    series = read_series(LogFile.open(log), ["/process"])["/process"]
    truth = read_columns(log, "/process", ["kind", "force_n"])

    assert series.texts["kind"] == truth["kind"].tolist()
    assert len(set(series.texts["kind"])) == 2  # with and without a process, which is a text of another length
    assert np.array_equal(series.column("force_n"), truth["force_n"])


def test_a_topic_of_changes_has_whole_numbers_too(log):
    series = read_series(LogFile.open(log), ["/program"])["/program"]
    truth = read_columns(log, "/program", ["line", "text", "feed_m_s"])

    assert np.array_equal(series.column("line"), truth["line"].astype(float))
    assert np.array_equal(series.column("feed_m_s"), truth["feed_m_s"])
    assert series.texts["text"] == truth["text"].tolist()


def test_a_range_and_a_period_choose(log):
    whole = read_series(LogFile.open(log), ["/wrench"])["/wrench"]
    part = read_series(LogFile.open(log), ["/wrench"], first_ns=200_000_000, last_ns=500_000_000)["/wrench"]
    thin = read_series(LogFile.open(log), ["/wrench"], every_ns=100_000_000)["/wrench"]

    assert part.t_ns[0] == 200_000_000 and part.t_ns[-1] == 500_000_000
    inside = (whole.t_ns >= 200_000_000) & (whole.t_ns <= 500_000_000)
    assert np.array_equal(part.values, whole.values[inside])
    assert set(thin.t_ns[:-1] % 100_000_000) == {0} and thin.t_ns[-1] == whole.t_ns[-1]


def test_a_topic_that_is_not_there_is_left_out(log):
    assert read_series(LogFile.open(log), ["/nothing"]) == {}


def test_columns_are_zero_where_there_is_no_field_and_none_where_none_is_named() -> None:
    """A log of another tool has the topic of joints and no joints in it."""
    series = Series(np.arange(3), ("a",), np.array([[1.0], [2.0], [3.0]]), {})
    assert series.columns("b", "a").tolist() == [[0.0, 1.0], [0.0, 2.0], [0.0, 3.0]]
    assert series.columns().shape == (3, 0)
