"""When moving bodies meet: closed forms, and what the search promises about all it did not look at."""

import math

import numpy as np
import pytest
import trimesh

from gcodesim.checks.gap_kernels import gap_along, gap_between, gap_room, signed_gap
from gcodesim.checks.meetings import JointWay, Meeting, MovingBodies
from gcodesim.checks.rigid import RigidBody, Woods, is_closed, is_convex, is_within
from gcodesim.frames import Pose, rotation_about
from gcodesim.kinematics.chain import Tree
from gcodesim.solids import Box, Cone, Cylinder, Mesh, Placed, Revolution, Solid, Sphere, Triangles, triangles_of

X, Y, Z = np.eye(3)


def tree_of(*axes: tuple[np.ndarray, bool], before: np.ndarray | None = None) -> Tree:
    """Joints one on another, each along or about an axis; they shift where the flag says so."""
    n = len(axes)
    return Tree(
        parent=np.arange(-1, n - 1),
        before=np.tile(np.eye(4), (n, 1, 1)) if before is None else before,
        axis=np.array([axis for axis, _ in axes]),
        prismatic=np.array([int(shifts) for _, shifts in axes]),
        path=np.ones(n, dtype=np.int64),
        carrier=np.zeros(0, dtype=np.int64),
        offset=np.zeros((0, 4, 4)),
        flange_carrier=n - 1,
        flange_offset=np.eye(4),
    )


def body(name: str, solid: Solid, at: tuple[float, float, float] = (0.0, 0.0, 0.0), carrier: int = -1) -> RigidBody:
    return RigidBody(name=name, solids=(Placed(solid, Pose.from_xyz_rpy(at)),), carrier=carrier)


def pair_of(tree: Tree, moving: RigidBody, still: RigidBody) -> MovingBodies:
    return MovingBodies(tree, [moving, still], np.array([[0, 1]]))


BALL = body("ball", Sphere(radius=1e-3), carrier=0)
ALONG_X = tree_of((X, True))


def test_a_fast_ball_is_not_lost_behind_a_thin_wall() -> None:
    wall = body("wall", Box.about_origin((1e-4, 0.1, 0.1)), (0.5, 0.0, 0.0))
    (meeting,) = pair_of(ALONG_X, BALL, wall).search(JointWay.straight(np.array([[0.0], [10.0]])))
    assert meeting.share * 10.0 == pytest.approx(0.5 - 0.05e-3 - 1e-3, abs=1e-6)
    assert -meeting.gap == pytest.approx(1.05e-3, abs=1e-6)  # half the wall and the radius


def test_each_time_is_a_meeting_of_its_own() -> None:
    wall = body("wall", Box.about_origin((0.01, 0.1, 0.1)), (0.5, 0.0, 0.0))
    there_and_back = JointWay.straight(np.array([[0.0], [1.0], [1.2], [0.0]]))
    first, second = pair_of(ALONG_X, BALL, wall).search(there_and_back)
    assert (first.stretch, second.stretch) == (0, 2)
    assert second.share == pytest.approx((1.2 - 0.506) / 1.2, abs=1e-6)


def test_a_stay_in_a_body_over_many_stretches_is_one_meeting() -> None:
    wall = body("wall", Box.about_origin((0.2, 0.1, 0.1)), (0.5, 0.0, 0.0))
    way = JointWay.straight(np.linspace(0.0, 1.0, 201)[:, None])
    (meeting,) = pair_of(ALONG_X, BALL, wall).search(way)
    assert meeting.stretch == 79
    assert 120 <= meeting.last <= 121


@pytest.mark.parametrize("more", [0.0, 1e-13, 3e-13, 1e-12, 1e-11])
def test_a_clearance_that_is_reached_at_the_very_end_of_a_stretch_is_kept_from_there(more: float) -> None:
    """Steps in which its end was looked for were halves of what is left of the stretch, which is nothing."""
    wall = body("wall", Box.about_origin((0.01, 0.1, 0.1)), (0.5, 0.0, 0.0))
    way = JointWay.straight(np.array([[0.0], [0.489 + more], [0.4895], [0.4895]]))
    (meeting,) = pair_of(ALONG_X, BALL, wall).search(way, level=5e-3)
    assert meeting.stretch + meeting.share == pytest.approx(1.0, abs=1e-6)
    assert meeting.gap == pytest.approx(4.5e-3, abs=1e-6)


def test_what_only_slides_on_a_face_does_not_meet() -> None:
    table = body("table", Box.about_origin((2.0, 2.0, 0.1)), (0.0, 0.0, -0.051))
    assert pair_of(ALONG_X, BALL, table).search(JointWay.straight(np.array([[-0.5], [0.5]]))) == []


@pytest.mark.parametrize("gap", [-2e-5, -5e-6, 5e-6, 2e-5])
def test_an_arm_that_swings_by_a_wall_touches_it_in_the_middle_or_not(gap: float) -> None:
    """A ball at the end of a bar of 0.8 m: its way bulges by 0.1 m between both ends."""
    tip = body("tip", Sphere(radius=0.01), (0.8, 0.0, 0.0), carrier=0)
    wall = body("wall", Box(lower=(0.0, -1.0, -1.0), upper=(0.1, 1.0, 1.0)), (0.81 + gap, 0.0, 0.0))
    pair = pair_of(tree_of((Z, False)), tip, wall)
    way = JointWay.straight(np.array([[-0.5], [0.5]]))
    found = pair.search(way)
    assert len(found) == (gap < 0.0)
    if found:
        turn = math.acos((0.8 + gap) / 0.8)
        assert (found[0].share - 0.5) * 0.8 == pytest.approx(-turn * 0.8, abs=1e-5)
        assert gap - 1e-8 <= found[0].gap <= gap + 1.1e-6
    else:
        assert pair.least_gap(way) == pytest.approx(gap, abs=6e-6)


@pytest.mark.parametrize("stretches", [3, 90, 700])
@pytest.mark.parametrize("blunt", [0.0, 0.02])
def test_how_deep_it_is_does_not_depend_on_the_stretches_of_a_way(stretches: int, blunt: float) -> None:
    """A bar that swings 5 mm into a wall: on many stretches it is bounded by few directions, on few by each."""
    tip = body("tip", Sphere(radius=0.01), (0.8, 0.0, 0.0), carrier=0)
    if blunt:  # of three bodies, of which one reaches farther
        ends = [Placed(Sphere(radius=0.01), Pose.from_xyz_rpy((0.8 - blunt * i, 0.001 * i, 0.0))) for i in range(3)]
        tip = RigidBody(name="tip", solids=tuple(ends), carrier=0)
    wall = body("wall", Box(lower=(0.0, -1.0, -1.0), upper=(0.1, 1.0, 1.0)), (0.805, 0.0, 0.0))
    q = np.linspace(-0.5, 0.37, stretches + 1)[:, None]
    (meeting,) = pair_of(tree_of((Z, False)), tip, wall).search(JointWay.straight(q))
    assert -5e-3 - 1e-8 <= meeting.gap <= -5e-3 + 1.1e-6
    stretch, share = meeting.deepest
    assert q[stretch, 0] + share * 0.87 / stretches == pytest.approx(0.0, abs=2e-3)


def test_of_meetings_that_are_not_followed_only_the_beginning_is_known() -> None:
    wall = body("wall", Box.about_origin((0.01, 0.1, 0.1)), (0.5, 0.0, 0.0))
    there_and_back = JointWay.straight(np.array([[0.0], [1.0], [1.2], [0.0]]))
    pair, seen = pair_of(ALONG_X, BALL, wall), []
    whole = pair.search(there_and_back)

    def second(meetings: list[Meeting]) -> list[int]:
        seen.extend(meetings)
        return [1]

    found = pair.search(there_and_back, followed=second)
    assert found[1] == whole[1]
    assert found[0] == seen[0]
    assert [(each.stretch, each.share, each.last) for each in found] == [
        (each.stretch, each.share, each.last) for each in whole
    ]
    assert -1e-5 < found[0].gap < 0.0
    assert whole[0].gap == pytest.approx(-6e-3, abs=1.1e-6)


def test_joints_that_carry_both_bodies_change_nothing() -> None:
    """Two links of one machine are as far apart wherever their common joint stands."""
    tree = tree_of((Z, False), (X, True))
    inner = body("inner", Box.about_origin((0.1, 0.1, 0.1)), carrier=0)
    outer = body("outer", Sphere(radius=0.05), (0.2, 0.0, 0.0), carrier=1)
    pair = pair_of(tree, outer, inner)
    assert pair.least_gap(JointWay.straight(np.array([[0.0, 0.0], [3.0, 0.0]]))) == pytest.approx(0.1, abs=1e-4)
    (meeting,) = pair.search(JointWay.straight(np.array([[0.0, 0.0], [3.0, -0.2]])))
    assert meeting.share == pytest.approx(0.5, abs=1e-5)


def test_what_may_leave_the_straight_way_is_no_meeting_as_long_as_it_need_not_touch() -> None:
    """A gap of 1 mm and a way that is known to 2 mm only: a meeting is what must happen, not what may."""
    wall = body("wall", Box.about_origin((0.1, 0.1, 0.1)), (0.5, 0.0, 0.0))
    way = JointWay(np.array([[0.0], [0.448]]), np.array([[2e-3]]))
    assert pair_of(ALONG_X, BALL, wall).search(way) == []


def test_a_body_inside_a_closed_mesh_meets_it() -> None:
    """Its triangles are not touched; an L has an inside that its hull does not know."""
    outline = [(0, 0), (4, 0), (4, 1), (1, 1), (1, 4), (0, 4)]
    points = np.array([(x, y, z) for z in (0.0, 1.0) for x, y in outline], dtype=float) * 0.1
    low = [(0, 2, 1), (0, 3, 2), (0, 5, 3), (5, 4, 3)]
    faces = [*low, *((a + 6, c + 6, b + 6) for a, b, c in low)]
    for i in range(6):
        j = (i + 1) % 6
        faces += [(i, j, j + 6), (i, j + 6, i + 6)]
    bracket = Mesh.of(points, np.array(faces))
    assert is_closed(bracket.triangles)
    assert not is_convex(bracket.triangles)
    at_rest = JointWay.straight(np.zeros((1, 1)))
    for at, inside in (((0.2, 0.05, 0.05), True), ((0.2, 0.2, 0.05), False)):
        ball = body("ball", Sphere(radius=0.01), at, carrier=0)
        assert bool(pair_of(ALONG_X, ball, body("bracket", bracket)).search(at_rest)) is inside
    corners = bracket.triangles.points[bracket.triangles.faces]
    assert is_within(np.array([[0.2, 0.05, 0.05], [0.2, 0.2, 0.05]]), corners).tolist() == [True, False]


def test_a_convex_mesh_is_one_body() -> None:
    skin = triangles_of(Box.about_origin((0.1, 0.2, 0.3)))
    assert is_convex(skin)
    assert len(body("box", Mesh(source=skin)).convexes.first) == 1


def test_a_dented_body_of_revolution_is_met_only_where_it_is() -> None:
    """A dumbbell: a ball beside its waist is free."""
    dumbbell = Revolution(outline=((0.05, 0.1), (0.05, 0.06), (0.01, 0.05), (0.01, -0.05), (0.05, -0.06), (0.05, -0.1)))
    beside = body("ball", Sphere(radius=0.01), (0.03, 0.0, 0.0), carrier=0)
    pair = pair_of(tree_of((Z, True)), beside, body("dumbbell", dumbbell))
    assert pair.search(JointWay.straight(np.zeros((1, 1)))) == []
    (meeting,) = pair.search(JointWay.straight(np.array([[0.0], [0.1]])))
    assert 0.03 < meeting.share * 0.1 < 0.06


def test_coaxial_round_bodies_keep_their_distance() -> None:
    """A direction along both axes leaves rounding across them, which must not count."""
    R = rotation_about(np.array([0.6, 0.0, 0.8]), 1.234)
    rod = Cylinder(radius=0.04, bottom=0.0, top=0.05)
    for turn in np.linspace(0.0, 3.0, 7):
        spun = R @ rotation_about(Z, float(turn))
        one = RigidBody(name="a", solids=(Placed(rod, Pose(np.zeros(3), R)),), carrier=0)
        other = RigidBody(name="b", solids=(Placed(rod, Pose(R @ np.array([0.0, 0.0, 0.073]), spun)),))
        gap = pair_of(ALONG_X, one, other).least_gap(JointWay.straight(np.zeros((1, 1))))
        assert gap == pytest.approx(0.023, abs=6e-6)


def test_depth_is_the_least_way_out_in_any_direction() -> None:
    """A ball and a cone: the overlap along every one of many directions is at least the depth, and one comes close."""
    rng = np.random.default_rng(3)
    away = rng.normal(size=(20_000, 3))
    away /= np.linalg.norm(away, axis=1)[:, None]
    for _ in range(20):
        radius, half = rng.uniform(0.005, 0.03, 2).tolist()
        turn = rng.normal(size=3)
        R = rotation_about(turn / np.linalg.norm(turn), float(rng.uniform(0.0, 3.0)))
        at = 0.005 * rng.normal(size=3)
        cone = Cone(bottom_radius=radius, top_radius=0.0, bottom=-half, top=half)
        ball = body("ball", Sphere(radius=0.01), carrier=0)
        pair = pair_of(ALONG_X, ball, RigidBody(name="cone", solids=(Placed(cone, Pose(at, R)),)))
        found = pair.search(JointWay.straight(np.zeros((1, 1))))
        along = away @ R[:, 2]
        across = np.sqrt(1.0 - along * along)
        overlap = away @ at + np.maximum(half * along, radius * across - half * along) + 0.01
        if overlap.min() > 1e-4:
            (meeting,) = found
            assert -meeting.gap <= overlap.min() + 1e-8
            assert -meeting.gap == pytest.approx(overlap.min(), abs=8e-4)


def test_a_gap_is_worked_out_only_where_it_is_in_a_range() -> None:
    """A cylinder and a cone: between `low` and `high` it is the gap itself, beyond them a number that says as much."""
    rng, room, n = np.random.default_rng(9), gap_room(), np.zeros(3)
    rod = RigidBody(
        name="rod", solids=(Placed(Cylinder(radius=0.03, bottom=-0.1, top=0.1), Pose.identity()),), carrier=0
    )
    cone = Cone(bottom_radius=0.05, top_radius=0.01, bottom=-0.06, top=0.06)
    convexes, _ = pair_of(ALONG_X, rod, RigidBody(name="cone", solids=(Placed(cone, Pose.identity()),))).table()
    early = {"below": 0, "above": 0, "apart": 0}
    for number in range(600):
        A, B = (Pose((0.02 + 0.08 * (number % 2)) * rng.normal(size=3), np.eye(3)).matrix for _ in range(2))
        turn = rng.normal(size=3)
        B[:3, :3] = rotation_about(turn / np.linalg.norm(turn), float(rng.uniform(0.0, 3.0)))
        gap = signed_gap(0, 1, convexes, A, B, np.inf, room, n)
        low, high = sorted((gap + 0.02 * rng.normal(size=2)).tolist())
        found = gap_between(0, 1, convexes, A, B, low, high, room, n)
        if gap < low:
            assert gap - 1e-7 <= found < low
            early["apart" if gap > 0.0 else "below"] += found > gap + 1e-6
        elif gap >= high:
            assert high <= found <= gap + 1e-7
            assert gap_along(0, 1, convexes, A, B, n, room) >= high - 1e-9
            early["above"] += found < gap - 1e-6
        else:
            assert found == gap
    assert min(early.values()) > 20


def dish(across: int) -> Mesh:
    """A board of 100 x 100 x 10 mm about the origin whose top of small triangles is dented by 0.1 mm in the middle."""
    side = np.linspace(-0.05, 0.05, across + 1)
    x, y = np.meshgrid(side, side, indexing="ij")
    top = np.stack([x, y, 0.005 - 0.1e-3 * (1.0 - 400.0 * x * x) * (1.0 - 400.0 * y * y)], axis=2)
    points = np.concatenate([top.reshape(-1, 3), (top * (1.0, 1.0, 0.0) - (0.0, 0.0, 0.005)).reshape(-1, 3)])
    number = np.arange((across + 1) ** 2).reshape(across + 1, across + 1)
    a, b, c, d = (n.ravel() for n in (number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]))
    upper = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    rim = np.concatenate([number[:-1, 0], number[-1, :-1], number[:0:-1, -1], number[0, :0:-1]])
    after, below = np.roll(rim, -1), number.size
    walls = [np.stack([rim, rim + below, after], axis=1), np.stack([after, rim + below, after + below], axis=1)]
    return Mesh.of(points, np.concatenate([upper, upper[:, ::-1] + below, *walls]))


def test_passing_by_a_fine_mesh_is_one_meeting_at_any_level() -> None:
    """A near miss at 3 mm: the balls around small triangles are no nearer, and the gap is known all the same."""
    assert is_closed(dish(20).triangles) and not is_convex(dish(20).triangles)
    pair = pair_of(ALONG_X, body("ball", Sphere(radius=1e-3), (0.0, 0.02, 9e-3), carrier=0), body("dish", dish(20)))
    (meeting,) = pair.search(JointWay.straight(np.array([[-0.2], [0.2]])), level=5e-3)
    assert meeting.gap == pytest.approx(3e-3, abs=1e-5)
    far = 0.05 + math.sqrt(6e-3**2 - 4e-3**2)  # from the edge
    assert (meeting.share - 0.5) * 0.4 == pytest.approx(-far, abs=1e-4)


def test_bodies_of_many_triangles_are_searched_at_once() -> None:
    """The same with 80,000 triangles; most of them are never looked at."""
    fine = body("dish", dish(200))
    pair = pair_of(ALONG_X, body("ball", Sphere(radius=1e-3), (0.0, 0.02, 9e-3), carrier=0), fine)
    (meeting,) = pair.search(JointWay.straight(np.array([[-0.2], [0.2]])), level=5e-3)
    assert meeting.gap == pytest.approx(3e-3, abs=1e-5)


def test_bodies_of_thousands_of_triangles_pass_close_by_or_meet_where_their_balls_do() -> None:
    """Two dumbbells of 2,560 triangles, which are not convex: so each triangle is a body that may meet each other."""
    radius, apart = 0.05, 0.2
    ball = trimesh.creation.icosphere(subdivisions=3, radius=radius)
    corners, faces = np.array(ball.vertices), np.array(ball.faces, dtype=np.int32)
    points = np.concatenate([corners - apart * X, corners + apart * X])
    dumbbell = Mesh(source=Triangles(points=points, faces=np.concatenate([faces, faces + len(corners)])))
    way = JointWay.straight(np.array([[-0.15], [0.15]]))

    def meetings(gap: float) -> list[Meeting]:
        still = body("still", dumbbell, (0.0, 2.0 * radius + gap, 0.0))
        return pair_of(ALONG_X, body("moving", dumbbell, carrier=0), still).search(way)

    assert meetings(1e-4) == []
    (meeting,) = meetings(-2e-3)
    ahead = math.sqrt((2.0 * radius) ** 2 - (2.0 * radius - 2e-3) ** 2)
    assert meeting.share * 0.3 == pytest.approx(0.15 - ahead, abs=1.5e-3)  # facets lie up to 0.2 mm within the balls


@pytest.mark.parametrize("seed", range(5))
def test_balls_and_boxes_of_a_tree_hold_its_bodies(seed: int) -> None:
    rng = np.random.default_rng(seed)
    solids: list[Solid] = [
        Box.about_origin((2.0, 0.1, 0.3)),
        Cylinder(radius=0.05, bottom=-1.0, top=0.3),
        Sphere(radius=0.2),
        Mesh(source=triangles_of(Cylinder(radius=0.3, bottom=0.0, top=1.0))),
    ]
    placed = tuple(Placed(solid, Pose.from_xyz_rpy(rng.random(3), rng.random(3))) for solid in solids)
    forest = Woods.of([RigidBody(name="body", solids=placed)]).forest
    points = np.concatenate([each.X.apply(triangles_of(each.solid).points) for each in placed])
    away = points - forest.centre[0]
    assert (np.sqrt((away**2).sum(axis=1)) <= forest.radius[0] + 1e-12).all()
    assert (np.abs(away) <= forest.half[0] + 1e-12).all()
    leaves = np.flatnonzero(forest.left < 0)
    near = np.abs(points[:, None] - forest.centre[leaves]) <= forest.half[leaves] + 1e-12
    assert near.all(axis=2).any(axis=1).all()  # each point is in the box of some leaf
    tight = np.array([np.abs(each.X.apply(triangles_of(each.solid).points)).max() for each in placed])
    assert forest.half[leaves].max() <= tight.max()
