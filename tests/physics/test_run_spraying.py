"""Spraying, from program text to the film on bodies, against closed forms; flat and turned, switched in every way."""

from __future__ import annotations

import csv
import importlib
import json
import sys
from math import pi, tan
from pathlib import Path

import numpy as np
import pytest

from gcodesim.cell import load_cell
from gcodesim.cell.loader import read_cell
from gcodesim.diagnostics import SourceText
from gcodesim.playback.scenes import Drawing
from gcodesim.processes.spray_pattern import gaussian_stripe, passes
from gcodesim.simulation import Options, prepare, run
from gcodesim.solids import read_mesh
from tests.physics.runs import Ran, run_texts

ROOT = Path(__file__).parents[2]
HOLDER = "spray_two_arms.holder.nc"
FLOW, SOLIDS, EFFICIENCY, SPEED = 2e-6, 0.5, 0.6, 0.4
SIGMA = 0.5 * 0.2 * tan(12.5 * pi / 180.0)
STRIPE = gaussian_stripe(flow=FLOW, solids=SOLIDS, efficiency=EFFICIENCY, speed=SPEED, sigma=SIGMA)

CELL = """
gcodesim: 1
machine: gantry_xyz
frames: {{table: {{in: world, xyz: [400, 300, -450]}}}}
work_offsets: {{G54: {{in: table}}}}
{bodies}
tools:
  8: {{type: spray_gun, cone: 25 deg, efficiency: 0.6, solids: 0.5, distance: 200{gun}}}
{words}
"""
PANEL = "stock: {{min: [0, 0, -2], max: [300, 200, 0], in: table, resolution: 2, film: {{{film}}}}}"
BY_CODES = "m_codes: {M10: {tool: activate}, M11: {tool: deactivate}}"
ALONG = """G21 G90 G17 G94 G61
T8 M6
G43 H8
G0 X-100 Y{y} Z200
{on}
G1 X400 F24000
{off}
G0 Z300
M2
"""


def sprayed(
    *,
    program: str = ALONG,
    bodies: str = PANEL.format(film=""),
    words: str = BY_CODES,
    gun: str = ", flow: 2 cm^3/s",
    on: str = "M10",
    off: str = "M11",
    y: float = 100.0,
    out: Path | None = None,
    world: str = "kinematic",
    folder: Path | None = None,
) -> Ran:
    cell = CELL.format(bodies=bodies, gun=gun, words=words)
    return run_texts(program.format(on=on, off=off, y=y), cell, out, world=world, folder=folder)


def film_of(ran: Ran, name: str = "stock/stock"):
    film = ran.shop.coated[name].film
    assert film is not None
    return film


def top(film) -> np.ndarray:
    return film.coat.normal[:, 2] > 0.9


@pytest.mark.parametrize("world", ["kinematic", "bullet"])
def test_one_pass_leaves_a_gaussian_stripe(world: str) -> None:
    """flow solids efficiency / speed is its section; thickness across it is the normal distribution."""
    ran = sprayed(world=world)
    film = film_of(ran)
    here = top(film) & (np.abs(film.coat.middle[:, 0] - 0.15) < 0.1)

    y = film.coat.middle[here, 1] - 0.1
    expected = STRIPE.middle * np.exp(-0.5 * (y / SIGMA) ** 2)
    assert film.coat.dry[here] == pytest.approx(expected, abs=2e-3 * STRIPE.middle)
    assert not ran.bad


def test_all_is_accounted_for() -> None:
    """What was sprayed is on the panel, bounced off it or went past; what met it came by the transfer efficiency."""
    ran = sprayed()
    coating = ran.results.as_json()["coating"]

    assert coating["sprayed_mm3"] == pytest.approx(FLOW * ran.results.times.feed * 1e9, abs=FLOW * 4e-3 * 1e9)
    assert coating["solids_mm3"] == pytest.approx(SOLIDS * coating["sprayed_mm3"], rel=1e-9)
    met = coating["film_mm3"] + coating["bounced_mm3"]
    assert coating["film_mm3"] == pytest.approx(EFFICIENCY * met, rel=1e-3)
    assert met + coating["overspray_mm3"] == pytest.approx(coating["solids_mm3"], rel=1e-6)
    # the stripe is 300 mm long; its ends count half a spot, so the panel gets what is sprayed over its own length
    assert coating["film_mm3"] == pytest.approx(STRIPE.section * 0.3 * 1e9, rel=0.01)
    assert coating["overspray_share"] == pytest.approx(1.0 - met / coating["solids_mm3"], abs=1e-6)
    (tool,) = ran.results.as_json()["tools"]
    assert tool["film_mm3"] == pytest.approx(coating["film_mm3"], rel=1e-6)


def test_the_whole_cone_on_the_panel_keeps_its_volume() -> None:
    """A dab of half a second in the middle: film is flow times solids times efficiency times time, within 0.1 %."""
    still = ALONG.replace("X-100", "X150").replace("G1 X400 F24000", "G4 P0.5\nG1 X150.001 F6000")
    coating = sprayed(program=still).results.as_json()["coating"]

    assert coating["film_mm3"] == pytest.approx(EFFICIENCY * coating["solids_mm3"], rel=1e-3)
    assert coating["sprayed_mm3"] == pytest.approx(FLOW * 0.5 * 1e9, rel=0.02)


@pytest.mark.parametrize("pitch", [40.0, 70.0])
def test_parallel_passes_overlap(pitch: float) -> None:
    """The film between many passes is the sum of their stripes."""
    lines = [f"G1 Y{100 + k * pitch} F60000\nG1 X{400 if k % 2 else -100} F24000" for k in range(-3, 4)]
    program = ALONG.replace("G1 X400 F24000", "\n".join(lines)).replace("Y{y}", f"Y{100 - 3 * pitch}")
    film = film_of(sprayed(program=program.replace("X-100", "X400", 1)))
    here = top(film) & (np.abs(film.coat.middle[:, 0] - 0.15) < 0.08) & (np.abs(film.coat.middle[:, 1] - 0.1) < 0.05)

    expected = passes(STRIPE, SIGMA, pitch * 1e-3, film.coat.middle[here, 1] - 0.1)
    assert film.coat.dry[here] == pytest.approx(expected, rel=0.01)


SWITCHES = [
    (BY_CODES, ", flow: 2 cm^3/s", "M10", "M11"),
    ("signals: {spray: {word: M3/M5}}", ", flow: 2 cm^3/s", "S1000 M3", "M5"),
    ("signals: {spray: {word: M62 P1}}", ", flow: 2 cm^3/s", "M62 P1", "M63 P1"),
    ("m_codes: {M64 P2: {tool: activate}, M65 P2: {tool: deactivate}}", ", flow: 2 cm^3/s", "M64 P2", "M65 P2"),
    ("signals: {flow: {word: M67 E0, per: 1 cm^3/s}}", "", "M67 E0 Q2", "M67 E0 Q0"),
    ("signals: {flow: {word: M67 E0, per: 1 cm^3/s}}\n" + BY_CODES, ", flow: 9 cm^3/s", "M68 E0 Q2\nM10", "M11"),
]


@pytest.mark.parametrize(("words", "gun", "on", "off"), SWITCHES)
def test_words_of_the_program_switch_the_gun(words: str, gun: str, on: str, off: str) -> None:
    plain = film_of(sprayed()).volume

    assert film_of(sprayed(words=words, gun=gun, on=on, off=off)).volume == pytest.approx(plain, rel=1e-9)


def test_a_flow_that_is_set_before_the_gun_is_on_sprays_nothing() -> None:
    words = "signals: {flow: {word: M67 E0, per: 1 cm^3/s}}\n" + BY_CODES
    early = ALONG.replace("G0 X-100", "M68 E0 Q2\nG0 X-100")

    assert film_of(sprayed(program=early, words=words, gun="")).volume == pytest.approx(film_of(sprayed()).volume)


def test_a_gun_without_flow_is_told() -> None:
    ran = sprayed(gun="")

    assert ran.misuse == [("GS535", 6)]
    assert ran.results.coating is None


def test_spray_beside_the_part_is_told_with_its_line() -> None:
    assert sprayed(y=-300).misuse == [("GS533", 6)]


@pytest.mark.parametrize(("z", "words"), [(80, "too near: 8"), (320, "too far: 3")])
def test_a_wrong_distance_is_told(z: int, words: str) -> None:
    (finding,) = sprayed(program=ALONG.replace("Z200", f"Z{z}")).bad

    assert (finding.code, finding.span.line) == ("GS534", 6)
    assert words in finding.message


def three_passes(pitch: float, film: str, out: Path | None = None) -> Ran:
    """A panel of 300 x 200 mm and three passes over it."""
    program = ALONG.replace(
        "G1 X400 F24000", f"G1 X400 F24000\nM11\nG0 Y100\nM10\nG1 X-100\nM11\nG0 Y{100 + pitch}\nM10\nG1 X400"
    )
    return sprayed(program=program, y=100 - pitch, bodies=PANEL.format(film=film), out=out)


def test_three_passes_over_a_panel(tmp_path: Path) -> None:
    """Least, mean and most inside the panel, the uncovered share, overspray; files with the film of each face."""
    inside = "least: 10 um, most: 40 um, inside: {min: [0, 60, -1], max: [300, 140, 1]}"
    ran = three_passes(50.0, inside, tmp_path)
    results = json.loads((tmp_path / "results.json").read_text())
    body = results["coating"]["bodies"]["stock"]
    film = film_of(ran)
    dry, area = film.coat.dry, film.coat.area
    middle = film.coat.middle
    here = top(film) & (middle[:, 1] >= 0.06) & (middle[:, 1] <= 0.14)

    assert not ran.bad
    assert body["least_um"] == pytest.approx(dry[here].min() * 1e6, rel=1e-6)
    assert body["mean_um"] == pytest.approx((dry * area)[here].sum() / area[here].sum() * 1e6, rel=1e-6)
    assert body["uncovered_share"] == 0.0
    expected = passes(STRIPE, SIGMA, 0.05, np.linspace(-0.025, 0.025, 101))
    assert body["most_um"] == pytest.approx(expected.max() * 1e6, rel=0.03)

    with (tmp_path / "stock.film.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == body["faces"] == len(film)
    volume = sum(float(row["film_um"]) * 1e-3 * float(row["area_mm2"]) for row in rows)
    assert volume == pytest.approx(results["coating"]["film_mm3"], rel=1e-4)
    points, faces = read_mesh(tmp_path / "stock.film.ply", 1e-3)
    assert len(faces) == len(film)
    a, b, c = (points[faces[:, k]] for k in range(3))
    assert 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() == pytest.approx(film.area, rel=1e-5)


def test_passes_too_far_apart_are_told_with_the_place() -> None:
    (finding,) = three_passes(95.0, "least: 10 um, inside: {min: [20, 20, -1], max: [280, 180, 1]}").bad

    assert finding.code == "GS530" and "film below 10 µm on `stock`" in finding.message
    y = float(finding.message.split(" Y")[1].split()[0])
    assert min(abs(y - 52.5), abs(y - 147.5)) < 4.0  # half-way between two passes
    assert finding.value == pytest.approx(passes(STRIPE, SIGMA, 0.095, np.array([0.0475]))[0] * 1e6, rel=0.03)


def test_a_stock_is_coated_as_it_was_milled() -> None:
    """A pocket of 3 mm is cut first: its floor has film, and it is told when the film is cut afterwards."""
    mill = "T1 M6\nG43 H1\nS9000 M3\nG0 X20 Y100 Z20\nG0 Z2\nG1 Z-1.5 F600\nG1 X280 F3000\nG0 Z100\nM5\n"
    lines = ALONG.splitlines(keepends=True)
    first = "".join([lines[0], mill, *lines[1:]])
    last = "".join([*lines[:-1], mill, lines[-1]])
    bodies = PANEL.format(film="").replace("resolution: 2", "resolution: 1, material: al6082_t6")
    tools = ", flow: 2 cm^3/s}\n  1: {type: flat_end_mill, diameter: 20, length: 120"
    before = sprayed(program=first, bodies=bodies, gun=tools)
    after = sprayed(program=last, bodies=bodies, gun=tools)

    film = film_of(before)
    floor = top(film) & (np.abs(film.coat.middle[:, 2] + 1.5e-3) < 1e-5)
    assert film.coat.area[floor].sum() == pytest.approx(0.26 * 0.02 + 0.25 * pi * 0.02**2, rel=0.05)
    middle = floor & (np.abs(film.coat.middle[:, 1] - 0.1) < 5e-3) & (np.abs(film.coat.middle[:, 0] - 0.15) < 0.11)
    assert (film.coat.dry[middle] > 0.9 * STRIPE.middle).all()  # at its ends the walls keep some off
    assert [f.code for f in before.bad] == []
    assert [f.code for f in after.bad] == ["GS538"]


def test_fixtures_shade_and_are_coated_on_request() -> None:
    """A box over the panel takes the film of what is below it; with the key `film` it is coated itself."""
    bar = "fixtures: {{bar: {{box: [40, 200, 10], in: table, xyz: [130, 0, 40]{film}}}}}"
    bodies = PANEL.format(film="") + "\n" + bar.format(film="")
    ran = sprayed(bodies=bodies)
    film = film_of(ran)
    below = top(film) & (np.abs(film.coat.middle[:, 0] - 0.15) < 0.005) & (np.abs(film.coat.middle[:, 1] - 0.1) < 0.02)
    plain = film_of(sprayed())

    assert film.coat.dry[below].max() < 0.6 * plain.coat.dry[below].min()
    both = sprayed(bodies=PANEL.format(film="") + "\n" + bar.format(film=", film: {}"))
    bar_film = film_of(both, "fixture/bar")
    assert np.array_equal(film_of(both).coat.dry, film.coat.dry)
    up = bar_film.coat.normal[:, 2] > 0.9
    assert bar_film.coat.dry[up].max() == pytest.approx(STRIPE.middle * 200 / 150, rel=0.02)
    assert set(both.results.as_json()["coating"]["bodies"]) == {"stock", "bar"}


def test_a_part_is_coated_on_its_own_triangles(tmp_path: Path) -> None:
    """A mesh under `parts`, turned: what it gets depends on where it stands, not on how it is described."""
    part = "parts: {{door: {{box: [300, 200, 2], in: table, {place}, mass: 1 kg}}}}"
    flat = film_of(sprayed(bodies=part.format(place="xyz: [0, 0, -2]")), "part/door")
    turned = film_of(sprayed(bodies=part.format(place="xyz: [300, 200, -2], rpy: [0, 0, 180]")), "part/door")

    assert flat.volume == pytest.approx(STRIPE.section * 0.3, rel=0.01)
    assert turned.volume == pytest.approx(flat.volume, rel=1e-6)
    assert turned.coat.dry.max() == pytest.approx(flat.coat.dry.max(), rel=1e-3)


def test_film_does_not_depend_on_the_step() -> None:
    coarse = film_of(sprayed(words=BY_CODES + "\nsimulation: {rate: 100 Hz}"))
    fine = film_of(sprayed(words=BY_CODES + "\nsimulation: {rate: 500 Hz}"))
    here = top(fine) & (np.abs(fine.coat.middle[:, 0] - 0.15) < 0.1)

    assert coarse.coat.dry[here] == pytest.approx(fine.coat.dry[here], abs=1e-4 * STRIPE.middle)


def test_a_panel_that_another_arm_moves_gets_the_film_of_passes() -> None:
    """Six stripes 40 mm apart, one arm brings the panel, the other paints: mean = flow solids eff / (v pitch)."""
    loaded = load_cell(ROOT / "cells" / "spray_two_arms.yaml")
    texts = [SourceText(name, (ROOT / "programs" / name).read_bytes()) for name in ("spray_two_arms.nc", HOLDER)]
    job = prepare(texts[0], loaded, Options(world="kinematic", channels={"holder": texts[1]}))
    results, execution = run(job)
    assert execution is not None and job.shop is not None
    film = job.shop.coated["part/panel"].film
    assert film is not None and results.coating is not None

    expected = 1.5e-6 * 0.45 * 0.65 / (0.3 * 0.04)
    x, y, _ = film.coat.middle.T
    middle = top(film) & (np.abs(x) < 0.05) & (np.abs(y) < 0.04)
    assert film.coat.dry[middle].mean() == pytest.approx(expected, rel=0.02)
    assert np.ptp(film.coat.dry[middle]) < 0.15 * expected
    assert not film.coat.dry[film.coat.normal[:, 2] < -0.9].any()  # the side at the flange
    painted = results.coating["film_mm3"] + results.coating["bounced_mm3"] + results.coating["overspray_mm3"]
    assert painted == pytest.approx(results.coating["solids_mm3"], rel=1e-6)


def by_two_arms(panel: str, world: str) -> tuple[np.ndarray, float]:
    """The film of the example of two arms, whose holder has a suction gripper; how far [m] the panel was carried."""
    text = (ROOT / "cells" / "spray_two_arms.yaml").read_text()
    gripper = "tools:\n  9: {type: suction_gripper, cups: [{diameter: 60}], friction: 0.6, length: 80}\n"
    text = text.replace("tools:\n", gripper).replace("    in: holder/flange", panel)
    text = text.replace("    robot: holder\n", "    robot: holder\n    loaded_tool: 9\n")
    marks = "m_codes: {M200: {wait: panel_there}, M201: {wait: stripe_done}"
    text = text.replace(marks + "}\ntools", marks + ", M62 P1: {gripper: close}}\ntools")
    programs = {name: (ROOT / "programs" / name).read_text() for name in ("spray_two_arms.nc", HOLDER)}
    held = programs[HOLDER].replace("G0 X30 Y#1 Z0\n", "G43 H9\nG0 X30 Y#1 Z0\nM62 P1\nG4 P0.1\n")
    sources = [SourceText("a.nc", programs["spray_two_arms.nc"].encode()), SourceText("b.nc", held.encode())]
    loaded = read_cell(SourceText("cell.yaml", text.encode()), Path("cell.yaml"))
    job = prepare(sources[0], loaded, Options(world=world, channels={"holder": sources[1]}))
    results, execution = run(job)
    assert execution is not None and job.shop is not None
    assert not [f for f in results.findings if f.code.startswith("GS56") and f.code != "GS566"]
    film = job.shop.coated["part/panel"].film
    assert film is not None
    return film.coat.dry, execution.parts["part/panel"].moved


@pytest.mark.parametrize("world", ["kinematic", "bullet"])
def test_film_follows_a_panel_that_a_gripper_holds(world: str) -> None:
    """A panel fixed to the flange, and one that is taken from where the first one is by then: the same film."""
    fixed, _ = by_two_arms("    in: holder/flange\n    xyz: [0, 0, 80]", "kinematic")
    taken, moved = by_two_arms("    in: middle\n    xyz: [30, -100, 0]\n    rpy: [-90, 0, 90]", world)

    assert moved == pytest.approx(0.24, abs=1e-3)
    assert taken.max() > 20e-6
    np.testing.assert_allclose(taken, fixed, rtol=1e-6, atol=1e-12)


def test_the_film_is_in_the_log_and_in_the_model(tmp_path: Path) -> None:
    """Entities in the frame of the body, coloured in classes of thickness, growing; the part's STL is without them."""
    from gcodesim.export.model import scene_glb
    from gcodesim.export.part import write_part
    from gcodesim.playback import Recording

    program = ALONG.replace("{y}", "100").replace("{on}", "M10").replace("{off}", "M11").replace("F24000", "F2000")
    ran = sprayed(program=program, out=tmp_path)
    recording = Recording.open(tmp_path)
    film = ran.shop.coated["stock/stock"].film
    assert film is not None

    def drawn(t_ns: int) -> list[Drawing]:
        return [drawing for drawing in recording.stock_at(t_ns) if drawing.id == "film/stock/stock"]

    (end,) = drawn(recording.end_ns)
    counts = np.histogram(film.coat.dry[film.coat.dry >= 1e-6] / film.coat.dry.max(), np.arange(9) / 8)[0]
    assert end.frame == "stock" and len({shape.color for shape in end.shapes}) == len(end.shapes)
    assert [len(shape.triangles) for shape in end.shapes] == [count for count in counts.tolist() if count]
    (middle,) = drawn(recording.end_ns // 2)
    faces = [sum(len(shape.triangles) for shape in each.shapes) for each in (middle, end)]
    assert 0 < faces[0] < faces[1]
    assert b"film/stock/stock" in scene_glb(recording, recording.end_ns)

    files = [tmp_path / "exact.stl", tmp_path / "drawn.stl"]
    with files[0].open("wb") as exact, files[1].open("wb") as coarse:
        write_part(recording, exact)
        write_part(recording, coarse, t_ns=recording.end_ns)
    tops = [read_mesh(file)[0][:, 2].max() for file in files]
    assert tops[0] == pytest.approx(tops[1], abs=1e-4)  # mm; the film is drawn 0.2 mm above


def test_two_arms_moved_by_one_script_paint_as_their_programs_do(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "programs"))
    script = importlib.import_module("painted_together")
    monkeypatch.setattr(sys, "argv", ["painted_together.py", str(tmp_path)])
    script.main()
    assert capsys.readouterr().out == "6 stripes in 10.4 s: 34.0 to 43.0 µm of paint\n"
    known = json.loads((ROOT / "programs" / "spray_two_arms.golden.json").read_text())["results"]["coating"]
    film = json.loads((tmp_path / "results.json").read_text())["coating"]
    assert film["film_mm3"] == pytest.approx(known["film_mm3"], rel=2e-3)
    for name in ("least_um", "mean_um", "most_um"):
        assert film["bodies"]["panel"][name] == pytest.approx(known["bodies"]["panel"][name], rel=2e-3)
