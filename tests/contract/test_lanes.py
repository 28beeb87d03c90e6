"""The two lanes of RS274 stand side by side: a compiled file has the name of the file whose work it repeats."""

from __future__ import annotations

from pathlib import Path

import pytest

import gcodesim

RS274 = Path(gcodesim.__file__).parent / "rs274"
SHARED = ("layout_kernels.py", "text_kernels.py")
"""Where things stand in the arrays, and bytes of a line: the other lane has neither."""

KERNELS = sorted(path.name for path in (RS274 / "plain").glob("*_kernels.py") if path.name not in SHARED)


@pytest.mark.parametrize("name", KERNELS)
def test_a_compiled_file_is_named_as_the_file_it_repeats(name: str) -> None:
    repeated = name.removesuffix("_kernels.py")

    assert any((RS274 / f"{repeated}{ending}.py").is_file() for ending in ("", "s"))
