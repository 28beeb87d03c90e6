"""Methods of dataclasses come compiled, and are those that Python would have made."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from gcodesim.cli import generated

LOOK = """
import sys
import gcodesim.cli.generated as generated
from gcodesim.cli.main import main
from gcodesim.diagnostics import Span
before = len(generated._met)
status = main(["explain", "GS203"])
one = Span("a.nc", 1, 2, 3, 4)
same = Span("a.nc", 1, 2, 3, 4)
print(before, status, one, one == same, hash(one) == hash(same), file=sys.stderr)
try:
    one.line = 3
except Exception as error:
    print(type(error).__name__, error, file=sys.stderr)
"""


def look(cache: Path) -> tuple[int, str]:
    """How many sources a process had to compile, and what it says of a frozen class."""
    environment = os.environ | dict.fromkeys(("NUMBA_CACHE_DIR", "XDG_CACHE_HOME", "TMPDIR"), str(cache))
    done = subprocess.run([sys.executable, "-c", LOOK], env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    count, _, rest = done.stderr.partition(" ")
    return int(count), rest


def kept(cache: Path) -> Path:
    (path,) = (cache / "generated").iterdir()
    return path


def test_sources_are_compiled_once(tmp_path: Path) -> None:
    count, said = look(tmp_path)
    assert count > 20
    assert "Span(file='a.nc', line=1" in said
    assert said.endswith("FrozenInstanceError cannot assign to field 'line'\n")
    assert look(tmp_path) == (0, said)


@pytest.mark.parametrize("damage", [lambda data: data[:-1000], lambda data: b"", lambda data: b"\0" * len(data)])
def test_a_damaged_file_costs_time_only(tmp_path: Path, damage) -> None:
    count, said = look(tmp_path)
    path = kept(tmp_path)
    path.write_bytes(damage(path.read_bytes()))
    assert look(tmp_path) == (count, said)
    assert look(tmp_path) == (0, said)


def test_nothing_is_kept_where_nothing_can_be_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(generated, "_met", [b"key"])
    monkeypatch.setattr(generated, "_code_of", {b"key": b"code"})
    monkeypatch.setattr(generated, "user_cache", lambda name: None)
    generated.keep()
    monkeypatch.setattr(generated, "user_cache", lambda name: tmp_path / "gone")
    generated.keep()
    assert not list(tmp_path.iterdir())


def test_a_file_that_has_grown_too_long_is_begun_anew(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    old = {str(number).encode(): b"old" for number in range(generated._MOST)}
    monkeypatch.setattr(generated, "_met", [b"key"])
    monkeypatch.setattr(generated, "_code_of", old | {b"key": b"code"})
    monkeypatch.setattr(generated, "user_cache", lambda name: tmp_path)
    monkeypatch.setattr(generated, "kept_folders", lambda name: [tmp_path])
    generated.keep()
    assert generated._read() == {b"key": b"code"}


def test_classes_of_others_are_left_alone() -> None:
    code = (
        "import dataclasses, gcodesim.cli.generated as generated\n"
        "def make(field, module):\n"
        "    before = len(generated._met)\n"
        "    names = {'__annotations__': {field: int}, '__module__': module}\n"
        "    one = dataclasses.dataclass(type('Own', (), names))(3)\n"
        "    print(one, len(generated._met) - before)\n"
        "make('of_no_other_class', 'json')\n"
        "make('of_no_other_class', 'gcodesim.units')\n"
        "generated._met.clear()\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", f"import json, gcodesim.units\n{code}"], capture_output=True, text=True, check=True
    )
    assert done.stdout == "Own(of_no_other_class=3) 0\nOwn(of_no_other_class=3) 3\n"
