"""Tables of the grammars are kept as text that can do nothing but be wrong."""

from __future__ import annotations

import pickle
from importlib.resources import files
from pathlib import Path

import pytest

from gcodesim.files import user_cache
from gcodesim.rs274 import grammar
from gcodesim.rs274.dialects import DIALECTS
from gcodesim.rs274.grammar import parser_of

NAMES = sorted(path.name.removesuffix(".lark") for path in files("gcodesim.rs274").joinpath("grammars").iterdir())
PARTS = {dialect.grammar: dialect.grammar_parts for dialect in DIALECTS.values()}
LINES = ("g1x[1+2]", "n10 #<a>=[sin[30]*2] (a note)", "/m3s100", "g1 x", "#1=", "if [#1 eq 2] goto 5", "o1 call [2]")


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    user_cache._OPEN.clear()
    return tmp_path / "grammars"


def answers(name: str) -> list[str]:
    grammar._known_grammar.cache_clear()
    parse = parser_of.__wrapped__(name, PARTS.get(name, ""))
    out = []
    for line in LINES:
        try:
            out.append(repr(parse(line)))
        except grammar.Unreadable as problem:
            out.append(f"{problem.column} {problem.found} {sorted(problem.expected)}")
    return out


@pytest.mark.parametrize("name", NAMES)
def test_kept_tables_read_as_new_ones(cache: Path, name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    new = answers(name)
    assert [path.suffix for path in cache.iterdir()] == [".json"]
    monkeypatch.setattr(grammar, "Lark", type("None", (), {"_load_from_dict": grammar.Lark._load_from_dict}))
    assert answers(name) == new


class Planted:
    def __reduce__(self) -> tuple[object, tuple[object, ...]]:
        return pytest.fail, ("what somebody planted was executed",)


@pytest.mark.parametrize("harm", [b"", b"[]", b"[{}, {}]", b'{"a": 1}', b"\xff", pickle.dumps(Planted())])
def test_other_tables_are_made_anew(cache: Path, harm: bytes) -> None:
    new = answers("rs274")
    (path,) = cache.iterdir()
    path.write_bytes(harm)
    assert answers("rs274") == new
    assert path.read_bytes() != harm and answers("rs274") == new


def test_nothing_of_ours_reads_pickles() -> None:
    """Neither we nor a library on our behalf: Lark's and numba's own caches are pickles."""
    top = Path(grammar.__file__).parents[1]
    for path in top.rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        for word in ("import pickle", "from pickle", "marshal", "shelve", "joblib", "cache=True", "allow_pickle=True"):
            assert word not in text, f"{path.name}: {word}"
