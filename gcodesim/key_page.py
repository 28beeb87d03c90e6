"""Pages of `docs` with a table of keys that is made from the code, between two markers."""

from __future__ import annotations

from pathlib import Path
from typing import Final

BEGIN: Final = "<!-- keys: begin -->"
END: Final = "<!-- keys: end -->"


def escaped(text: str) -> str:
    """`text` for a cell of a Markdown table."""
    return text.replace("|", "\\|")


def with_keys(page: str, keys: str) -> str:
    """`page` with the part between the markers replaced by `keys`."""
    before, _, rest = page.partition(BEGIN)
    _, _, after = rest.partition(END)
    return f"{before}{BEGIN}\n\n{keys}\n\n{END}{after}"


def rewrite(path: Path, keys: str) -> None:
    """Replace the part between the markers of the file at `path`."""
    path.write_text(with_keys(path.read_text(encoding="utf-8"), keys), encoding="utf-8")
