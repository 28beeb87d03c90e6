"""The page of a run: one file, nothing from outside, the numbers of the log inside."""

import base64
import json
import re
import zlib

import numpy as np
import pytest

from gcodesim.report.page import write_page
from gcodesim.report.replay import chosen_states
from tests.log_columns import read_columns


@pytest.fixture(scope="module")
def page(slot_folder):
    from gcodesim.playback import Recording

    return write_page([Recording.open(slot_folder)])


def element(page, name):
    return re.search(rf'<script type="application/octet-stream" id="{name}">([^<]*)</script>', page)[1]


@pytest.fixture(scope="module")
def index(page):
    return json.loads(zlib.decompress(base64.b64decode(element(page, "index"))))


@pytest.fixture(scope="module")
def get(page):
    """Entry → array (n, k), as numpy undoes it."""
    block = zlib.decompress(base64.b64decode(element(page, "blob")))

    def get(entry):
        data = block[entry["at"] : entry["at"] + entry["bytes"]]
        if entry["type"] == "text":
            return data.decode()
        size = int(entry["type"][1:]) // 8
        planes = np.frombuffer(data, np.uint8).reshape(size, -1).T
        difference = np.ascontiguousarray(planes).view(f"<u{size}").reshape(entry["columns"], entry["rows"])
        columns = np.cumsum(difference, axis=1, dtype=difference.dtype)
        if "step" in entry:
            return columns.T * np.array(entry["step"]) + np.array(entry["low"])
        return columns.T.astype(np.int64) + entry.get("base", 0)

    return get


def test_the_page_has_the_operations(index):
    results = index["runs"][0]["results"]
    volumes = [one["removed_mm3"] for one in results["operations"]]

    assert sum(volumes) == pytest.approx(sum(tool["removed_mm3"] for tool in results["tools"])) and max(volumes) > 0.0


def test_nothing_is_taken_from_outside(page):
    own = re.sub(r"<script>.*?</script>", "", page, count=2, flags=re.DOTALL)  # libraries quote addresses in comments

    assert "default-src 'none'" in page
    assert not re.search(r"""(?:src|href)\s*=|url\(|https?://|fetch\(|XMLHttpRequest|import\s*\(""", own)


def test_the_page_is_the_same_again(page, slot):
    assert write_page([slot]) == page


def test_curves_are_those_of_the_log(index, get, slot):
    (force,) = [chart for chart in index["runs"][0]["charts"] if chart["what"] == "force"]
    truth = read_columns(slot.log.path, "/process", ["max_force_n"])
    t, values = get(force["t"])[:, 0] * index["tick_s"], get(force["values"])[:, 0]

    assert np.allclose(
        values, np.interp(t, truth["t_ns"] * 1e-9, truth["max_force_n"]), atol=truth["max_force_n"].max() / 60_000
    )
    assert values.max() == pytest.approx(truth["max_force_n"].max(), rel=1e-9)


def test_the_tip_moves_as_in_the_log(index, get, slot):
    replay = index["runs"][0]["replay"]
    truth = read_columns(slot.log.path, "/tcp", ["pose.position.x", "pose.position.y", "pose.position.z"])
    seconds = get(replay["times"])[:, 0] * index["tick_s"]
    tip = get(replay["tip"])
    assert len(tip) < 0.5 * len(truth["t_ns"])
    for k, axis in enumerate("xyz"):
        replayed = np.interp(truth["t_ns"] * 1e-9, seconds, tip[:, k])
        assert np.abs(replayed - truth[f"pose.position.{axis}"]).max() < 2e-4, axis


def test_every_frame_of_a_body_has_poses(index, get, slot):
    replay = index["runs"][0]["replay"]
    used = {e["frame"] for e in replay["cell"]} | {e["frame"] for tool in replay["tools"] for e in tool["shapes"]}

    assert used - {"world"} <= set(replay["frames"])
    tool = replay["frames"]["tool"]
    q = get(tool["quaternions"])
    assert np.allclose(np.linalg.norm(q, axis=1), 1.0, atol=1e-4)
    assert np.allclose(get(tool["positions"]), get(replay["tip"]), atol=1e-4)


def test_the_last_state_of_the_stock_is_closed_and_as_large_as_the_part(index, get, slot):
    import trimesh

    points, faces, first = [], [], 0
    for states in index["runs"][0]["replay"]["stock"]["tiles"]:
        for part in states[-1]["parts"]:
            own = get(part["points"])
            points.append(own)
            faces.append(get(part["triangles"]) + first)
            first += len(own)
    mesh = trimesh.Trimesh(np.concatenate(points), np.concatenate(faces), process=False)
    remaining = slot.results["stocks"]["stock"]["remaining_mm3"] * 1e-9

    assert mesh.volume == pytest.approx(remaining, rel=2e-3)


def test_program_findings_and_times_are_there(index, get, slot):
    run = index["runs"][0]

    assert get(run["files"][0]["text"]).splitlines() == slot.sources["slot.nc"].lines
    assert [f["code"] for f in run["findings"]] == [f["code"] for f in slot.results["findings"]]
    coolant = next(f for f in run["findings"] if f["line"] == 13)
    assert coolant["t"] * index["tick_s"] == pytest.approx(
        slot.timeline.t_ns[slot.timeline.line.tolist().index(13)] * 1e-9, abs=1e-3
    )
    assert sum(tool["time_s"] for tool in run["times"]["tools"]) == pytest.approx(run["times"]["total_s"])


def test_two_runs_are_shown_beside_each_other(slot):
    page = write_page([slot, slot], names=("old", "new"))
    index = json.loads(zlib.decompress(base64.b64decode(element(page, "index"))))

    assert [run["name"] for run in index["runs"]] == ["old", "new"]
    with pytest.raises(ValueError):
        write_page([])


def test_a_program_cannot_end_the_script_it_is_in(slot, monkeypatch):
    from gcodesim.diagnostics import SourceText
    from gcodesim.playback import Recording

    evil = "(</script><script>alert(1)</script>)"
    monkeypatch.setattr(Recording, "sources", {"slot.nc": SourceText("slot.nc", evil.encode())})
    monkeypatch.setattr(Recording, "name", "<b>&name")

    page = write_page([slot])

    assert evil not in page and "<b>&name" not in page and "&lt;b&gt;&amp;name" in page


def test_stock_that_is_too_large_is_shown_at_fewer_moments():
    times = {"a": [(t, 100) for t in range(0, 1000, 10)], "b": [(0, 100), (500, 100), (990, 100)]}

    everything = chosen_states(times, 1_000_000)
    few = chosen_states(times, 2_000)

    assert everything == {topic: {t: t for t, _ in states} for topic, states in times.items()}
    assert sum(len(states) for states in few.values()) <= 20
    assert few["a"][0] == 0 and few["a"][990] == 990 and few["b"][990] == 990
    # at a moment every tile shows what it was then
    for topic, states in few.items():
        for moment, sent in states.items():
            assert sent == max(t for t, _ in times[topic] if t <= moment)
