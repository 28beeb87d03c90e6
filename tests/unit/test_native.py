"""Kernels as machine code of their own: same results as by numba, and numba when they cannot be had."""

import os
import subprocess
import sys
from types import ModuleType

import numpy as np
import pytest

from gcodesim.compiled import Kernel
from gcodesim.native import ArrayType, NativeKernel
from gcodesim.rs274.plain.lane import RUN_LINES

SCAN = "gcodesim.rs274.plain.scan_kernels"
BYTES = [ArrayType("u1", readonly=True)]


@pytest.fixture
def cache(tmp_path, monkeypatch):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    return tmp_path


def test_a_kernel_is_compiled_once_and_loaded_then(cache):
    text = np.frombuffer(b"G1X5", dtype=np.uint8)
    first = NativeKernel(SCAN, "byte_at", BYTES, integers=1)
    assert not first.is_ready()
    assert [first.bind(text)(at) for at in range(4)] == [71, 49, 88, 53]

    again = NativeKernel(SCAN, "byte_at", BYTES, integers=1)

    assert again.is_ready()
    assert again.bind(text)(2) == ord("X")
    assert [path.suffix for path in cache.rglob("byte_at-*")] == [".native"]


def test_a_damaged_file_does_no_harm_beyond_time(cache):
    NativeKernel(SCAN, "byte_at", BYTES, integers=1).bind(np.zeros(1, dtype=np.uint8))
    (path,) = cache.rglob("byte_at-*")
    path.write_bytes(path.read_bytes()[:-100])

    text = np.frombuffer(b"G1", dtype=np.uint8)
    assert NativeKernel(SCAN, "byte_at", BYTES, integers=1).bind(text)(1) == ord("1")


def test_code_that_needs_more_than_c_goes_by_way_of_numba(cache):
    """A kernel that allocates: its object code would call into numba's runtime."""

    def total(values, count):
        room = np.zeros(count)
        for i in range(count):
            room[i] = values[i]
        return int(room.sum())

    module = ModuleType("tests_allocating_kernels")
    module.total = Kernel(total, short=False)
    sys.modules["tests_allocating_kernels"] = module
    try:
        native = NativeKernel("tests_allocating_kernels", "total", [ArrayType("f8")], integers=1)
        assert native.bind(np.array([1.0, 2.0, 4.0]))(3) == 7
        assert not native.is_ready()
    finally:
        del sys.modules["tests_allocating_kernels"]


def test_without_the_compiler_kernels_run_as_python():
    code = (
        "import numpy as np\n"
        "from gcodesim.native import ArrayType, NativeKernel\n"
        f"k = NativeKernel('{SCAN}', 'byte_at', [ArrayType('u1', readonly=True)], integers=1)\n"
        "print(k.is_ready(), k.bind(np.frombuffer(b'G1', dtype=np.uint8))(1))\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], env={**os.environ, "NUMBA_DISABLE_JIT": "1"}, capture_output=True, text=True
    )

    assert done.stdout.split() == ["False", "49"], done.stderr


def test_reading_a_long_program_does_not_load_numba(tmp_path):
    """What the machine code is for: with it in the cache numba stays out of the process."""
    RUN_LINES.prepare()  # compiles it, should it not be there
    program = tmp_path / "long.nc"
    program.write_text("F100\n" + "G1 X1 Y2 Z3\nG1 X2 Y3 Z4\n" * 20_000 + "M2\n")
    code = (
        "import sys\nfrom gcodesim.cli.main import main\n"
        f"status = main(['lint', {str(program)!r}])\n"
        "print(status, [m for m in ('numba', 'scipy', 'lark', 'gcodesim.cell.cell') if m in sys.modules])\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)

    assert done.stdout.splitlines()[-1] == "0 []", done.stdout + done.stderr
