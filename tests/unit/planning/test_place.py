"""Places of a part: which are good, which is the best, and what the tip can reach."""

import numpy as np
import pytest

from gcodesim.planning import FixedAttitude
from gcodesim.planning.place import NOWHERE, Spot, best_place, cuts_of, margin_at, places, region_of
from gcodesim.report.reach_picture import mesh_of, picture_of
from tests.configuration_cases import can_run
from tests.unit.planning.test_route import around


@pytest.fixture(scope="module")
def plan():
    """A short arc that the KR 10 can run."""
    return around("kuka_kr10_r1100_2", 0.1, radius=0.7, chords=60)


@pytest.fixture(scope="module")
def cuts(plan):
    return cuts_of(plan, FixedAttitude())


def test_margins_are_those_of_the_search(plan, cuts):
    here = margin_at(plan.kinematics, cuts, np.zeros(3), None)
    q = plan.joint_path.q_nodes
    joints = plan.kinematics.joints
    assert here >= np.minimum(q - joints.lower, joints.upper - q).min() - 1e-3
    assert margin_at(plan.kinematics, cuts, np.array([2.0, 0.0, 0.0]), None) == NOWHERE
    assert all(can_run(plan.kinematics, cut, spins=36) for cut in cuts)


def test_a_grid_of_places_begins_where_the_part_is(plan, cuts):
    def margin(shift):
        return margin_at(plan.kinematics, cuts, shift, None)

    found = places(margin, np.eye(3), np.array([0.4, 0.0, 0.0]), 0.2)
    assert [tuple(np.round(p.shift, 6)) for p in found] == [
        (0.0, 0.0, 0.0), (0.2, 0.0, 0.0), (-0.2, 0.0, 0.0), (0.4, 0.0, 0.0), (-0.4, 0.0, 0.0)
    ]  # fmt: skip
    assert found[0].good and not found[3].good
    turned = places(margin, np.diag([-1.0, -1.0, 1.0]), np.array([0.4, 0.0, 0.0]), 0.4)
    assert [p.margin for p in turned] == [found[0].margin, found[4].margin, found[3].margin]


def test_the_best_place_has_room_on_all_sides():
    def place(x, margin):
        return Spot(np.array([x, 0.0, 0.0]), margin)

    row = [place(0.0, NOWHERE), place(0.1, 0.5), place(0.2, 0.4), place(0.3, 0.4), place(0.4, 0.3)]
    assert best_place(row, 0.1) is row[2]
    assert best_place(row[:2], 0.1) is row[1]
    assert best_place(row[:1], 0.1) is None


def test_the_region_holds_what_is_reached_and_its_mesh_is_closed(plan, cuts):
    region = region_of(plan.kinematics, cuts, np.eye(3), np.zeros(3), None)
    tips = cuts[0].X_BT[:, :3, 3]
    cells = np.floor((tips - region.corner) / region.cell).astype(int)
    assert region.inside[tuple(cells.T)].mean() > 0.9
    assert (region.corner + region.cell * np.array(region.inside.shape) < 1.25).all()  # less than the reach and a cell
    mesh = mesh_of(region)
    assert mesh.volume == pytest.approx(region.inside.sum() * region.cell**3, rel=1e-9)
    edges = np.sort(mesh.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    assert (np.unique(edges, axis=0, return_counts=True)[1] % 2 == 0).all()
    picture = picture_of(region, tips, np.array([0.1, 0.0, 0.0]), np.zeros(3))
    assert picture.count("<polyline") == 4 and picture.count("section at") == 2
    assert picture == picture_of(region, tips, np.array([0.1, 0.0, 0.0]), np.zeros(3))
