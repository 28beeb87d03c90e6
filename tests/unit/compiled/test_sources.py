"""Which edits make the code of a kernel anew."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from types import CodeType

import pytest

from gcodesim.compiled import sources

FILES = {
    "compiled/arguments.py": "1",
    "compiled/compiling.py": "1",
    "compiled/entry.py": "1",
    "compiled/lowering.py": "1",
    "compiled/memory.py": "1",
    "compiled/passes.py": "1",
    "compiled/shortcuts.py": "1",
    "compiled/target.py": "1",
    "compiled/known.py": "1",
    "a/__init__.py": "",
    "a/upper_kernels.py": (
        "from __future__ import annotations\nimport numpy as np\n"
        "from gcodesim.compiled import kernel\nfrom gcodesim.compiled.known import x\n"
        "from gcodesim.b import (\n    middle_kernels as m,  # a word, and (another)\n    shown,\n)\n"
        "from gcodesim.a.names import Column\n"
    ),
    "a/names.py": "from gcodesim.a.far import y\n",
    "a/far.py": "y = 1\n",
    "a/beside_kernels.py": "def f(x):\n    return x\n",
    "b/__init__.py": "from gcodesim.b.shown_kernels import shown\n",
    "b/middle_kernels.py": "import gcodesim.b.lower_kernels\nimport gcodesim.a.upper_kernels\n",
    "b/lower_kernels.py": "",
    "b/shown_kernels.py": "",
}


@pytest.fixture
def root(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    root = tmp_path / "gcodesim"
    for name, text in FILES.items():
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(text)
    monkeypatch.setattr(sources, "ROOT", root)
    forget()
    yield root
    forget()


def forget() -> None:
    for function in (sources._hash_of_file, sources._read, sources._file, sources._way):
        function.cache_clear()


def hash_of(path: Path) -> str:
    forget()
    return sources.hash_of_sources(function_in(path))


def function_in(path: Path) -> CodeType:
    return compile("0", str(path), "exec")


@pytest.mark.parametrize(
    ("edited", "anew"),
    [
        ("a/upper_kernels.py", True),
        ("b/middle_kernels.py", True),  # it imports it
        ("b/lower_kernels.py", True),  # by way of another
        ("b/shown_kernels.py", True),  # by way of what the package shows
        ("a/names.py", True),  # constants
        ("compiled/entry.py", True),
        ("a/far.py", False),  # no kernels, and nobody takes anything from it
        ("a/beside_kernels.py", False),
        ("compiled/known.py", False),
    ],
)
def test_an_edit_counts_where_it_can_be_felt(root: Path, edited: str, anew: bool) -> None:
    before = hash_of(root / "a/upper_kernels.py")
    with (root / edited).open("a") as file:
        file.write("# edited\n")
    assert (hash_of(root / "a/upper_kernels.py") != before) is anew


def test_a_function_beside_the_package_is_another_when_its_file_changes(tmp_path: Path) -> None:
    path = tmp_path / "own.py"
    path.write_text("def f(x):\n    return x")
    before = hash_of(path)
    path.write_text("def f(x):\n    return 2 * x")
    assert hash_of(path) != before


def test_code_that_was_typed_in() -> None:
    one, same, two = (compile(text, "<typed>", "exec") for text in ("x = 1.5", "x = 1.5", "x = 2.5"))
    assert sources.hash_of_sources(one) == sources.hash_of_sources(same) != sources.hash_of_sources(two)


def test_what_a_kernel_calls_is_among_its_sources() -> None:
    """The search by text finds every kernel that Python itself finds behind the names of a kernel's module."""
    import sys
    from importlib import import_module

    from gcodesim.compiled import Kernel
    from gcodesim.compiled.known import known_parts

    modules = {signature.partition(":")[0] for part in known_parts().values() for signature in part}
    assert len(modules) > 20
    for name in sorted(modules):
        path = Path(import_module(name).__file__ or "")
        behind = sources._behind(path)
        for value in vars(sys.modules[name]).values():
            if isinstance(value, Kernel):
                assert Path(value.py_func.__code__.co_filename) in behind, (name, value.py_func)


def test_sources_written_after_a_kernel_was_loaded_are_known(root: Path) -> None:
    """What was loaded is then no longer what the files say, on which the names of machine code depend."""
    kernels = root / "a" / "upper_kernels.py"
    newest = max(os.stat(file).st_mtime_ns for file in root.rglob("*.py"))
    assert not sources.edited_since(function_in(kernels), newest)

    os.utime(root / "b" / "lower_kernels.py", ns=(newest + 1, newest + 1))
    assert sources.edited_since(function_in(kernels), newest)

    (root / "b" / "lower_kernels.py").unlink()
    assert sources.edited_since(function_in(kernels), newest)
