"""Machine code of kernels: kept, and loaded without numba, with the results that numba has."""

from __future__ import annotations

import math
import os
import subprocess
import sys
import time
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest

from gcodesim.compiled import Kernel, compiling, folder, kernel, object_code
from gcodesim.compiled.arguments import ITEMS, argument_of
from gcodesim.compiled.function import objects_are_as_known
from gcodesim.files import user_cache
from gcodesim.rs274.plain.reader_kernels import byte_at

BYTE_AT = "from gcodesim.rs274.plain.reader_kernels import byte_at; import numpy as np, sys\n"
BYTE_AT += "print(byte_at(np.frombuffer(b'G1X5', dtype=np.uint8), 2), 'numba' in sys.modules)"

STOCK = "stock: {box: [20, 15, 8], zero: top-front-left, material: al6082_t6, resolution: 1"
GANTRY = f"machine: gantry_xyz\n{STOCK}}}"
ARM = (
    "robots: {arm: {model: kuka_kr10_r1100_2}}\nwork_offsets: {G54: {in: world, xyz: [600, 0, 300]}}\n"
    f"{STOCK}, in: world, xyz: [600, 0, 300]}}"
)

LINEAR = "{travel: [-300, 300 mm], speed: 20 m/min}"
TRUNNION = (
    f"machine:\n  axes:\n    X: {LINEAR}\n    Y: {LINEAR}\n    Z: {LINEAR}\n"
    "    A: {travel: [-90, 90 deg], speed: 90 deg/s, at: [0, 0, -100]}\n"
    "    C: {travel: unlimited, speed: 90 deg/s, at: [0, 0, -100]}\n"
    f"work_offsets: {{G54: {{xyz: [0, 0, -80]}}}}\n{STOCK}, in: G54}}"
)


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "user"))
    return tmp_path


def text(data: bytes) -> Any:
    return np.frombuffer(data, dtype=np.uint8)


def fresh(known: Any) -> Kernel:
    """The kernel as a process has it that has not called it yet."""
    return Kernel(known.py_func, lean=known.lean)


def process(code: str, **environment: str) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-c", code], env={**os.environ, **environment}, stdout=subprocess.PIPE, text=True
    )


def output(code: str, **environment: str) -> str:
    started = process(code, **environment)
    out, _ = started.communicate()
    assert started.returncode == 0
    return out


def kept(cache: Path) -> list[Path]:
    return sorted(path for path in cache.rglob("*") if path.is_file())


@kernel
def twice(value: Any) -> Any:
    return value + value


@kernel
def quadruple(value: Any) -> Any:
    return twice(twice(value))


@kernel
def summed(values: Any, room: Any) -> Any:
    for i in range(len(values)):
        room[0] += values[i]
    return len(values), values[0], values[0] > 0


@kernel
def put_behind(values: Any, count: int) -> Any:
    longer = np.zeros(len(values) + count)
    longer[: len(values)] = values
    return longer, values, count


@kernel
def first_of(columns: Any, scale: float) -> float:
    return float(scale * columns[0][0] + columns[1][1][0])


class Place(NamedTuple):
    x: float
    y: float


class Other(NamedTuple):
    x: float
    y: float


class Line(NamedTuple):
    start: Place | Other
    lengths: Any


@kernel
def along(line: Line, way: float) -> Line:
    line.lengths[0] += way
    return Line(Place(line.start.x + way, line.start.y), line.lengths)


@kernel
def sum_of(place: Any) -> float:
    return float(place.x + place.y)


@kernel
def nothing(values: Any) -> None:
    values[0] = 7.0


def test_a_kernel_is_compiled_once_and_then_loaded(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    takes = tuple(map(argument_of, (text(b"G1"), 1)))
    one = fresh(byte_at)
    assert not object_code.is_kept(one, takes)  # type: ignore[arg-type]
    assert [one(text(b"G1X5"), at) for at in range(4)] == [71, 49, 88, 53]
    assert object_code.is_kept(one, takes)  # type: ignore[arg-type]

    monkeypatch.setattr(compiling, "compile_entry", None)
    assert fresh(byte_at)(text(b"G1X5"), 2) == ord("X")
    assert [path.suffix for path in kept(cache)] == [".kernel"]


def test_what_is_kept_needs_no_numba(cache: Path) -> None:
    where = {"NUMBA_CACHE_DIR": str(cache)}
    assert output(BYTE_AT, **where) == "88 True\n"
    assert output(BYTE_AT, **where) == "88 False\n"


def test_several_processes_at_once(cache: Path) -> None:
    started = [process(BYTE_AT, NUMBA_CACHE_DIR=str(cache)) for _ in range(3)]
    assert [one.communicate()[0].split()[0] for one in started] == ["88"] * 3
    assert [path.suffix for path in kept(cache)] == [".kernel"]


def test_code_in_a_folder_that_is_not_the_first(cache: Path) -> None:
    output(BYTE_AT, NUMBA_CACHE_DIR=str(cache / "none"), XDG_CACHE_HOME=str(cache))
    (made,) = kept(cache)
    there = cache / "gcodesim"
    there.mkdir(mode=0o700)
    made.parent.rename(there / made.parent.name)
    assert output(BYTE_AT, NUMBA_CACHE_DIR=str(cache / "other"), XDG_CACHE_HOME=str(cache)) == "88 False\n"


@pytest.mark.skipif(not hasattr(os, "getuid") or os.getuid() != 0, reason="only root can give files away")
def test_code_of_somebody_else_is_not_run(cache: Path) -> None:
    fresh(byte_at)(text(b"G1"), 1)
    (path,) = kept(cache)
    assert [place.path for place in folder.folders()] == [path.parent]
    os.chown(path, 12345, 12345)
    assert not object_code.is_kept(byte_at, tuple(map(argument_of, (text(b"G1"), 1))))  # type: ignore[arg-type]
    os.chown(path, 0, 0)
    os.chown(path.parent, 12345, 12345)
    assert list(folder.folders()) == []


def test_code_that_others_may_have_written_is_not_run(cache: Path) -> None:
    fresh(byte_at)(text(b"G1"), 1)
    (path,) = kept(cache)
    takes = tuple(map(argument_of, (text(b"G1"), 1)))
    for place in (path, path.parent, cache):
        user_cache._OPEN.clear()
        place.chmod(0o777)
        assert not object_code.is_kept(byte_at, takes)  # type: ignore[arg-type]
        place.chmod(0o700)
    assert object_code.is_kept(byte_at, takes)  # type: ignore[arg-type]
    path.rename(cache / "planted")
    path.symlink_to(cache / "planted")
    assert not object_code.is_kept(byte_at, takes)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "damage",
    [
        lambda data: data[:-100],
        lambda data: b"",
        lambda data: data[:200],
        lambda data: data[:-1] + bytes([data[-1] ^ 1]),
    ],
)
def test_a_damaged_file_is_made_anew(cache: Path, damage: Any) -> None:
    fresh(byte_at)(text(b"G1"), 1)
    (path,) = kept(cache)
    whole = path.read_bytes()
    path.write_bytes(damage(whole))
    (place,) = folder.folders()
    assert object_code._read(place, path.name) is None
    path.with_suffix(".part").write_bytes(whole[:50])  # of a process that was killed

    assert fresh(byte_at)(text(b"G1"), 1) == ord("1")
    assert object_code._read(place, path.name) is not None


def test_code_that_wants_what_is_not_there_is_not_loaded() -> None:
    code = object_code.ObjectCode("f", "m:f", ("PyErr_SetString", "gcodesim_of_another_version"), b"")
    assert object_code.load(code) is None


@pytest.mark.parametrize("item", ITEMS)
def test_numbers_and_arrays_of_each_kind(item: str) -> None:
    values = np.array([1, 0, 1], dtype=item) if item == "b1" else np.array([3, 5, 100], dtype=item)
    kind = {"b": "i8", "i": "i8", "u": "u8", "f": "f8"}[item[0]]
    room, twin = np.zeros((2, 1), dtype=kind)
    assert summed(values, room) == summed.py_func(values, twin)  # type: ignore[attr-defined]
    assert room == twin
    assert quadruple(values[0]) == 4 * int(values[0])
    assert type(quadruple(values[0])) is (float if item[0] == "f" else int)


def test_numbers_of_python() -> None:
    assert [quadruple(value) for value in (3, -(1 << 60), 0.25, True, np.float64(1e300))] == [
        *(12, -(1 << 62), 1.0, 4, 4e300),
    ]
    assert twice(float("inf")) == float("inf")
    with pytest.raises(OverflowError):
        fresh(twice)._entry_for((1,))(1 << 70)


def test_what_other_types_get() -> None:
    """One kernel, called with several types in turn; each answers its own."""
    ask = fresh(nothing)
    entry = ask._entry_for((np.zeros(2),))
    for other in (
        np.zeros(2, dtype="f4"),
        np.zeros((2, 1)),
        np.zeros(4)[::2],
        np.zeros(2, dtype=">f8"),
        1.0,
        None,
        [0.0],
    ):
        assert entry(other) is NotImplemented
    read_only = np.zeros(2)
    read_only.flags.writeable = False
    assert entry(read_only) is NotImplemented
    assert entry(np.zeros(2).view(np.recarray)) is NotImplemented
    assert entry() is NotImplemented
    assert entry(np.zeros(2), 1) is NotImplemented
    values = np.zeros(2)
    assert entry(values) is None
    assert values.tolist() == [7.0, 0.0]


@pytest.mark.parametrize(
    "values", [np.arange(8.0)[::2], np.asfortranarray(np.ones((2, 2)))[:, 1], np.arange(3.0).view(np.recarray)]
)
def test_arrays_that_no_entry_takes_go_by_numba(values: Any) -> None:
    room = np.zeros(1)
    assert summed(values, room)[0] == len(values)
    assert room == values.sum()


def test_arrays_with_another_name_of_the_same_number() -> None:
    values = np.array([2, 3], dtype=np.longlong)
    room = np.zeros(1, dtype=np.longlong)
    assert summed(values, room) == (2, 2, True)
    assert room[0] == 5


def test_arrays_that_a_kernel_makes_or_hands_back() -> None:
    put_behind(np.ones(1), 1)
    values = np.array([1.0, 2.0])
    before = sys.getrefcount(values)
    for _ in range(10):
        longer, same, count = put_behind(values, 2)
        assert same is values
        assert (longer.tolist(), count) == ([1.0, 2.0, 0.0, 0.0], 2)
        longer[3] = 1.0
    del same
    assert sys.getrefcount(values) == before


def test_tuples_of_arrays() -> None:
    columns = (np.array([2.0]), (1, np.array([5.0])))
    assert first_of(columns, 10.0) == 25.0
    entry = fresh(first_of)._entry_for((columns, 10.0))
    assert entry(columns[:1], 10.0) is NotImplemented
    assert entry((columns[0], (1, 2)), 10.0) is NotImplemented


def test_named_tuples_go_in_and_come_out() -> None:
    line = Line(Place(1.0, 2.0), np.array([5.0]))
    moved = along(line, 3.0)
    assert type(moved) is Line and type(moved.start) is Place
    assert moved.start == Place(4.0, 2.0) and moved.lengths is line.lengths and moved.lengths.tolist() == [8.0]
    entry = fresh(along)._entry_for((line, 3.0))
    assert entry(tuple(line), 3.0) is NotImplemented
    assert entry(Line(tuple(line.start), line.lengths), 3.0) is NotImplemented  # type: ignore[arg-type]
    assert entry(line._replace(start=Other(1.0, 2.0)), 3.0) is NotImplemented
    for _ in range(10):
        moved = along(line, 0.0)
    before = sys.getrefcount(Line)
    for _ in range(10):
        moved = along(line, 0.0)
    assert sys.getrefcount(Line) == before


def test_named_tuples_need_no_numba(cache: Path) -> None:
    code = "from tests.unit.compiled.test_object_code import Line, Place, along; import numpy as np, sys\n"
    code += "print(along(Line(Place(1.0, 2.0), np.array([5.0])), 3.0).start.x, 'numba' in sys.modules)"
    assert output(code) == "4.0 True\n"
    assert output(code) == "4.0 False\n"


def test_named_tuples_that_nobody_can_find_go_by_numba() -> None:
    class Hidden(NamedTuple):
        x: float
        y: float

    assert argument_of(Hidden(1.0, 2.0)) is None
    assert sum_of(Hidden(1.0, 2.0)) == 3.0


def test_a_kernel_that_fails() -> None:
    @kernel
    def assign(values: Any, count: int) -> None:
        values[:2] = np.ones(count)

    assign(np.zeros(3), 2)
    with pytest.raises(RuntimeError, match="assign"):
        assign(np.zeros(3), 3)


def test_code_of_sources_that_were_edited_meanwhile_is_not_kept(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its name would be that of the new sources, and the next process would run the old ones by it."""
    edited = fresh(byte_at)
    monkeypatch.setattr(edited, "declared_ns", 0)

    assert edited(text(b"G1X5"), 2) == ord("X")
    assert kept(cache) == []


def test_another_numba_than_those_we_know(monkeypatch: pytest.MonkeyPatch, cache: Path) -> None:
    """Everything goes by way of numba then, which keeps nothing: it would be read back as a pickle."""
    monkeypatch.setattr(compiling, "_knows_this_numba", lambda: False)
    compiling.dispatcher_of.cache_clear()
    compiling._numba.cache_clear()  # it tells numba where to keep what it makes

    assert fresh(quadruple)(2.5) == 10.0
    assert kept(cache) == []


def test_we_know_the_numba_that_is_here() -> None:
    assert compiling._knows_this_numba()
    assert objects_are_as_known()


def test_without_the_compiler_kernels_run_as_python() -> None:
    code = (
        "import numpy as np\n"
        "from gcodesim.rs274.plain.reader_kernels import byte_at\n"
        "from gcodesim.rs274.plain.lane import is_ready\n"
        "print(is_ready(), byte_at(np.frombuffer(b'G1', dtype=np.uint8), 1))\n"
    )
    assert output(code, NUMBA_DISABLE_JIT="1").split() == ["False", "49"]


def test_reading_a_long_program_does_not_load_numba(tmp_path: Path) -> None:
    program = tmp_path / "long.nc"
    program.write_text("F100\n" + "G1 X1 Y2 Z3\nG1 X2 Y3 Z4\n" * 20_000 + "M2\n")
    code = (
        "import sys\nfrom gcodesim.cli.main import main\n"
        f"status = main(['lint', {str(program)!r}])\n"
        "print(status, [m for m in ('numba', 'scipy', 'lark', 'gcodesim.cell.cell') if m in sys.modules])\n"
    )
    compiled_lane = (
        "from gcodesim.diagnostics import SourceText\nfrom gcodesim.rs274 import Settings, interpret\n"
        "print(len(list(interpret(SourceText('a.nc', b'F1\\nG1 X1\\nX2\\nM2'), Settings(lane='compiled')))))"
    )
    output(compiled_lane)  # compiles it, should it not be there
    assert output(code).splitlines()[-1] == "0 []"


def test_the_folder_is_another_for_other_versions_and_instructions(monkeypatch: pytest.MonkeyPatch) -> None:
    name = folder._name.__wrapped__
    seen = [name()]
    monkeypatch.setattr(folder, "level", lambda: "another")
    seen.append(name())
    for compiler in folder._COMPILERS:
        monkeypatch.setattr(folder, "_version", lambda name, new=compiler: b"9" if name == new else b"1")
        seen.append(name())
    assert len(set(seen)) == len(seen)


def test_of_too_much_code_the_oldest_half_is_deleted(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    fresh(byte_at)(text(b"G1"), 1)
    (made,) = kept(cache)
    for age in range(5):
        other = made.with_name(f"f_{age}.kernel")
        other.write_bytes(b"code")
        os.utime(other, (1, made.stat().st_mtime - 10 - age))
    monkeypatch.setattr(folder, "_MOST", 6)
    folder.delete_old()
    assert len(list(made.parent.glob("*.kernel"))) == 6
    monkeypatch.setattr(folder, "_MOST", 4)
    folder.delete_old()
    assert sorted(path.name for path in made.parent.glob("*.kernel")) == sorted([made.name, "f_0.kernel"])


def test_folders_that_nobody_used_for_a_month_are_deleted(cache: Path) -> None:
    """Those of other versions, and only if they hold what we wrote."""
    fresh(byte_at)(text(b"G1"), 1)
    (made,) = kept(cache)
    month = 31 * 24 * 3600
    old, recent, strange, foreign = (cache / name for name in ("0" * 16, "1" * 16, "2" * 16, "notes"))
    for place in (old, recent, strange, foreign):
        place.mkdir(mode=0o700)
        (place / "f_0123.kernel").write_bytes(b"code")
    (strange / "thesis.txt").write_text("mine")
    (cache / ("3" * 16)).symlink_to(foreign)
    for place in (old, strange, foreign, made.parent):
        os.utime(place, (1, place.stat().st_mtime - month))

    folder.delete_old()
    assert not old.exists()
    assert (recent / "f_0123.kernel").exists() and (foreign / "f_0123.kernel").exists()
    assert [path.name for path in strange.iterdir()] == ["thesis.txt"]
    assert made.exists()

    fresh(byte_at)(text(b"G1"), 1)  # marks it as used
    assert made.parent.stat().st_mtime > time.time() - month / 2


@pytest.mark.parametrize(
    ("machine", "world", "turn"),
    [(GANTRY, "bullet", ""), (ARM, "kinematic", ""), (TRUNNION, "kinematic", "M428\nG1 A4 C3\nX12 A5\n")],
)
def test_a_run_does_not_load_numba(tmp_path: Path, machine: str, world: str, turn: str) -> None:
    """All its kernels take and return what an entry can."""
    program = f"G21 G90 G17 G64 P0.01\nT1 M6\nG43 H1\nS8000 M3\nG0 X5 Y5 Z5\nG1 Z-1 F300\n{turn}X15\nG0 Z9\nM2\n"
    (tmp_path / "a.nc").write_text(program)
    (tmp_path / "a.yaml").write_text(
        f"gcodesim: 1\n{machine}\ntools: {{1: {{type: flat_end_mill, diameter: 6, length: 40}}}}\n"
    )
    arguments = ["run", str(tmp_path / "a.nc"), "--cell", str(tmp_path / "a.yaml"), "--world", world]
    code = (
        "import sys\nfrom gcodesim.cli.main import main\n"
        f"status = main([*{arguments!r}, '--out', {str(tmp_path / 'out')!r}])\n"
        "print(status, 'numba' in sys.modules, 'llvmlite' in sys.modules)\n"
    )
    output(code)  # compiles what is not there
    assert output(code).splitlines()[-1] == "0 False True"


@kernel
def taken_apart(value: float) -> tuple[float, int, float]:
    fraction, exponent = math.frexp(value)
    return fraction, exponent, math.ldexp(fraction, exponent - 3)


@pytest.mark.parametrize("value", [0.0, -0.0, 1.0, -6.5, 1e308, 5e-324, math.inf, -math.inf, math.nan])
def test_fractions_and_exponents_are_those_of_python(value: float) -> None:
    """Machine code has functions of its own for them; they need nothing of numba when they are loaded."""
    fraction, exponent = math.frexp(value)
    expected = (fraction, exponent, math.ldexp(fraction, exponent - 3))
    assert str(fresh(taken_apart)(value)) == str(expected)
    code = compiling.compile_entry(taken_apart, tuple(map(argument_of, (value,))), "taken_apart")  # type: ignore[arg-type]
    assert code is not None and not [name for name in code.wanted if name.startswith("numba")]
