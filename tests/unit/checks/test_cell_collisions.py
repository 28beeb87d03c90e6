"""What parts, devices and machines of one cell hit: whole runs against plane geometry."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from gcodesim.cell.loader import read_cell
from gcodesim.diagnostics import Diagnostic, SourceText
from gcodesim.simulation import Options, check, prepare
from tests.physics.runs import Ran, run_texts

CELL = """
gcodesim: 1
machine: gantry_xyz
frames: {table: {in: world, xyz: [400, 300, -400]}}
work_offsets: {G54: {in: table}}
m_codes: {M62 P1: {gripper: close}, M63 P1: {gripper: open}}
loaded_tool: 1
tools:
  1: {type: finger_gripper, stroke: 60, force: 60 N, friction: 0.5, length: 120}
  2: {type: flat_end_mill, diameter: 6}
fixtures:
  deck: {box: [600, 300, 20], zero: top-center, in: table}
parts:
  plate: {box: [40, 40, 50], zero: bottom-center, in: table, mass: 0.5 kg}
"""
WALL = "  wall: {box: [1, 200, 60], zero: bottom-center, in: table, xyz: [100, 0, 0]}\n"
DOOR = """devices:
  door: {box: [10, 200, 40], zero: bottom-center, in: table, xyz: [100, 0, 0], word: M64 P3, travel: [0, 0, 100], travel_time: 1 s}
"""  # noqa: E501
START = "G21 G90 G17 G94\nG43 H1\n"
TAKE = START + "G0 X0 Y0 Z150\nG1 Z30 F6000\nM62 P1\nG4 P0.2\n"


def with_fixture(text: str) -> str:
    return CELL.replace("parts:", text + "parts:")


def go(program: str, cell: str = CELL, world: str = "kinematic") -> Ran:
    return run_texts(program + "M2\n", cell, world=world)


def collisions(ran: Ran) -> list[Diagnostic]:
    return [f for f in ran.results.findings if f.code in ("GS308", "GS309", "GS310", "GS311", "GS567")]


def checked(program: str, cell: str) -> list[Diagnostic]:
    """The same by `check`."""
    loaded = read_cell(SourceText("cell.yaml", cell.encode()), Path("cell.yaml"))
    job = prepare(SourceText("program.nc", (program + "M2\n").encode()), loaded, Options(world="kinematic"))
    return [f for f in check(job).findings if f.code in ("GS308", "GS309", "GS310", "GS311", "GS567")]


@pytest.mark.parametrize("world", ["kinematic", "bullet"])
def test_a_held_part_hits_a_wall_that_the_fingers_pass(world: str) -> None:
    """The part reaches 30 mm below the tip, the fingers 0: at Z70 its lower face is at 40 mm, the wall's top at 60."""
    program = TAKE + "G1 Z70 F6000\nG1 X70\nG1 X90\nG1 X130\nG0 Z150\n"

    (hit,) = collisions(go(program, with_fixture(WALL), world))

    assert (hit.code, hit.span.line, hit.bodies) == ("GS309", 9, ("plate", "wall"))
    assert hit.value == pytest.approx(20.0, abs=0.02)  # up and out of it is the shortest way
    assert "held by T1" in hit.message and "X79.500" in hit.message
    assert [(f.code, f.span, f.message) for f in checked(program, with_fixture(WALL))] == [
        (hit.code, hit.span, hit.message)
    ]


def test_without_the_part_the_same_way_is_free() -> None:
    assert not collisions(go(START + "G0 X50 Y0 Z150\nG1 Z70 F6000\nG1 X90\nG0 Z150\n", with_fixture(WALL)))


def test_a_small_fast_move_through_a_thin_wall_is_found() -> None:
    """A part of 2 mm goes through a sheet of 0.1 mm at 60 m/min: within 3 ms."""
    cell = CELL.replace("box: [40, 40, 50]", "box: [2, 40, 50]").replace(
        "parts:", "  sheet: {box: [0.1, 200, 60], zero: bottom-center, in: table, xyz: [100, 0, 0]}\nparts:"
    )

    (hit,) = collisions(go(TAKE + "G1 Z70 F60000\nG1 X80\nG1 X120\nG0 Z150\n", cell))

    assert (hit.code, hit.span.line) == ("GS309", 9)
    assert hit.value == pytest.approx(1.05, abs=0.02)


def test_lifting_sliding_and_setting_down_are_no_findings() -> None:
    moves = "G1 X20\nG1 Y20\nG1 Z90\nG1 X100 Y0\nG1 Z30\nM63 P1\nG4 P0.2\nG1 Z150\n"

    assert not go(TAKE + moves).bad


@pytest.mark.parametrize(("down", "code"), [(29.7, None), (29.0, "GS309")])
def test_a_part_may_be_pressed_onto_its_place_by_half_a_millimetre(down: float, code: str | None) -> None:
    ran = go(TAKE + f"G1 Z90\nG1 X100\nG1 Z{down}\nM63 P1\nG4 P0.2\nG1 Z150\n")

    assert [f.code for f in collisions(ran)] == ([code] if code else [])


def test_a_part_that_was_set_down_is_in_the_way_where_it_is_now() -> None:
    away = TAKE + "G1 Z90\nG1 X150\nG1 Z30\nM63 P1\nG4 P0.2\nG1 Z150\nG0 X0\nG0 Z10\nG0 Z150\n"

    assert not collisions(go(away + "G0 X80\nG0 Z10\nG0 Z150\n"))
    (hit, *_) = collisions(go(away + "G0 X120\nG0 Z10\nG0 Z150\n"))
    assert (hit.code, hit.span.line, set(hit.bodies)) == ("GS309", 17, {"T1", "plate"})


def test_a_held_part_hits_another_part_and_that_is_one_finding() -> None:
    cell = CELL + "  other: {box: [40, 40, 50], zero: bottom-center, in: table, mass: 1 kg, xyz: [100, 0, 0]}\n"

    (hit,) = collisions(go(TAKE + "G1 Z60\nG1 X130\nG0 Z150\n", cell))

    assert (hit.code, hit.span.line, hit.bodies) == ("GS309", 8, ("plate", "other"))
    assert hit.value == pytest.approx(20.0, abs=0.01)


def test_near_misses_of_a_held_part_but_not_of_what_it_stood_on() -> None:
    cell = with_fixture(WALL) + "limits: {clearance: 5 mm}\n"

    (near,) = collisions(go(TAKE + "G1 Z94\nG1 X200\nG0 Z150\n", cell))

    assert (near.code, near.span.line, near.bodies) == ("GS308", 8, ("plate", "wall"))
    assert near.value == pytest.approx(4.0, abs=0.01)


def test_a_door_that_opens_into_the_tool_is_blamed_on_its_word() -> None:
    """It rises between the standing fingers to the body of the gripper, 100 mm up: 60 mm at 100 mm/s."""
    (hit,) = collisions(go(START + "G0 X100 Y0 Z60\nM64 P3\nG4 P2\nG0 Z250\n", CELL + DOOR))

    assert (hit.code, hit.span.line) == ("GS310", 4)
    there = go(START + "G0 X100 Y0 Z60\n", CELL + DOOR).results.times.total
    assert hit.time == pytest.approx(there + 0.6, abs=1e-3)


def test_a_move_into_a_door_that_is_not_open_yet_is_blamed_on_the_move() -> None:
    """The door falls away from 140 mm within a second after `M65`."""
    shut = START + "M64 P3\nG0 X20 Y0 Z60\nG4 P1\n"
    hits = collisions(go(shut + "G1 X160 F9000\nG0 Z150\n", CELL + DOOR))

    assert [(f.code, f.span.line) for f in hits] == [("GS310", 6)]
    assert not collisions(go(shut + "M65 P3\nG4 P1\nG1 X160 F9000\nG0 Z150\n", CELL + DOOR))


def test_a_clamp_may_touch_what_it_clamps() -> None:
    clamp = """devices:
  jaw: {{box: [20, 20, 20], zero: bottom-center, in: table, xyz: [50, 0, 0], word: M64 P3, travel: [{}, 0, 0], travel_time: 1 s}}
"""  # noqa: E501
    program = START + "M64 P3\nG4 P2\nG0 Z200\n"

    assert not collisions(go(program, CELL + clamp.format(-20.3)))
    (hit,) = collisions(go(program, CELL + clamp.format(-21)))
    assert (hit.code, hit.span.line, set(hit.bodies)) == ("GS309", 3, {"jaw", "plate"})
    assert hit.value == pytest.approx(1.0, abs=1e-3)


def test_a_tool_change_with_a_part_held_is_told() -> None:
    (hit,) = collisions(go(TAKE + "G1 Z150\nT2 M6\nG43 H2\nG0 X0 Y0 Z150\n"))

    assert (hit.code, hit.span.line) == ("GS567", 8)
    assert not collisions(go(TAKE + "G1 Z150\nG1 Z30\nM63 P1\nG4 P0.2\nG1 Z150\nT2 M6\nG43 H2\nG0 X0 Y0 Z150\n"))


ARMS = """
gcodesim: 1
robots:
  left: {model: kuka_kr10_r1100_2, base: {in: world}}
  right: {model: kuka_kr10_r1100_2, base: {in: world, xyz: [1300, 0, 0], rpy: [0, 0, 180]}}
frames: {table: {in: world, xyz: [650, 0, 300]}}
channels:
  main: {robot: left, program: left.nc, loaded_tool: 1, work_offsets: {G54: {in: table}}, m_codes: {M200: {wait: free}}}
  right: {robot: right, program: right.nc, loaded_tool: 2, work_offsets: {G54: {in: table}}, m_codes: {M200: {wait: free}}}
tools: {1: {type: probe, diameter: 6, length: 200}, 2: {type: probe, diameter: 6, length: 200}}
simulation: {world: kinematic}
"""  # noqa: E501
HEAD = "G21 G90 G17 G94\nG43 H{}\n"


def arms(folder: Path, left: str, right: str) -> list[Diagnostic]:
    """What `check` says about two arms with these programs."""
    texts = {"left.nc": HEAD.format(1) + left + "M2\n", "right.nc": HEAD.format(2) + right + "M2\n", "cell.yaml": ARMS}
    for name, text in texts.items():
        (folder / name).write_text(text)
    path = folder / "cell.yaml"
    loaded = read_cell(SourceText.read(path, "cell.yaml"), path)
    job = prepare(SourceText.read(folder / "left.nc", "left.nc"), loaded, Options(world="kinematic"))
    return [f for f in check(job).findings if f.code == "GS311"]


def test_two_arms_meet_only_if_they_are_there_at_the_same_time(tmp_path: Path) -> None:
    """Each stands over the middle for a while; with marks, one after the other."""
    there, back = "G0 X0 Y0 Z20\nG4 P1\n", "G0 X{} Y0 Z200\n"

    met = arms(tmp_path, there + back.format(-300), there + back.format(300))
    assert met and met[0].span.file == "left.nc" and met[0].span.line == 3
    assert "`right` is in line 3 of right.nc" in met[0].message

    assert not arms(tmp_path, there + back.format(-300) + "M200\n", "G0 X300 Y0 Z200\nM200\n" + there)


def test_the_time_of_a_meeting_is_that_of_fine_sampling(tmp_path: Path) -> None:
    """Poses of all bodies every 0.1 ms around the time that is told, by the engine's own least gap at rest."""
    from gcodesim.checks.machine_bodies import MachineBodies
    from gcodesim.checks.meetings import JointWay, MovingBodies
    from gcodesim.checks.rigid import RigidBody
    from gcodesim.jobs.collisions import collisions as found_in
    from gcodesim.shop import side_by_side

    arms(tmp_path, "G0 X0 Y0 Z20\n", "G0 X10 Y0 Z20\n")
    path = tmp_path / "cell.yaml"
    job = prepare(SourceText.read(tmp_path / "left.nc", "left.nc"), read_cell(SourceText.read(path, "cell.yaml"), path))
    first = min(found_in(job, None), key=lambda f: f.time or 0.0)
    shops = side_by_side(job.shop, [each.shop for each in job.others])
    plans = [each.plan for each in job.all]

    def gap(time: float) -> float:
        """Of all links of one arm to all of the other, both turned to stone at a time."""
        stones = []
        for shop, plan in zip(shops, plans, strict=True):
            machine = MachineBodies.of(shop.scene, shop.name)
            q = plan.joints(plan.trajectory.sample(np.array([min(time, plan.trajectory.duration)])))[0]
            bodies = [*machine.bodies, *machine.of_tool(shop.cell.tools[1 if shop.name == "left" else 2])]
            still = MovingBodies(machine.tree, [body.rigid for body in bodies], np.zeros((0, 2), dtype=np.int64))
            frames = still._frames(q)
            for body in bodies:
                from gcodesim.frames import Pose

                X = shop.X_WB @ Pose.from_matrix(frames[body.carrier])
                solids = tuple(solid.at(X) for solid in body.rigid.solids)
                stones.append((shop.name, RigidBody(name=body.rigid.name, solids=solids)))
        pairs = [(i, j) for j in range(len(stones)) for i in range(j) if stones[i][0] != stones[j][0]]
        tree = MachineBodies.of(shops[0].scene, shops[0].name).tree
        bodies = MovingBodies(tree, [rigid for _, rigid in stones], np.array(pairs))
        return bodies.least_gap(JointWay.straight(np.zeros((1, len(tree.parent)))))

    assert first.time is not None and first.time > 0.01
    assert gap(first.time - 1e-3) > 0.0 >= gap(first.time + 1e-3)


def test_a_device_that_turns_back_on_its_way_is_where_it_is() -> None:
    """Up for 0.3 s, then down again: its top comes to 70 mm, and the body of the gripper is at 100."""
    program = START + "G0 X100 Y0 Z60\nM64 P3\nG4 P0.3\nM65 P3\nG4 P2\n"

    assert not collisions(go(program + "G0 Z250\n", CELL + DOOR))
    (hit,) = collisions(go(program.replace("P0.3", "P0.7") + "G0 Z250\n", CELL + DOOR))
    assert (hit.code, hit.span.line) == ("GS310", 4)
    assert hit.value == pytest.approx(10.0, abs=0.01)


@pytest.mark.parametrize("pair", ["[plate, wall]", "[wall, plate]"])
def test_pairs_that_may_touch_are_left_out(pair: str) -> None:
    program = TAKE + "G1 Z70 F6000\nG1 X70\nG1 X130\nG0 Z150\n"

    assert not collisions(go(program, with_fixture(WALL) + f"limits: {{may_touch: [{pair}]}}\n"))


def test_a_tool_may_touch_a_fixture_if_the_cell_says_so() -> None:
    into = START + "G0 X135 Y0 Z90\nG1 Z40 F6000\nG0 Z150\n"  # a finger over the wall
    cell = with_fixture(WALL)

    (hit,) = go(into, cell).bad
    assert (hit.code, hit.span.line, hit.bodies) == ("GS304", 4, ("T1", "wall"))
    assert hit.value == pytest.approx(5.5, abs=0.01)  # the finger is from 95 to 105 mm, the wall from 99.5 to 100.5
    assert not go(into, cell + "limits: {may_touch: [[T1, wall]]}\n").bad


def test_a_name_that_is_no_body_is_told_at_its_place() -> None:
    text = CELL + "limits: {may_touch: [[plate, walls]]}\n"
    (finding,) = read_cell(SourceText("cell.yaml", text.encode()), Path("cell.yaml")).findings

    assert finding.code == "GS712" and "walls" in finding.message
    assert text.splitlines()[finding.span.line - 1][finding.span.column - 1 :].startswith("walls")
