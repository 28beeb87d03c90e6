"""The version of gcodesim: said here, read by the build."""

from __future__ import annotations

from typing import Final

__version__: Final = "0.1.0"
