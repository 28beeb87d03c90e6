"""Kernels: compiled when needed, interpreted when short, with the same bits; also where nothing can be cached."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from copy import deepcopy
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gcodesim
from gcodesim import compiled
from gcodesim.canon import ArcFeed, Event, LinearFeed, PathMode, Rapid
from gcodesim.checks.rigid import RigidBody, Woods
from gcodesim.compiled import Kernel, kernel
from gcodesim.diagnostics import SourceText, Span
from gcodesim.frames import Pose
from gcodesim.motion import build_tool_path
from gcodesim.motion.blend import blend
from gcodesim.motion.look_ahead import LookAhead
from gcodesim.motion.pieces import AxisLimits
from gcodesim.motion.printer_law import as_printed, without_blending
from gcodesim.motion.timing import time_law
from gcodesim.rs274 import Settings, interpret
from gcodesim.solids import Placed, Sphere

HERE = Span("t", 1, 1, 1, 2)
LIMITS = AxisLimits(
    speed=np.array([0.5, 0.5, 0.25, 3.0, 3.0, 3.0]), acceleration=np.array([3.0, 3.0, 2.0, 10.0, 10.0, 10.0])
)


@kernel
def double(x: float) -> float:
    return 2.0 * x


@kernel(short=True)
def doubled(values: np.ndarray[Any, Any], out: np.ndarray[Any, Any]) -> None:
    for i in range(len(values)):
        out[i] = double(values[i]) / 0.0


def short_kernels() -> dict[str, Kernel]:
    """All kernels that may be interpreted, by name; those of arithmetic have tests of their own."""
    root = Path(gcodesim.__file__).parent
    modules = [
        import_module(".".join(("gcodesim", *path.relative_to(root).with_suffix("").parts)))
        for path in sorted(root.rglob("*kernels.py"))
        if path.parent.name != "arithmetic"
    ]
    return {
        name: value
        for module in modules
        for name, value in vars(module).items()
        if isinstance(value, Kernel) and value.short
    }


def random_events(random: np.random.Generator, count: int) -> Iterator[Event]:
    """Lines, arcs and rotary moves in all path modes, with reversals, tangents and short chords among them."""
    at = np.zeros(6)
    for _ in range(count):
        choice = random.integers(0, 12)
        if choice == 0:
            yield PathMode(span=HERE, mode="blend", tolerance=random.choice([0.0, 1e-5, 1e-3]), naive=1e-5)
        elif choice == 1:
            yield PathMode(span=HERE, mode=random.choice(["exact_path", "exact_stop"]), tolerance=0.0, naive=0.0)
        elif choice < 5:
            radius, begin, sweep = random.uniform(1e-3, 0.05), random.uniform(0, 6.3), random.uniform(-6.0, 6.0)
            center = at[:2] - radius * np.array([np.cos(begin), np.sin(begin)])
            at = at.copy()
            at[:2] = center + radius * np.array([np.cos(begin + sweep), np.sin(begin + sweep)])
            at[2] += random.choice([0.0, 0.002])
            yield ArcFeed(
                span=HERE,
                end=tuple(at),
                center=(*center, at[2]),
                normal=(0.0, 0.0, 1.0),
                sweep=sweep,
                ccw=sweep > 0.0,
                turns=1,
                feed=random.choice([0.02, 0.3]),
            )
        else:
            size = random.choice([1e-5, 1e-3, 0.1])
            at = at + size * np.round(random.uniform(-1.0, 1.0, 6), 2) * np.array([1, 1, 1, choice == 11, 0, 0])
            feed = random.choice([0.02, 0.3])
            yield Rapid(span=HERE, end=tuple(at)) if choice == 10 else LinearFeed(span=HERE, end=tuple(at), feed=feed)


def test_short_calls_have_the_bits_of_the_compiled_kernel(monkeypatch: pytest.MonkeyPatch) -> None:
    compiled_ones = {kernel: Kernel(kernel.py_func, lean=kernel.lean) for kernel in short_kernels().values()}
    seen, call = set(), Kernel.__call__

    def both(self: Kernel, *arguments: Any) -> Any:
        if self not in compiled_ones:
            return call(self, *arguments)
        twins = deepcopy(arguments)
        result, twin = call(compiled_ones[self], *arguments), self.interpreted(*twins)
        np.testing.assert_equal((twin, twins), (result, arguments), self.py_func.__name__)
        seen.add(self.py_func.__name__)
        return result

    monkeypatch.setattr(Kernel, "__call__", both)
    random = np.random.default_rng(11)
    for own_ways in (False, True) * 10:
        path = build_tool_path(list(random_events(random, 60)), (0.0,) * 6)
        pieces = blend(path, LIMITS, independent_rapids=own_ways)
        assert time_law(pieces).duration > 0.0
        assert time_law(pieces, look_ahead=LookAhead(blocks=3, corners_count=own_ways)).duration > 0.0
    source = SourceText.read(Path(__file__).parents[2] / "data" / "programs" / "posts" / "marlin_slicer.nc")
    printed = build_tool_path(list(interpret(source, Settings(dialect="marlin"))), (0.0,) * 6)
    assert time_law(as_printed(blend(without_blending(printed), LIMITS))).duration > 0.0
    for solids in (1, 9, 40):
        places = [Pose.from_xyz_rpy(xyz.tolist()) for xyz in random.uniform(-1.0, 1.0, (solids, 3))]
        body = RigidBody(name="body", carrier=-1, solids=tuple(Placed(Sphere(radius=0.1), at) for at in places))
        assert Woods.of([body]).deepest >= 1
    assert seen == set(short_kernels())


def test_few_rows_are_interpreted_and_many_are_compiled(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Kernel, "rows_interpreted", 0)
    ways = []

    def watched(way: str, function: Callable[..., Any]) -> Callable[..., Any]:
        return lambda *arguments: (ways.append(way), function(*arguments))[1]

    one = Kernel(doubled.py_func, short=True)  # type: ignore[attr-defined]
    machine_code = one._entry_for((np.ones(1), np.zeros(1)))
    one.__dict__ |= {"_entry": watched("compiled", machine_code), "interpreted": watched("plain", one.interpreted)}
    for count in (1, compiled.SHORT, compiled.SHORT + 1):
        out = np.zeros(count)
        one(np.ones(count), out)
        assert np.isposinf(out).all()
    assert ways == ["plain", "plain", "compiled"]


def test_many_short_calls_are_compiled_in_the_end(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whichever kernels they are of."""
    monkeypatch.setattr(Kernel, "rows_interpreted", 0)
    one, other = (Kernel(doubled.py_func, short=True) for _ in range(2))  # type: ignore[attr-defined]
    ways = []
    for each in (one, other):
        each.__dict__ |= {"_entry": lambda x, out: ways.append("compiled"), "interpreted": lambda x, out: None}
    calls = compiled.ENOUGH // 8
    for _ in range(calls):
        one(np.ones(8), np.zeros(8))
    assert not ways
    other(np.ones(8), np.zeros(8))
    assert ways == ["compiled"]


def test_rows_of_a_tuple_are_those_of_its_columns(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Kernel, "rows_interpreted", 0)
    one = Kernel(doubled.py_func, short=True)  # type: ignore[attr-defined]
    one.__dict__ |= {"_entry": lambda columns: "compiled", "interpreted": lambda columns: "plain"}
    assert one((np.ones(compiled.SHORT), np.ones(1))) == "plain"
    assert one((np.ones(compiled.SHORT + 1), np.ones(1))) == "compiled"


def run_python(code: str, **environment: str) -> str:
    done = subprocess.run(
        [sys.executable, "-c", code], env={**os.environ, **environment}, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_declaring_and_interpreting_do_not_load_numba() -> None:
    code = (
        "import sys, numpy as np\n"
        "from gcodesim.motion.timing_kernels import end_speeds\n"
        "print(end_speeds(*np.ones((5, 3)), np.zeros(3, dtype=bool))[1], 'numba' in sys.modules)"
    )
    assert run_python(code).endswith("0.] False\n")


def test_each_compilation_is_announced_and_works_without_a_cache(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("no folder fits below a file")
    nowhere = str(tmp_path / "file")
    code = (
        "from gcodesim import compiled\n"
        "compiled.when_cold = lambda signature, why: print(signature.split()[0][-9:], why.count('cannot be used'))\n"
        "from gcodesim.motion.corner_kernels import corner_center, way_from_corner\n"
        "print(corner_center(1.0, 0.0, 1.0, 0.0, 1.0, 2.0)[1], way_from_corner(3.0, 0.0, 0.0, 0.0, 1.0))"
    )
    environment = {"XDG_CACHE_HOME": nowhere, "NUMBA_CACHE_DIR": nowhere}
    assert run_python(code, **environment) == "er_center 2\nom_corner 2\n2.0 3.0\n"
