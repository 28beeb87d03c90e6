"""One short name for several texts."""

from __future__ import annotations

import hashlib


def digest_of_texts(*texts: str) -> str:
    """SHA-256 of texts and their order, as hexadecimal digits; names of files that are no UTF-8 have one too."""
    return hashlib.sha256("\0".join(texts).encode("utf-8", "surrogateescape")).hexdigest()
