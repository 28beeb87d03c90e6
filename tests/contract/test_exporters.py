"""What every exporter promises, whoever adds it."""

from __future__ import annotations

import io
from pathlib import Path
from typing import get_args

import pytest

from gcodesim.export import EXPORTERS
from gcodesim.export.exporter import Exporter, NoExportError, Option, Request
from gcodesim.playback import Recording


@pytest.mark.parametrize("kind", EXPORTERS)
def test_declares_itself(kind: str) -> None:
    exporter = EXPORTERS[kind]

    assert issubclass(exporter, Exporter) and exporter.kind == kind
    assert exporter.says and "\n" not in exporter.says
    assert exporter.suffix and exporter.writes in ("text", "bytes", "folder")
    assert exporter.takes <= set(get_args(Option))


@pytest.mark.parametrize("kind", EXPORTERS)
def test_writes_a_run_the_same_each_time(kind: str, slot: Recording, tmp_path: Path) -> None:
    first, second = (written(kind, slot, tmp_path / name / "out") for name in ("first", "second"))

    assert first == second
    assert all(first)


@pytest.mark.parametrize("kind", [kind for kind in EXPORTERS if "topics" in EXPORTERS[kind].takes])
def test_says_what_is_not_there(kind: str, slot: Recording, tmp_path: Path) -> None:
    out = tmp_path / "out" if EXPORTERS[kind].writes == "folder" else io.StringIO()

    with pytest.raises(NoExportError, match="/nothing"):
        EXPORTERS[kind]().write(slot, out, Request(topics=("/nothing",)))


def written(kind: str, recording: Recording, folder: Path) -> tuple[str, int]:
    """What an exporter says that it wrote, and the hash or size of that."""
    exporter = EXPORTERS[kind]()
    if exporter.writes == "folder":
        folder.parent.mkdir()
        said = exporter.write(recording, folder, Request())
        return said, sum(path.stat().st_size for path in folder.iterdir())
    out: io.StringIO | io.BytesIO = io.StringIO() if exporter.writes == "text" else io.BytesIO()
    said = exporter.write(recording, out, Request())
    return said, hash(out.getvalue())
