"""What leaves a nozzle, a gun or a torch is in the work or told as lost; what is milled is in the balance: drawn runs.

The truth of each is counted here from the words of the program, never asked of the project.
"""

from __future__ import annotations

from math import hypot, pi, sin

import numpy as np
import pytest

from tests.physics.runs import Ran, run_texts

FILAMENT = 0.25 * pi * 1.75**2  # [mm²]
KEPT = 5e-3
"""Share within which volume has to be conserved."""

COUNTED = 2e-5
"""Share within which sums agree: the log's and the results' figures are rounded, nothing else is."""

PRINTER = """
gcodesim: 1
machine: gantry_xyz
dialect: marlin
work_offsets: {{G54: {{in: world, xyz: [400, 300, -200]}}}}
stock: {{min: [0, 0, -4], max: [60, 40, 0], in: G54, resolution: {cell}}}
tools:
  0: {{type: extruder, bead_width: 2, bead_height: 1, length: 40}}
  1: {{type: flat_end_mill, diameter: 4, flutes: 3, length: 40}}
"""


class DrawnPrint:
    """Random lines of E, some over each other, some over the border, some in the air, with blobs and retractions."""

    def __init__(self, seed: int) -> None:
        self.rng = np.random.default_rng(seed)
        self.lines = ["M83", "G28", "G1 Z1 F6000"]
        self.place, self.pushed, self.most = (30.0, 20.0), 0.0, 0.0
        self.forward = 0.0

    def push(self, step: float) -> None:
        """E by `step` [mm]; only what goes beyond the farthest place comes out."""
        self.pushed += step
        self.forward += max(self.pushed - self.most, 0.0)
        self.most = max(self.most, self.pushed)

    def go(self, x: float, y: float, share: float | None) -> None:
        length = hypot(x - self.place[0], y - self.place[1])
        step = 0.0 if share is None else round(share * length * (1.0 + 0.25 * pi) / FILAMENT, 5)
        words = f"G1 X{x:.3f} Y{y:.3f} F{self.rng.integers(600, 6000)}"
        self.lines.append(words + (f" E{step:.5f}" if step else ""))
        self.place = (x, y)
        self.push(step)

    def layer(self, z: float, moves: int) -> None:
        self.lines.append(f"G1 Z{z:.2f} F3000")
        for _ in range(moves):
            what = self.rng.random()
            x, y = (float(self.rng.uniform(low, high)) for low, high in ((-6, 66), (-6, 46)))
            if what < 0.15:
                self.filament(float(self.rng.uniform(-4.0, 6.0)))
            elif what < 0.3:
                self.go(x, y, None)
            else:
                self.go(x, y, float(self.rng.uniform(0.3, 1.8)))

    def filament(self, step: float) -> None:
        step = round(step, 4)
        self.lines.append(f"G1 E{step} F900")
        self.push(step)

    def text(self) -> str:
        return "\n".join([*self.lines, "G1 Z30 F6000", ""])

    @property
    def volume(self) -> float:
        """What leaves the nozzle [mm³]."""
        return self.forward * FILAMENT


def balance(ran: Ran) -> float:
    """What lies in the stock or is told as lost [mm³]."""
    lost = sum(tool.get("beside_mm3", 0.0) + tool.get("fallen_mm3", 0.0) for tool in ran.results.tools)
    return float(ran.stock.deposited * 1e9 + lost)


@pytest.mark.parametrize("cell", [2.0, 0.7, 0.25])
@pytest.mark.parametrize("seed", range(4))
def test_what_leaves_the_nozzle_is_in_the_stock_or_told(seed: int, cell: float) -> None:
    drawn = DrawnPrint(seed)
    for z in (1.0, 2.0, 2.6, 9.0):
        drawn.layer(z, 14)
    ran = run_texts(drawn.text(), PRINTER.format(cell=cell))

    assert balance(ran) == pytest.approx(drawn.volume, rel=COUNTED)
    assert sum(tool.get("extruded_mm3", 0.0) for tool in ran.results.tools) == pytest.approx(drawn.volume, rel=COUNTED)
    assert ran.stock.remaining - ran.stock.initial == pytest.approx(ran.stock.deposited, rel=1e-9)
    assert 0.0 < ran.stock.deposited * 1e9 < drawn.volume


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4, 60))
def test_what_leaves_the_nozzle_is_in_the_stock_or_told_of_many(seed: int) -> None:
    cell = (3.0, 1.3, 0.7, 0.41)[seed % 4]
    drawn = DrawnPrint(seed)
    for z in (1.0, 1.4, 2.4, 3.1, 15.0):
        drawn.layer(z, 20)
    assert balance(run_texts(drawn.text(), PRINTER.format(cell=cell))) == pytest.approx(drawn.volume, rel=COUNTED)


@pytest.mark.parametrize("cell", [1.0, 0.4])
@pytest.mark.parametrize("seed", [0, 1])
def test_what_was_printed_and_milled_balances(seed: int, cell: float) -> None:
    """Initial, and laid, less removed, is what remains, in the columns and in the skin that users export."""
    drawn = DrawnPrint(seed)
    for z in (1.0, 2.0, 3.0):
        drawn.layer(z, 14)
    cut = "G1 Z30 F6000\nT1\nG1 X-5 Y12 F6000\nG1 Z1.5\nG1 X65 F900\nG1 Y27\nG1 Z-1\nG1 X-5\nG1 Z30 F6000\n"
    ran = run_texts(drawn.text() + cut, PRINTER.format(cell=cell))
    (placed,) = ran.shop.stocks.values()
    stock = ran.stock

    assert balance(ran) == pytest.approx(drawn.volume, rel=COUNTED)
    assert stock.removed * 1e9 > 4.0 * 60.0  # the second pass is a slot in the plate, 1 mm deep
    assert stock.remaining == pytest.approx(stock.initial + stock.deposited - stock.removed, rel=1e-9)
    assert placed.stock.volume == pytest.approx(stock.remaining, rel=1e-9)
    skin = placed.stock.surface()
    a, b, c = (skin.vertices[skin.faces[:, k]] for k in range(3))
    within = abs(float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum()) / 6.0)
    assert within == pytest.approx(stock.remaining, rel=KEPT)


@pytest.mark.parametrize("cell", [1.0, 0.4])
@pytest.mark.parametrize("waves", [0, 5])
def test_a_spiral_vase_keeps_its_volume(waves: int, cell: float) -> None:
    """One bead that rises all the time, round or wavy; its E is counted here."""
    lines, volume, before = ["M83", "G28"], 0.0, None
    for k in range(6 * 72 + 1):
        turn = 2.0 * pi * k / 72
        r = 14.0 + (2.0 * sin(waves * turn) if waves else 0.0)
        x, y, z = 30 + r * np.cos(turn), 20 + r * np.sin(turn), 1.0 + max(k / 72 - 1.0, 0.0)
        if before is None:
            lines.append(f"G1 X{x:.3f} Y{y:.3f} Z{z:.3f} F6000")
        else:
            step = round(hypot(x - before[0], y - before[1]) * (1.0 + 0.25 * pi) / FILAMENT, 5)
            lines.append(f"G1 X{x:.3f} Y{y:.3f} Z{z:.3f} E{step} F1800")
            volume += step * FILAMENT
        before = (x, y)
    ran = run_texts("\n".join([*lines, "G1 Z30 F6000", ""]), PRINTER.format(cell=cell))

    assert balance(ran) == pytest.approx(volume, rel=COUNTED)
    assert ran.stock.deposited * 1e9 == pytest.approx(volume, rel=KEPT)  # all of it is over the plate


GUN = """
gcodesim: 1
machine: gantry_xyz
frames: {{table: {{in: world, xyz: [400, 300, -450]}}}}
work_offsets: {{G54: {{in: table}}}}
stock: {{min: [0, 0, -2], max: [300, 200, 0], in: table, resolution: {cell}, film: {{}}}}
fixtures: {{post: {{box: [40, 40, 30], zero: bottom-center, in: table, xyz: [150, 100, 0]}}}}
tools: {{8: {{type: spray_gun, cone: {cone} deg, efficiency: {share}, solids: 0.45, distance: 180, flow: 3 cm^3/s}}}}
m_codes: {{M10: {{tool: activate}}, M11: {{tool: deactivate}}}}
"""


@pytest.mark.parametrize(("seed", "cell", "cone", "share"), [(0, 4, 25, 0.7), (1, 8, 40, 0.35), (2, 6, 15, 1.0)])
def test_film_is_what_was_sprayed_times_the_efficiency(seed: int, cell: float, cone: float, share: float) -> None:
    """Over the border, over a post that shades: what met something is film or bounced, the rest is told as beside."""
    rng = np.random.default_rng(seed)
    text = f"G21 G90 G61\nT8 M6\nG43 H8\nG0 X0 Y0 Z{rng.uniform(150, 210):.1f}\nM10\n"
    for _ in range(6):
        text += f"G1 X{rng.uniform(-60, 360):.1f} Y{rng.uniform(-40, 240):.1f} F{rng.integers(9000, 30000)}\n"
    coating = run_texts(text + "M11\nG0 Z300\nM2\n", GUN.format(cell=cell, cone=cone, share=share)).results.as_json()[
        "coating"
    ]

    assert coating["solids_mm3"] == pytest.approx(0.45 * coating["sprayed_mm3"], rel=COUNTED)
    met = coating["film_mm3"] + coating["bounced_mm3"]
    assert met + coating["overspray_mm3"] == pytest.approx(coating["solids_mm3"], rel=COUNTED)
    assert coating["film_mm3"] == pytest.approx(share * met, rel=KEPT)
    assert 0.0 < coating["film_mm3"] < share * coating["solids_mm3"]


TORCH = """
gcodesim: 1
machine: gantry_xyz
work_offsets: {{G54: {{in: world, xyz: [400, 300, -200]}}}}
stock: {{min: [0, 0, -5], max: [60, 40, 0], in: G54, resolution: {cell}}}
tools: {{1: {{type: welding_torch, wire_speed: 8 m/min, voltage: 22 V, current: 180 A, length: 120}}}}
m_codes: {{M10: {{tool: activate}}, M11: {{tool: deactivate}}}}
"""


@pytest.mark.parametrize(("seed", "cell"), [(0, 1.0), (1, 0.5)])
def test_wire_is_in_the_bead_or_told(seed: int, cell: float) -> None:
    """Seams across each other and past the border."""
    rng = np.random.default_rng(seed)
    text = "G21 G90 G61\nT1 M6\nG43 H1\nG0 X10 Y10\nG0 Z2\nM10\n"
    for _ in range(6):
        text += f"G1 X{rng.uniform(-10, 70):.2f} Y{rng.uniform(-8, 48):.2f} F{rng.integers(300, 900)}\n"
    ran = run_texts(text + "M11\nG0 Z40\nM2\n", TORCH.format(cell=cell))
    (tool,) = ran.results.tools

    wire = 0.25 * pi * 1.2**2 * 8000.0 / 60.0 * ran.results.times.feed  # [mm³]
    assert tool["wire_mm3"] == pytest.approx(wire, rel=KEPT)
    lost = tool["spatter_mm3"] + tool["arc_on_nothing_mm3"]
    assert ran.stock.deposited * 1e9 + lost == pytest.approx(tool["wire_mm3"], rel=COUNTED)
    assert ran.stock.deposited * 1e9 < 0.97 * tool["wire_mm3"]
