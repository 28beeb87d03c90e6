"""What a control knows of the way ahead: against a slow twin of LinuxCNC's queue, times that it took, closed forms."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from gcodesim.diagnostics import SourceText
from gcodesim.motion import build_tool_path
from gcodesim.motion.blend import blend
from gcodesim.motion.look_ahead import LookAhead
from gcodesim.motion.pieces import AxisLimits
from gcodesim.motion.sight_kernels import Queue, SeenCaps, within_sight
from gcodesim.motion.timing import Caps, Softness, time_law
from gcodesim.motion.timing_kernels import end_speeds
from gcodesim.motion.trajectory import Trajectory
from gcodesim.rs274 import Settings, interpret

LINUXCNC = LookAhead(blocks=50, corners_count=True)


def limits(*acceleration: float, speed: float = 1.0) -> AxisLimits:
    """Of X, Y and Z [m/s²], [m/s]."""
    none = (math.inf,) * 3
    return AxisLimits(speed=np.array((speed,) * 3 + none), acceleration=np.array(acceleration + none))


SLOW, QUICK = limits(0.6, 1.5, 0.4, speed=0.2), limits(8.0, 8.0, 10.0)


def run(program: str, machine: AxisLimits, look_ahead: LookAhead | None) -> Trajectory:
    reading = interpret(SourceText("chords.ngc", program.encode()), Settings())
    path = build_tool_path(reading)
    assert reading.failed is None
    return time_law(blend(path, machine), look_ahead=look_ahead)


def chords(
    point: Callable[[float], tuple[float, float, float]], way: float, count: int, feed: int, control: str
) -> str:
    """A curve in chords of about `way` [mm]."""
    points = [point(k * way) for k in range(1, count + 1)]
    blocks = [f"G1 X{x:.6f} Y{y:.6f} Z{z:.6f} F{feed}" for x, y, z in points]
    return "\n".join(["G21 G90 G94 G17 G40 " + control, *blocks, "M2", ""])


def circle(radius: float) -> Callable[[float], tuple[float, float, float]]:
    return lambda s: (radius * (math.cos(s / radius) - 1.0), radius * math.sin(s / radius), 0.0)


def wave(s: float) -> tuple[float, float, float]:
    return 0.9 * s, 3.0 * math.sin(s / 9.0), -2.0 + 2.0 * math.cos(s / 14.0)


@pytest.mark.parametrize(
    ("program", "machine", "seconds"),
    [
        (chords(circle(80.0), 0.05, 321, 6000, "G61"), SLOW, 0.366),
        (chords(wave, 0.4, 272, 12000, "G64 P0.05 Q0.001"), SLOW, 1.341),
        (chords(circle(10.0), 0.8, 328, 12000, "G64 P0.001 Q0.00001"), QUICK, 2.786),
        (chords(circle(30.0), 0.1, 361, 12000, "G64 P0.05 Q0.001"), QUICK, 0.234),
    ],
    ids=["a cycle each", "fifty pieces", "no peaks between corners", "merged"],
)
def test_short_blocks_take_as_long_as_on_linuxcnc(program: str, machine: AxisLimits, seconds: float) -> None:
    """Recorded from LinuxCNC 2.9 as `tests/data/motion` is: its joint interpolator adds some 6 ms."""
    assert run(program, machine, LINUXCNC).duration == pytest.approx(seconds - 0.006, rel=0.025)


def test_a_straight_line_in_blocks_has_the_speed_of_its_closed_form() -> None:
    """Over 50 blocks of 0.1 mm and half of one more 4 m/s² end a speed of sqrt(2 a d), which is kept from there on."""
    machine = limits(4.0, 4.0, 4.0)
    program = chords(lambda s: (s, 0.0, 0.0), 0.1, 600, 60000, "G61")

    seen = run(program, machine, LINUXCNC)

    assert run(program, machine, None).sample(np.array([0.1])).speed[0] == pytest.approx(0.1 / 1.02, rel=0.05)
    further = LookAhead(blocks=100, corners_count=True)
    assert seen.duration == run(program, machine, further).duration  # a cycle for each block is the limit
    shorter = run(program, machine, LookAhead(blocks=5))
    assert shorter.sample(np.array([0.5 * shorter.duration])).speed.max() <= math.sqrt(2.0 * 4.0 * 6.5e-4)
    assert shorter.sample(np.array([0.5 * shorter.duration])).speed.max() >= math.sqrt(2.0 * 4.0 * 5.5e-4)


@pytest.mark.parametrize("control", ["G61", "G64 P0.01 Q0.000001"])
def test_half_of_the_last_block_before_a_stop_is_not_counted_on(control: str) -> None:
    """It may be entered no faster than sqrt(a d) (`tpRunOptimization` in tp.c), also before a dwell; grbl takes all."""
    blocks = ["G1 X30 F6000", "X31 Y0.0001", "G4 P0.1", "G1 X61", "X62 Y0.0002"]
    program = "\n".join(["G21 G90 G94 G17 G40 " + control, *blocks, "M2", ""])
    share = 0.5 if control[:3] == "G64" else 1.0  # a block that ends in G64 has half of its acceleration

    linuxcnc = run(program, limits(3.0, 3.0, 3.0), LINUXCNC)
    grbl = run(program, limits(3.0, 3.0, 3.0), LookAhead(blocks=50))

    ends = linuxcnc.row_end[[0, 2]] - 1e-9
    assert linuxcnc.sample(ends).speed == pytest.approx([math.sqrt(share * 3.0 * 1e-3)] * 2, rel=0.01)
    assert grbl.sample(grbl.row_end[[0, 2]] - 1e-9).speed == pytest.approx(
        [math.sqrt(share * 6.0 * 1e-3)] * 2, rel=0.01
    )


def test_the_queue_agrees_with_a_slow_twin() -> None:
    rng = np.random.default_rng(14)
    lowered = 0
    for _ in range(20):
        n = 120
        joint = np.zeros(n, dtype=bool)
        joint[1:-1:2] = rng.random((n - 1) // 2) < 0.6
        counted = joint | (rng.random(n) < 0.8)
        junction = np.where(rng.random(n) < 0.03, 0.0, rng.uniform(0.1, 2.0, n))
        rest = (junction == 0.0) | (np.arange(n) == n - 1)
        length, speed, push = rng.uniform(1e-5, 1e-3, n), rng.uniform(0.05, 0.5, n), rng.uniform(0.5, 3.0, n)
        caps = SeenCaps(length, speed, push, np.zeros(n), junction)
        depth = int(rng.integers(2, 12))

        seen = within_sight(caps, Queue(np.arange(n), 0.5 * length, joint, counted, rest), depth)

        assert np.allclose(ends(caps, seen), ends(caps, twin(caps, joint, counted, rest, depth)), atol=1e-12)
        lowered += int((ends(caps, seen) < ends(caps, junction) - 1e-6).any())
    assert lowered > 10


def ends(caps: SeenCaps, junction: np.ndarray) -> np.ndarray:
    one, no = np.ones(len(junction)), np.zeros(len(junction), dtype=bool)
    return end_speeds(caps.length, caps.speed, caps.acceleration, junction, one, no)[1]


def twin(caps: SeenCaps, joint: np.ndarray, counted: np.ndarray, rest: np.ndarray, depth: int) -> np.ndarray:
    """Go back over the queue whenever a block comes in, as the control does."""
    n = len(joint)
    final = np.zeros(n)
    for newest in np.flatnonzero(~joint):
        if rest[newest]:
            square, known = 2.0 * caps.acceleration[newest] * caps.length[newest], 0
        else:
            square, known = caps.acceleration[newest] * caps.length[newest], 0
        for j in range(newest - 1, -1, -1):
            if known > depth:
                break
            square = min(square, caps.junction[j] ** 2, caps.speed[j] ** 2, caps.speed[j + 1] ** 2)
            final[j] = max(final[j], math.sqrt(square))
            square += 2.0 * caps.acceleration[j] * caps.length[j]
            known += int(counted[j])
    return final


def test_with_jerk_it_comes_to_rest_by_an_s_curve() -> None:
    """v (v / a + a / j) / 2 is the way in which a speed v ends (Biagiotti, Melchiorri 2008, section 3.4)."""
    n, way, push, jerk = 400, 1e-3, 2.0, 40.0
    path = build_tool_path(
        interpret(SourceText("x.ngc", chords(lambda s: (s, 0.0, 0.0), 1.0, n, 60000, "G61").encode()), Settings())
    )
    pieces = blend(path, limits(push, push, push), sampled=False)
    plain, full = Caps.of(pieces), np.ones(n)
    caps = Caps(
        plain.piece, plain.begin, plain.length, plain.speed, plain.acceleration, plain.junction,
        Softness(jerk * full, jerk * full, push * full),
    )  # fmt: skip

    top = time_law(pieces, caps, look_ahead=LookAhead(blocks=40)).sample(np.linspace(0.0, 5.0, 999)).speed.max()

    assert top == pytest.approx(math.sqrt(0.05**2 + 2.0 * push * 40.5 * way) - 0.05, rel=0.03)
    assert time_law(pieces, caps).sample(np.linspace(0.0, 5.0, 999)).speed.max() > 1.5 * top
