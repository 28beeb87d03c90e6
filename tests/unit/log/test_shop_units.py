"""Numbers in units of the shop floor beside those in SI."""

import numpy as np
import pytest

from gcodesim.log import ProcessField
from gcodesim.log.shop_units import without_twins
from tests.log_columns import read_columns

MS = 1_000_000


def test_twins_are_the_same_in_other_units(run, new_log, tmp_path):
    fields = (ProcessField(name="film_m"), ProcessField(name="film_mm", twin_of="film_m", divisor=1e-3))
    path, t = tmp_path / "run.mcap", np.arange(0, 200 * MS, 20 * MS)
    log = new_log(path, process_fields=fields, joint_scale=(1e-3, *[np.pi / 180.0] * 5))
    given = run.columns(t)
    film = 1e-4 * np.arange(len(t))
    given["process"].fields["film_m"] = film
    log.window(t, **given)
    log.close(int(t[-1]), "finished", attachments={"results.json": b"{}"})

    motion, process = given["motion"], given["process"]
    said = read_columns(path, "/motion", ["feed_mm_min", "y_mm", "position_error_um", "joints.command"])
    assert said["feed_mm_min"] == pytest.approx(60_000 * motion.feed)
    assert said["y_mm"] == pytest.approx(1e3 * motion.position[:, 1])
    assert said["position_error_um"] == pytest.approx(1e6 * motion.position_error)
    assert np.array_equal(said["joints.command"], given["joint_command"])
    joints = read_columns(path, "/motion", ["joints.position_shown", "joints.command_shown", "joints.name"])
    assert joints["joints.position_shown"][:, 0] == pytest.approx(1e3 * given["joint_position"][:, 0])
    assert joints["joints.command_shown"][:, 1] == pytest.approx(np.rad2deg(given["joint_command"][:, 1]))
    assert joints["joints.name"][0].tolist() == list(run.description().joint_names)
    done = read_columns(path, "/process", ["removed_cm3", "spindle_rpm", "removal_cm3_min", "film_mm"])
    assert done["removed_cm3"] == pytest.approx(1e6 * process.removed)
    assert done["spindle_rpm"] == pytest.approx(process.spindle * 30.0 / np.pi)
    assert done["removal_cm3_min"] == pytest.approx(6e7 * process.removal)
    assert done["film_mm"] == pytest.approx(1e3 * film)


def test_only_what_is_there_in_si_too_is_a_twin():
    names = ["feed_m_s", "feed_mm_min", "gap_mm", "depth_m", "depth_mm", "joints[a].command", "joints[a].command_shown"]

    assert without_twins(names) == ["feed_m_s", "gap_mm", "depth_m", "joints[a].command"]
