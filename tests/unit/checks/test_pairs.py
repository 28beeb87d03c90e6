"""Which bodies may not meet follows from their roles."""

from __future__ import annotations

from gcodesim.checks.clearance import standing_bodies
from gcodesim.checks.collisions import ToolParts
from gcodesim.checks.pairs import may_not_meet, pairs_by_kind, role_of_part
from gcodesim.frames import WORLD, Pose
from gcodesim.scene import Body, Scene, Stand
from gcodesim.solids import Box, Placed
from gcodesim.tools.flat_end_mill import FlatEndMill
from gcodesim.tools.sections import Holder
from tests.unit.scene.test_scene import arm

BLOCK = (Placed(Box(lower=(0.0, 0.0, 0.0), upper=(0.1, 0.1, 0.1))),)


def test_a_tool_may_cut_stock_and_hit_no_fixture() -> None:
    assert may_not_meet("tool", "fixture")
    assert may_not_meet("holder", "fixture")
    assert not may_not_meet("tool", "stock")
    assert (role_of_part("cutting"), role_of_part("shank"), role_of_part("holder")) == ("tool", "tool", "holder")


def test_parts_are_asked_only_against_what_they_may_not_meet() -> None:
    tool = ToolParts.of(FlatEndMill(number=1, diameter=0.01, length=0.05, holder=Holder(diameter=0.04, length=0.05)))

    assert {part for part, _ in tool.against("fixture").outlines} == {"cutting", "holder"}
    assert tool.against("stock").outlines == ()


def test_bodies_are_gathered_by_what_they_stand_on() -> None:
    robot = arm()
    scene = Scene(
        movers={"arm": robot},
        frames={
            "fixture/vise": Stand(WORLD, robot.X_WB),
            "fixture/jaw": Stand("arm/flange", Pose.identity()),
            "stock/plate": Stand(WORLD, Pose.identity()),
        },
        bodies=(
            Body(name="fixture/vise", solids=BLOCK, role="fixture"),
            Body(name="fixture/jaw", solids=BLOCK, role="fixture"),
            Body(name="stock/plate", solids=BLOCK, role="stock"),
        ),
    )

    still, carried = standing_bodies(scene, "arm")

    assert [body.name for body in still.bodies] == ["vise"]
    assert still.carrier is None
    assert abs(still.bodies[0].hulls[0].corners.min()) < 1e-12  # seen from the base, where it stands
    assert [body.name for body in carried.bodies] == ["jaw"]
    assert carried.carrier is not None


def test_pairs_are_asked_for_once_for_two_kinds() -> None:
    """20,000 fixtures on one table are of one kind: whether they may meet is not asked 200 million times."""
    kinds = ["link", *["fixture"] * 20_000, "link"]
    asked: list[tuple[int, int]] = []

    def meets(i: int, j: int) -> bool:
        asked.append((i, j))
        return kinds[i] != kinds[j]

    pairs = pairs_by_kind(kinds, meets)

    assert len(asked) == 4
    assert pairs == [(0, j) for j in range(1, 20_001)] + [(i, 20_001) for i in range(1, 20_001)]
