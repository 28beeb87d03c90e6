"""Limits of joints and links that may meet, as a cell gives them."""

from __future__ import annotations

from pathlib import Path

import pytest

from gcodesim.cell.loader import read_cell
from gcodesim.checks.machine_bodies import MachineBodies
from gcodesim.diagnostics import SourceText
from gcodesim.shop import open_shop

CELL = "gcodesim: 1\nrobots: {{arm: {{model: ur10e{keys}}}}}\n"


def loaded(keys: str):  # type: ignore[no-untyped-def]
    return read_cell(SourceText("cell.yaml", CELL.format(keys=keys).encode()), Path("cell.yaml"))


def test_speeds_and_accelerations_of_the_cell_hold() -> None:
    found = loaded(", speed: [60, 60, 60, 90, 90, 90 deg/s], acceleration: [1, 1, 1, 2, 2, 2 rad/s^2]")
    assert found.cell is not None
    joints = open_shop(found.cell).kinematics.joints

    assert joints.speed.tolist() == pytest.approx([3.141592653589793 / 3] * 3 + [3.141592653589793 / 2] * 3)
    assert joints.acceleration.tolist() == [1, 1, 1, 2, 2, 2]
    assert not joints.assumed_acceleration.any()


@pytest.mark.parametrize(
    ("keys", "code"),
    [
        (", speed: [60, 60 deg/s]", "GS706"),
        (", allow_collisions: [[link_1, link_2, link_3]]", "GS706"),
        (", allow_collisions: [[link_1, link_33]]", "GS712"),
    ],
)
def test_faults(keys: str, code: str) -> None:
    assert code in {finding.code for finding in loaded(keys).findings}


def test_links_that_may_meet_are_not_checked() -> None:
    def pairs(keys: str) -> set[frozenset[str]]:
        cell = loaded(keys).cell
        assert cell is not None
        bodies = MachineBodies.of(open_shop(cell).scene, "arm")
        named = [body.rigid.name for body in bodies.bodies]
        return {frozenset((named[i], named[j])) for i, j in bodies.pairs()}

    all_of_them = pairs("")
    fewer = pairs(", allow_collisions: [[link_1, link_3], [link_4, link_2]]")
    assert {tuple(sorted(pair)) for pair in all_of_them - fewer} == {
        ("arm/link_1", "arm/link_3"),
        ("arm/link_2", "arm/link_4"),
    }
    assert fewer < all_of_them
