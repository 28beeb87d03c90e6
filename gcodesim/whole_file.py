"""Files that are there as a whole or not at all."""

from __future__ import annotations

from pathlib import Path


def write_whole(path: Path, data: bytes) -> None:
    """Write `data` beside `path` first and give it its name at the end; OSError when the disk does not take it."""
    part = path.with_name(path.name + ".part")
    part.write_bytes(data)
    part.replace(path)
