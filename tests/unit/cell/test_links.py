"""`in:` takes links: which names there are, what may stand on them, and where it stands then."""

from __future__ import annotations

import numpy as np
import pytest

from gcodesim.cell import place
from gcodesim.frames import Pose
from tests.unit.cell.text import loaded, sound

ARM = "robots: {arm: {model: ur10e, base: {xyz: [100, 0, 0]}}}\nwork_offsets: {G54: {xyz: [500, 0, 0]}}\n"
MILL = """
machine:
  axes: {X: {travel: [0, 500 mm], speed: 1 m/s, side: table}, Z: {travel: [-300, 0 mm], speed: 1 m/s}}
"""


def test_a_fixture_stands_on_a_link() -> None:
    placement = place(sound(ARM + "fixtures: {bracket: {box: [10, 20, 30], in: arm/flange, xyz: [0, 0, 5]}}"))

    assert placement.fixtures == {}
    on = placement.carried["fixture/bracket"]
    assert on.link == "arm/flange"
    assert on.X.p == pytest.approx([0.0, 0.0, 0.005])


def test_a_frame_on_a_link_carries_frames_and_what_stands_in_them() -> None:
    cell = sound(
        MILL
        + """
frames:
  vise: {in: pallet, xyz: [0, 30, 0]}
  pallet: {in: machine/table, xyz: [100, 0, 10], rpy: [0, 0, 90]}
stock: {box: [10, 20, 30], in: vise, xyz: [1, 0, 0]}
"""
    )

    placement = place(cell)

    assert set(cell.carried) == {"vise", "pallet"}
    assert placement.stocks == {}
    on = placement.carried["stock/stock"]
    pallet = Pose.from_xyz_rpy((0.1, 0.0, 0.01), (0.0, 0.0, np.pi / 2.0))
    expected = pallet @ Pose.from_xyz_rpy((0.0, 0.03, 0.0)) @ Pose.from_xyz_rpy((0.001, 0.0, 0.0))
    assert on.link == "machine/table"
    assert on.X.matrix == pytest.approx(expected.matrix)


@pytest.mark.parametrize(
    ("text", "names"),
    [
        (MILL, ("base", "link_X", "link_Z", "flange", "table")),
        ("machine: gantry_xyz", ("base", "link_X", "link_Y", "link_Z", "flange")),
    ],
)
def test_links_of_a_machine_have_the_names_of_the_log(text: str, names: tuple[str, ...]) -> None:
    assert sound(text).link_names == tuple(f"machine/{name}" for name in names)


def test_own_and_shipped_machines_name_the_links_of_their_chain() -> None:
    for text in (MILL, "machine: mill_xyzac_trunnion"):
        machine = sound(text).machine

        assert machine is not None
        assert set(machine.link_names) == set(machine.chain.carriers)


def test_an_unknown_link_gets_a_suggestion() -> None:
    result = loaded(ARM + "fixtures: {bracket: {box: [10, 20, 30], in: arm/flang}}")

    (finding,) = result.findings
    assert finding.code == "GS712"
    assert finding.hint == "did you mean `arm/flange`?"


@pytest.mark.parametrize(
    ("text", "may"),
    [
        (ARM + "magazine: {in: arm/flange}", "only frames, stock, fixtures, parts and sensors may stand in it"),
        (
            "robots: {arm: {model: ur10e}, feeder: {model: ur10e, base: {in: arm/flange}}}\nrobot: arm\n",
            "only frames, stock, fixtures, parts and sensors may stand in it",
        ),
        (
            MILL + "frames: {pallet: {in: machine/table}}\nwork_offsets: {G54: {in: pallet}}",
            "a work system may stand on what external axes carry, not on a link; stock and parts may stand on both",
        ),
    ],
)
def test_what_stands_still_does_not_stand_on_a_link(text: str, may: str) -> None:
    result = loaded(text)

    (finding,) = [finding for finding in result.findings if finding.code == "GS712"]
    assert "moves" in finding.message
    assert finding.hint == may


def test_a_link_of_a_robot_with_a_fault_is_no_second_fault() -> None:
    text = "robots: {arm: {model: ur11e}}\nfixtures: {bracket: {box: [1, 2, 3], in: arm/flange}}"

    (finding,) = loaded(text).findings

    assert (finding.code, "ur11e" in finding.message) == ("GS712", True)


def test_the_base_of_a_robot_stands_still() -> None:
    placement = place(sound(ARM + "fixtures: {foot: {box: [10, 20, 30], in: arm/base}}"))

    assert placement.carried == {}
    assert placement.fixtures["foot"].p == pytest.approx([0.1, 0.0, 0.0])
