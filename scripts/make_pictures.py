"""Make the pictures of README and gallery anew: `python scripts/make_pictures.py [NAME …] [--viewer]`.

Each picture of the README carries the hash of the part that its run leaves (PNG text `Part`), each of the gallery the
digest of the accepted result that it shows, or of what its script prints, so a test tells when one is stale.
`report.png` needs chromium (`make browser`), `replay.png` the viewer of `view_log.py`; it is made with `--viewer` only.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import struct
import subprocess
import sys
import tempfile
import zlib
from pathlib import Path
from typing import NamedTuple

TOP = Path(__file__).resolve().parent.parent
STAMP = b"Part"
_HEAD = 8  # bytes of a PNG before its first chunk


class Picture(NamedTuple):
    """A picture of `docs`: the run that it shows, and the script that draws it from the folder of that run."""

    program: str
    cell: str
    world: str
    script: tuple[str, ...]


PICTURES = {
    "bracket.png": Picture("bracket.nc", "bracket.yaml", "bullet", ("picture.py", "{out}/stock.stl", "{png}")),
    "report.png": Picture(
        "bracket.nc",
        "bracket_kr10.yaml",
        "kinematic",
        ("page_picture.py", "{out}/report.html", "{png}", "--time", "175"),
    ),
    "replay.png": Picture(
        "bracket.nc", "bracket.yaml", "bullet", ("view_log.py", "{out}/run.mcap", "--picture", "{png}", "--at", "0.6")
    ),
}


class Shot(NamedTuple):
    """A picture of the gallery: the example, the time [s] of its run (None: the end), words for `cell_picture.py`."""

    example: str
    at: float | None
    view: str = ""
    channels: tuple[str, ...] = ()


GALLERY = {
    "agv.png": Shot("agv", 4.5, "--turn 110"),
    "bushing.png": Shot("bushing", 33.0, "--target 0 0 0.17 --span 0.35 --turn -25 --tilt 15"),
    "concrete_wall.png": Shot("concrete_wall", 104.0, "--target 0.63 0 0.24 --span 0.85 --turn 60 --tilt 25"),
    "cut_and_blast.png": Shot("cut_and_blast", 6.5, "--target 0.425 0.28 -0.27 --span 0.22"),
    "cutters.png": Shot("cutters", 125.0, "--target 0.5 0.36 -0.3 --span 0.36 --tilt 35"),
    "face_contour.png": Shot("face_contour", 45.0, "--target 0 0 0.13 --span 0.2 --turn -25 --tilt 30"),
    "flange.png": Shot("flange", None, "--target 0.4 0.3 -0.27 --span 0.3"),
    "hub.png": Shot("hub", 62.0, "--target 0 0 0.13 --span 0.2 --turn -25 --tilt 20"),
    "index_table.png": Shot(
        "index_table", 20.0, "--target 0.85 0 0.35 --span 0.6 --tilt 40", ("right=index_table.right.nc",)
    ),
    "inspection.png": Shot("inspection", 9.1, "--target 0.53 0.33 -0.235 --span 0.32"),
    "learned_wall.png": Shot("learned_wall", 26.0, "--target 0.53 -0.03 0.24 --span 0.45"),
    "machine_tending.png": Shot("machine_tending", 9.0),
    "palletising.png": Shot("palletising", 30.0),
    "quick_change.png": Shot("quick_change", 21.2, "--turn 60"),
    "rivets.png": Shot("rivets", 55.0, "--target 0.43 0.315 -0.28 --span 0.17 --tilt 35"),
    "scan_heads.png": Shot("scan_heads", 2.2, "--target 0.46 0.28 -0.26 --span 0.4"),
    "spray_two_arms.png": Shot(
        "spray_two_arms", 6.0, "--target 0.78 0 0.72 --span 0.75", ("holder=spray_two_arms.holder.nc",)
    ),
    "two_arms.png": Shot("two_arms", 20.0, "--target 0.77 0 0.42 --span 0.75", ("right=two_arms.right.nc",)),
    "welding.png": Shot("welding", 20.0, "--target 0.6 -0.01 0.3 --span 0.5"),
}


class Scripted(NamedTuple):
    """A picture of the gallery of what a script of `programs` does: a script that draws it from the folders of runs."""

    example: str
    runs: tuple[str, ...]
    script: str
    view: str = ""


SCRIPTED = {
    "force_control.png": Scripted("force_control", ("flexible", "stiffened"), "error_chart.py"),
    "painted_together.png": Scripted(
        "painted_together", (".",), "cell_picture.py", "--at 5 --turn 40 --target 0.8 0 0.6 --span 1.9"
    ),
    "taught_poses.png": Scripted("taught_poses", (".",), "cell_picture.py", "--turn 70 --trail"),
}


def film(scripted: Scripted, folder: Path, png: Path) -> str:
    """Run a script and draw what it did into `png`; the digest of what it said."""
    digest = said_by(scripted, folder)
    runs = [str(folder / run) for run in scripted.runs]
    script = (sys.executable, str(TOP / "scripts" / scripted.script), *runs, str(png), *scripted.view.split())
    subprocess.run(script, check=True, cwd=TOP)
    return digest


def said_by(scripted: Scripted, folder: Path) -> str:
    """Digest of what a script prints, which runs into `folder`."""
    order = (sys.executable, str(TOP / "programs" / f"{scripted.example}.py"), str(folder))
    done = subprocess.run(order, check=True, cwd=TOP, stdout=subprocess.PIPE)
    return hashlib.sha256(done.stdout).hexdigest()


def shoot(shot: Shot, folder: Path, png: Path) -> str:
    """Run an example and draw its cell into `png`; the digest of its accepted result."""
    out = folder / "out"
    program, cell = TOP / "programs" / f"{shot.example}.nc", TOP / "cells" / f"{shot.example}.yaml"
    words = [word for channel in shot.channels for word in ("--channel", _in_programs(channel))]
    order = ("run", program, "--cell", cell, "--world", "kinematic", "--out", out, *words)
    subprocess.run([sys.executable, "-m", "gcodesim", *map(str, order)], check=True, cwd=TOP, capture_output=True)
    view = [*shot.view.split(), *([] if shot.at is None else ["--at", str(shot.at)])]
    script = (sys.executable, str(TOP / "scripts" / "cell_picture.py"), str(out), str(png), *view)
    subprocess.run(script, check=True, cwd=TOP)
    return digest_of(shot)


def _in_programs(channel: str) -> str:
    name, _, program = channel.partition("=")
    return f"{name}={TOP / 'programs' / program}"


def digest_of(shot: Shot) -> str:
    """What stands in the golden file of an example."""
    golden = json.loads((TOP / "programs" / f"{shot.example}.golden.json").read_text(encoding="utf-8"))
    return str(golden["digest"])


def run(picture: Picture, out: Path) -> str:
    """Run the program of a picture into `out`; the hash of the part that it leaves."""
    gcodesim = (sys.executable, "-m", "gcodesim")
    program, cell = TOP / "programs" / picture.program, TOP / "cells" / picture.cell
    order = ("run", program, "--cell", cell, "--world", picture.world, "--out", out)
    subprocess.run([*gcodesim, *map(str, order)], check=True, cwd=TOP, capture_output=True)
    return hashlib.sha256((out / "stock.stl").read_bytes()).hexdigest()


def draw(picture: Picture, out: Path, png: Path) -> None:
    """Draw a picture from the folder of its run."""
    script, *words = (word.format(out=out, png=png) for word in picture.script)
    if "page_picture" in script:
        report = (sys.executable, "-m", "gcodesim", "report", str(out), "-o", str(out / "report.html"))
        subprocess.run(report, check=True, cwd=TOP, capture_output=True)
    subprocess.run([sys.executable, str(TOP / "scripts" / script), *words], check=True, cwd=TOP)


def stamped(png: bytes, part: str) -> bytes:
    """The picture with the hash of its part as text."""
    text = STAMP + b"\0" + part.encode()
    chunk = struct.pack(">I", len(text)) + b"tEXt" + text + struct.pack(">I", zlib.crc32(b"tEXt" + text))
    end = _HEAD + 8 + struct.unpack_from(">I", png, _HEAD)[0] + 4  # behind the first chunk, which says the size
    return png[:end] + chunk + png[end:]


def part_of(png: bytes) -> str | None:
    """The hash that a picture carries."""
    at = _HEAD
    while at < len(png):
        (size,) = struct.unpack_from(">I", png, at)
        kind, data = png[at + 4 : at + 8], png[at + 8 : at + 8 + size]
        if kind == b"tEXt" and data.startswith(STAMP + b"\0"):
            return data[len(STAMP) + 1 :].decode()
        at += size + 12
    return None


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    every = [*PICTURES, *GALLERY, *SCRIPTED]
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"{', '.join(every)} (default: all)")
    parser.add_argument("--viewer", action="store_true", help="also the picture that needs the viewer")
    parser.add_argument("--into", type=Path, default=TOP / "docs", metavar="DIR", help="where to (default: docs)")
    arguments = parser.parse_args()
    for name in arguments.names or every:
        if name in GALLERY or name in SCRIPTED:
            with tempfile.TemporaryDirectory() as folder:
                png = Path(folder) / name
                scripted = SCRIPTED.get(name)
                digest = film(scripted, Path(folder), png) if scripted else shoot(GALLERY[name], Path(folder), png)
                target = arguments.into / "gallery" / name
                target.parent.mkdir(exist_ok=True)
                target.write_bytes(stamped(png.read_bytes(), digest))
            print(target)
            continue
        if "view_log.py" in PICTURES[name].script and not arguments.viewer:
            continue
        with tempfile.TemporaryDirectory() as folder:
            out, png = Path(folder) / "out", Path(folder) / name
            part = run(PICTURES[name], out)
            draw(PICTURES[name], out, png)
            (arguments.into / name).write_bytes(stamped(png.read_bytes(), part))
        print(arguments.into / name)


if __name__ == "__main__":
    main()
