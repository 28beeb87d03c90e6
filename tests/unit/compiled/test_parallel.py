"""Kernels compiled in several processes, and what is said meanwhile."""

from __future__ import annotations

from pathlib import Path

import pytest

from gcodesim import warm_up
from gcodesim.compiled import known, parallel
from gcodesim.compiled.folder import folders
from gcodesim.compiled.object_code import codes_in

READ = "gcodesim.rs274.plain.reader_kernels:byte_at u1[1]r i8"
READ_OWN = "gcodesim.rs274.plain.reader_kernels:byte_at u1[1] i8"
WRONG = "gcodesim.rs274.plain.reader_kernels:byte_at f8 (i8 f8)"


@pytest.fixture(autouse=True)
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)


def kept() -> list[str]:
    return sorted(code.signature.partition(" ")[2] for folder in folders() for code in codes_in(folder))


def test_kernels_come_into_the_cache_and_failures_are_told(monkeypatch: pytest.MonkeyPatch) -> None:
    said: list[int] = []
    monkeypatch.setattr(parallel, "EVERY", 0.01)
    failed = parallel.compile_all([READ, WRONG, READ_OWN], said.append)
    assert list(failed) == [WRONG]
    assert "TypingError" in failed[WRONG]
    assert kept() == ["u1[1] i8", "u1[1]r i8"]
    assert said and said == sorted(said)


def test_nothing_of_the_working_folder_is_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A stranger's project may hold a `numba.py`."""
    (tmp_path / "numba.py").write_text("raise SystemExit(3)")
    monkeypatch.chdir(tmp_path)
    assert parallel.compile_all([READ], lambda done: None) == {}


def test_a_compiler_that_ends_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(parallel, "_PROGRAM", "import sys; sys.exit(1)")
    assert list(parallel.compile_all([READ, READ_OWN], lambda done: None)) == [READ, READ_OWN]


def test_a_run_compiles_the_whole_part_that_it_needs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(known, "known_parts", lambda: {"first": (READ_OWN,), "reading": (READ, WRONG)})
    said: list[str] = []
    warm_up.warm_up_for(READ, "", said.append)
    assert kept() == ["u1[1]r i8"]
    assert "reading" in said[0]
    assert "byte_at" in said[-1]  # the one that failed


@pytest.mark.parametrize(("signature", "well"), [(READ, True), (WRONG, False)])
def test_warm_up_knows_whether_all_went_well(monkeypatch: pytest.MonkeyPatch, signature: str, well: bool) -> None:
    """And says so without the colours of a compiler, since it may be read in the log of a CI job."""
    monkeypatch.setattr(warm_up, "known_parts", lambda: {"reading": (signature,)})
    monkeypatch.setattr(warm_up.compileall, "compile_dir", lambda *_, **__: True)
    said: list[str] = []
    assert warm_up.warm_up(said.append) is well
    assert "\x1b" not in "".join(said)


def test_where_nothing_can_be_kept_it_is_said_once() -> None:
    said: list[str] = []
    for _ in range(2):
        warm_up.warm_up_for(READ, "the disk is full here", said.append)
    assert len(said) == 1 and "the disk is full here" in said[0]
    assert kept() == []


def test_all_kernels_of_the_list_exist() -> None:
    """`scripts/list_kernels.py` writes it."""
    parts = known.known_parts()
    signatures = [signature for part in parts.values() for signature in part]
    assert len(signatures) == len(set(signatures)) > 40
    for signature in signatures:
        known.kernel_of(signature)


def test_what_tests_call_by_itself_is_in_no_part() -> None:
    """Else each of them would have the 140 kernels of the part compiled into an empty cache."""
    assert not [each for part in known.known_parts().values() for each in part if ":byte_at " in each]


def test_a_list_that_is_out_of_date_ends_no_run(monkeypatch: pytest.MonkeyPatch) -> None:
    """Kernels that are gone, and types that have other fields by now, are not compiled ahead."""
    gone = "gcodesim.rs274.plain.reader_kernels:gone u1[1]"
    other = "gcodesim.material.kernels:volume_of gcodesim.material.field_kernels:Grid(f8)"
    assert known.missing((gone, other)) == []

    monkeypatch.setattr(known, "known_parts", lambda: {"some": (gone, READ)})
    said: list[str] = []
    warm_up.warm_up_for(READ, "", said.append)
    assert len(kept()) == 1
    assert said[0] == "compiling kernels, once for this version: some, 1 on all cores"
