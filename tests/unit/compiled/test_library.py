"""The library of machine code that a wheel carries: used without numba and LLVM, for its own sources only."""

from __future__ import annotations

import ctypes
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from gcodesim.compiled import compiling, folder, library, object_code
from gcodesim.compiled.arguments import argument_of, as_text, of_text
from gcodesim.compiled.known import kernel_of
from gcodesim.compiled.object_code import entry_of, symbol_of
from gcodesim.compiled.target import LEVELS, levels
from gcodesim.extras import ExtraMissingError
from gcodesim.rs274.plain.reader_kernels import byte_at
from scripts.make_libraries import link
from tests.unit.compiled.test_object_code import Line, Place, fresh, put_behind

TEXT = np.frombuffer(b"G1X5", dtype=np.uint8)

# what a process says that finds neither the compiler nor a cache
WITHOUT = (
    "import sys\n"
    "sys.modules['numba'] = sys.modules['llvmlite'] = None\n"
    "from pathlib import Path\n"
    "from gcodesim.compiled import library\n"
    "from gcodesim.extras import ExtraMissingError\n"
    "library.FOLDER = Path(sys.argv[1])\n"
    "import numpy as np\n"
)


def signature_of(kernel: Any, *arguments: Any) -> tuple[Any, Any]:
    return kernel, tuple(map(argument_of, arguments))


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a library of two kernels for the best instructions of this machine."""
    made = tmp_path_factory.mktemp("library")
    objects = []
    for kernel, arguments in (signature_of(byte_at, TEXT, 1), signature_of(put_behind, np.ones(1), 1)):
        symbol = symbol_of(kernel, arguments)
        objects.append(made / f"{symbol}.o")
        objects[-1].write_bytes(compiling.compile_for_library(kernel, arguments, symbol))
    link(objects, made / library.file_name(levels()[0]))
    return made


@pytest.fixture
def used(made: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[Path]:
    """That library in place of the package's own, and an empty cache."""
    monkeypatch.setattr(library, "FOLDER", made)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    library._library.cache_clear()
    yield made
    library._library.cache_clear()


def output(place: Path, code: str, cache: Path) -> str:
    environment = {**os.environ, "XDG_CACHE_HOME": str(cache), "NUMBA_CACHE_DIR": ""}
    command = [sys.executable, "-c", WITHOUT + code, str(place)]
    return subprocess.run(command, env=environment, check=True, capture_output=True, text=True).stdout


def test_it_is_used_where_there_is_no_compiler(made: Path, tmp_path: Path) -> None:
    code = (
        "from gcodesim.rs274.plain.reader_kernels import byte_at\n"
        "from tests.unit.compiled.test_object_code import put_behind\n"
        "values = np.array([1.0, 2.0])\n"
        "longer, same, count = put_behind(values, 2)\n"
        "print(byte_at(np.frombuffer(b'G1X5', dtype=np.uint8), 2), longer.tolist(), same is values, count)"
    )
    # the module of `put_behind` is a test, which loads what compiles
    code = code.replace("from tests", "del sys.modules['numba'], sys.modules['llvmlite']\nfrom tests")
    assert output(made, code, tmp_path) == "88 [1.0, 2.0, 0.0, 0.0] True 2\n"
    assert list(tmp_path.rglob("*.kernel")) == []


def test_what_is_not_in_it_needs_the_compiler(made: Path, tmp_path: Path) -> None:
    """For the types of one call there is code, for those of the other there is none."""
    code = (
        "from gcodesim.rs274.plain.reader_kernels import byte_at\n"
        "print(byte_at(np.frombuffer(b'G1X5', dtype=np.uint8), 2))\n"
        "try:\n"
        "    byte_at(np.zeros(3, dtype=np.uint8), 2)\n"
        "except ExtraMissingError as reason:\n"
        "    print(reason)\n"
    )
    value, reason = output(made, code, tmp_path).splitlines()
    assert value == "88"
    assert "byte_at" in reason and "pip install 'gcodesim[compile]'" in reason


def test_a_library_of_other_sources_is_not_used(used: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    symbol = symbol_of(*signature_of(byte_at, TEXT, 1))
    assert library.has(symbol)
    monkeypatch.setattr(object_code, "hash_of_sources", lambda function: "0123456789abcdef")
    other = symbol_of(*signature_of(byte_at, TEXT, 1))
    assert other != symbol
    assert not library.has(other)
    assert library.entry_of(other) is None


def test_a_damaged_library_is_not_used(used: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / library.file_name(levels()[0])).write_bytes(b"\x7fELF and no more")
    monkeypatch.setattr(library, "FOLDER", tmp_path)
    library._library.cache_clear()
    assert not library.has(symbol_of(*signature_of(byte_at, TEXT, 1)))


def test_an_entry_of_a_library_answers_as_compiled_code_does(used: Path) -> None:
    values = np.array([1.0, 2.0])
    entry = entry_of(*signature_of(fresh(put_behind), values, 1))
    assert entry is not None
    assert entry(values, 1.5) is NotImplemented
    with pytest.raises(RuntimeError, match="put_behind"):
        entry(values, -5)
    before = sys.getrefcount(values)
    for _ in range(10):
        assert entry(values, 1)[1] is values
    assert sys.getrefcount(values) == before


def test_libraries_want_nothing_but_c_and_python(made: Path) -> None:
    (path,) = made.glob("*.so")
    said = subprocess.run(["objdump", "-T", path], check=True, capture_output=True, text=True).stdout
    wanted = [line.split()[-1] for line in said.splitlines() if "*UND*" in line]
    assert wanted and all(hasattr(ctypes.pythonapi, name) or hasattr(ctypes.CDLL(None), name) for name in wanted)


def test_instructions_that_this_processor_has() -> None:
    """A library is looked for from the quickest set of instructions down to one that every processor has."""
    assert levels()[-1] in ("x86-64", "x86-64-v2", "generic")
    assert [level for level in LEVELS if level in levels()] == [level for level in levels() if level in LEVELS]


def test_kernels_are_found_by_their_signatures() -> None:
    kernel, arguments = signature_of(byte_at, TEXT, 1)
    assert kernel_of("gcodesim.rs274.plain.reader_kernels:byte_at u1[1]r i8") == (kernel, arguments)
    for none in ("rs274.plain.reader_kernels:Column i8", "rs274.plain.reader_kernels:nothing i8", "nowhere:f i8"):
        with pytest.raises(ValueError, match="there is no kernel"):
            kernel_of(f"gcodesim.{none}")


@pytest.mark.parametrize(
    "value", [1, 2.5, True, np.ones((2, 3)), TEXT, (1, (2.5, TEXT)), Line(Place(1.0, 2.0), np.ones(1))]
)
def test_types_are_read_back_from_their_text(value: Any) -> None:
    known = argument_of(value)
    assert of_text(as_text((known, known))) == (known, known)  # type: ignore[arg-type]


def test_other_text_is_no_type() -> None:
    other_fields = "gcodesim.material.place_kernels:Places(f8[1])"
    for wrong in ("q8", "(f8", "f8)", "f8[x]", "gcodesim.compiled:Nothing(f8)", other_fields):
        with pytest.raises(ValueError):
            of_text(wrong)


def test_without_numba_the_reason_names_the_kernel(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    known = (compiling._numba, compiling._compilers, compiling._knows_this_numba, folder._name)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setitem(sys.modules, "numba", None)
    for function in known:
        function.cache_clear()
    try:
        with pytest.raises(ExtraMissingError, match=r"text_kernels\.byte_at.*pip install 'gcodesim\[compile\]'"):
            fresh(byte_at)(np.zeros(3, dtype=np.uint8), 1)
    finally:
        for function in known:
            function.cache_clear()
