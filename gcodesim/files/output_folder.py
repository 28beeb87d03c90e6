"""The folder of a run: nobody else writes there meanwhile, and no file of the user is lost in it."""

from __future__ import annotations

import errno
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Final

from gcodesim.diagnostics import Diagnostic, Span
from gcodesim.files.png import SIGNATURE, SOFTWARE, SOFTWARE_AT

try:
    import fcntl
except ImportError:  # not everywhere
    fcntl = None  # type: ignore[assignment]

LOG_NAME: Final = "run.mcap"
RESULTS_NAME: Final = "results.json"
LINES_NAME: Final = "lines.csv"
CELL_NAME: Final = "cell.yaml"
SETUP_NAME: Final = "setup.json"
SETUPS_NAME: Final = "setups.json"
SWEEP_NAME: Final = "sweep.json"
SWEEP_TABLES: Final = ("runs.csv", "runs.parquet")
SWEEP_PAGE: Final = "sweep.html"
TABLE_OF_READINGS: Final = "_readings.csv"
STOCK_SUFFIXES: Final = (".stl", ".stock")
SKIN_SUFFIX: Final = ".skin.ply"
FILM_SUFFIXES: Final = (".film.ply", ".film.csv")
OVERWRITES: Final = "GS750"
IN_USE: Final = "GS751"

# how files of each name begin when gcodesim wrote them, and where in the file
_BEGINNINGS: Final[Mapping[str, tuple[tuple[int, bytes], ...]]] = {
    ".mcap": ((0, b"\x89MCAP0\r\n"), (25, b"gcodesim")),
    ".json": ((0, b'{\n "schema": "gcodesim-results/'),),
    SETUP_NAME: ((0, b'{\n "schema": "gcodesim-setup/'),),
    SETUPS_NAME: ((0, b'{\n "schema": "gcodesim-setups/'),),
    SWEEP_NAME: ((0, b'{\n "schema": "gcodesim-sweep/'),),
    SWEEP_TABLES[0]: ((0, b"run,"),),
    SWEEP_TABLES[1]: ((0, b"PAR1"),),
    SWEEP_PAGE: ((0, b'<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta name="generator" content="gcodesim'),),
    ".csv": ((0, b"file,line,time_s,"),),
    TABLE_OF_READINGS: ((0, b"reading,time_s,"),),
    ".stl": ((0, b"gcodesim binary STL"),),
    ".stock": ((0, b"gcodesim-"),),  # of blocks and of turned bars
    SKIN_SUFFIX: ((0, b"ply\nformat binary_little_endian 1.0\ncomment gcodesim skin"),),
    ".film.ply": ((0, b"ply\nformat binary_little_endian 1.0\ncomment gcodesim film"),),
    ".film.csv": ((0, b"x_mm,y_mm,z_mm,nx,ny,nz,area_mm2,film_um"),),
    ".png": ((0, SIGNATURE), (SOFTWARE_AT, SOFTWARE)),
    ".npy": ((0, b"\x93NUMPY"),),
}
_HEAD: Final = 80


class FolderInUseError(Exception):
    """Another run that is still going writes into the folder."""


def link_on_the_way(out: Path) -> Path | None:
    """The first link through which the folder `out` would be reached; None if there is none.

    The folders above an absolute path are the system's, those above a relative one may be a stranger's.
    """
    ways = [out] if out.is_absolute() else [*reversed(out.parents), out]
    return next((way for way in ways if way.is_symlink()), None)


def dose_names(stock: str, kind: str) -> tuple[str, str]:
    """The files of a map of what beams gave a stock: picture and numbers."""
    return f"{stock}.{kind}.png", f"{stock}.{kind}.npy"


def names_of(
    stocks: Iterable[str],
    coated: Iterable[str] = (),
    doses: Mapping[str, Iterable[str]] | None = None,
    painted: Iterable[str] = (),
    only: str | None = None,
) -> list[str]:
    """The files that a run with these stocks writes, with films on bodies `coated`, maps of `doses` of stocks, and the
    skins of those stocks that are `painted` because they may be compared with a target.

    `only`: what the run is about, if not all.
    """
    of_stocks = [f"{name}{suffix}" for name in stocks for suffix in STOCK_SUFFIXES]
    of_films = [f"{name}{suffix}" for name in coated for suffix in FILM_SUFFIXES]
    maps = (file for stock, kinds in (doses or {}).items() for kind in kinds for file in dose_names(stock, kind))
    skins = (f"{name}{SKIN_SUFFIX}" for name in painted)
    log, shapes = [LOG_NAME], [*of_stocks, *of_films, *maps, *skins]
    return [*log * (only in (None, "motion")), RESULTS_NAME, LINES_NAME, *shapes * (only in (None, "shape"))]


def _kind_of(name: str) -> str:
    """How a name that gcodesim gives ends."""
    if name in (SETUP_NAME, SETUPS_NAME, SWEEP_NAME, *SWEEP_TABLES, SWEEP_PAGE):
        return name
    long = (*FILM_SUFFIXES, SKIN_SUFFIX, TABLE_OF_READINGS)
    return next((suffix for suffix in long if name.endswith(suffix)), Path(name).suffix)


@contextmanager
def claimed(out: Path) -> Iterator[None]:
    """Make the folder and claim it for this run; FolderInUseError if another run has it, OSError if that fails.

    The claim ends with the process, however that ends, and leaves no file behind.
    """
    out.mkdir(parents=True, exist_ok=True)
    held = None
    if fcntl is not None:
        with suppress(OSError):  # a folder that cannot be opened, or a file system without locks: go on without a lock
            held = os.open(out, os.O_RDONLY)
    try:
        if held is not None:
            try:
                fcntl.flock(held, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError as error:
                if error.errno in (errno.EWOULDBLOCK, errno.EACCES):
                    raise FolderInUseError(out) from None
        yield
    finally:
        if held is not None:
            os.close(held)


def in_use(span: Span) -> Diagnostic:
    """GS751."""
    return Diagnostic(
        code=IN_USE,
        span=span,
        message="another run is writing into the output folder",
        hint="wait for its end, or give this one a folder of its own: `--out DIR`",
    )


def overwriting(out: Path, names: Sequence[str], inputs: Iterable[Path], span: Span) -> list[Diagnostic]:
    """GS750 for each file of `names` in `out` that is one of `inputs`, or that gcodesim did not write."""
    inputs, found = list(inputs), []
    for name in names:
        for path in (out / name, out / f"{name}.part"):
            reason = _reason(path, _kind_of(name), inputs)
            if reason:
                found.append(_overwritten(path, reason, span))
    return found


def overwriting_text(path: Path, mark: bytes, span: Span) -> list[Diagnostic]:
    """GS750 if `path` is there and is no text that gcodesim wrote: those have `mark` in them."""
    if not os.path.lexists(path) or (path.is_file() and mark in path.read_bytes()):
        return []
    return [_overwritten(path, "gcodesim did not write", span)]


def _overwritten(path: Path, reason: str, span: Span) -> Diagnostic:
    return Diagnostic(
        code=OVERWRITES,
        span=span,
        message=f"the run would overwrite `{path.name}` in the output folder, which {reason}",
        hint="give the run a folder of its own: `--out DIR`; or overwrite it: `--force`",
    )


def other_cell(out: Path, cell: bytes, span: Span) -> list[Diagnostic]:
    """GS750 if a run that writes its `cell` into `out` would overwrite another one, which somebody may have changed."""
    path = out / CELL_NAME
    if not os.path.lexists(path) or (path.is_file() and path.read_bytes() == cell):
        return []
    return [
        Diagnostic(
            code=OVERWRITES,
            span=span,
            message=f"the run would overwrite `{CELL_NAME}` in the output folder, which is not the cell of this run",
            hint="run in that one by `--cell`, give the run a folder by `--out`, or overwrite it by `--force`",
        )
    ]


def _reason(path: Path, kind: str, inputs: Sequence[Path]) -> str:
    """Why a file must not be overwritten; empty when it may be."""
    if not os.path.lexists(path):
        return ""
    if any(_same(path, other) for other in inputs):
        return "it reads"
    return "" if _is_ours(path, kind) else "gcodesim did not write"


def _same(path: Path, other: Path) -> bool:
    with suppress(OSError):
        return path.samefile(other)
    return False


def _is_ours(path: Path, kind: str) -> bool:
    """Whether the file begins as gcodesim begins such files; so does one that was cut off, or is empty."""
    if path.is_symlink() and not path.exists():
        return True
    if not path.is_file():
        return False
    try:
        with path.open("rb") as file:
            head = file.read(_HEAD)
    except OSError:
        return False  # unknown
    return all(mark.startswith(head[at : at + len(mark)]) for at, mark in _BEGINNINGS[kind])


def forget(out: Path, names: Iterable[str]) -> None:
    """Remove `names` in `out`, as far as an earlier run left them, whole or not."""
    for name in names:
        (out / name).unlink(missing_ok=True)
        (out / f"{name}.part").unlink(missing_ok=True)
