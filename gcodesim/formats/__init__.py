"""Verdicts for machines: the same findings as SARIF, JUnit XML, GitHub annotations and GitLab code quality.

Each format is one file with `text_of(verdict, places) -> str`, written from a `SuiteVerdict` alone: a command that
reads one program gives a suite of one case. Equal verdicts give equal bytes: no time of day, no host, no absolute path.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import Final

from gcodesim.formats.places import FilePlaces
from gcodesim.regress.verdicts import SuiteVerdict

FORMATS: Final = ("sarif", "junit", "github", "gitlab")

Writer = Callable[[SuiteVerdict, FilePlaces], str]


def writer_of(name: str) -> Writer:
    """The function that writes format `name`, one of `FORMATS`."""
    writer: Writer = import_module(f"gcodesim.formats.{name}").text_of
    return writer


__all__ = ["FORMATS", "FilePlaces", "Writer", "writer_of"]
