"""The repository in which a run takes place."""

from __future__ import annotations

from pathlib import Path


def top_of(folder: Path) -> Path:
    """The top of the repository that holds `folder`; `folder` itself where there is none. Links are followed."""
    folder = folder.resolve()
    return next((above for above in (folder, *folder.parents) if (above / ".git").exists()), folder)
