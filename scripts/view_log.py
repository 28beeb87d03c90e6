"""Open logs in a real, headless viewer and check that it shows them; also take the picture of the README.

    python scripts/view_log.py LOG.mcap ...                      start, middle, end, and back again
    python scripts/view_log.py LOG.mcap --picture docs/replay.png --at 0.6
    python scripts/view_log.py --live ADDRESS LOG.mcap           follows a run that `gcodesim run --live` has begun

The viewer is the last published build of Foxglove Studio's open core, from
which Lichtblick descends: the npm package `@foxglove/studio-base`. It is
fetched once with `npm`, into ~/.cache/gcodesim-viewer. Needs npm, Debian's
`chromium` and the Python package `playwright` (which drives it).

A log is opened with the layout that it carries; a run that is followed, with that of LOG, an earlier run of the same.
The viewer is older than the present name of the live protocol and is taught it, as Lichtblick was.
 At each moment the problem
list of the viewer has to be empty, no panel may complain, every plot has to
have curves; cut surface has to grow; and the picture of a moment has to be the
same whether it was reached forwards or backwards.
"""

from __future__ import annotations

import argparse
import re
import shutil
import subprocess
import sys
import tarfile
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from io import BytesIO
from pathlib import Path
from typing import Any
from urllib.parse import quote

import chromium
import numpy as np
from numpy.typing import NDArray
from PIL import Image

from gcodesim.log.logfile import LogFile

PACKAGES = ("@foxglove/studio-base@1.48.0", "react@17.0.2", "react-dom@17.0.2")
PARTS = {
    "assets": "@foxglove/studio-base/assets",
    "react.js": "react/umd/react.production.min.js",
    "react-dom.js": "react-dom/umd/react-dom.production.min.js",
}
OLD_NAME, NEW_NAME = b"foxglove.websocket.v1", b"foxglove.sdk.v1"
OWN = Path(__file__).parent / "viewer"
MOMENTS = (0.0, 0.5, 1.0, 0.5, 0.25, 0.0)


def fetch_viewer(folder: Path) -> Path:
    """The web pages of the viewer in `folder`; fetched when they are not there."""
    pages = folder / "pages-2"
    if not pages.exists():
        with tempfile.TemporaryDirectory(dir=make(folder)) as scratch:
            made = Path(scratch)
            for package in PACKAGES:
                name = package.rpartition("@")[0]
                said = subprocess.run(["npm", "pack", package], cwd=made, capture_output=True, text=True, check=True)
                with tarfile.open(made / said.stdout.split()[-1]) as archive:
                    archive.extractall(made / "packages" / name, filter="data")
            (made / "pages").mkdir()
            for part, source in PARTS.items():
                shutil.move(made / "packages" / _inside(source), made / "pages" / part)
            script = made / "pages" / "assets" / "index.js"
            script.write_bytes(script.read_bytes().replace(OLD_NAME, NEW_NAME))
            (made / "pages").rename(pages)
    return pages


def _inside(path: str) -> str:
    """Where a path of a package lies: npm packs everything into a folder `package`."""
    parts = path.split("/")
    cut = 2 if path.startswith("@") else 1
    return "/".join([*parts[:cut], "package", *parts[cut:]])


def make(folder: Path) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    return folder


class Pages(SimpleHTTPRequestHandler):
    """Serves some files, also pieces of them: the viewer reads a log by ranges."""

    protocol_version = "HTTP/1.1"

    def __init__(self, files: dict[str, Path], viewer: Path, *arguments: Any) -> None:
        self.files, self.viewer = files, viewer
        super().__init__(*arguments)

    def log_message(self, *_: Any) -> None:
        pass

    def translate_path(self, path: str) -> str:
        name = path.partition("?")[0].lstrip("/")
        for found in (self.files.get(name), OWN / name, self.viewer / name):
            if found is not None and found.is_file():
                return str(found)
        return str(self.viewer / "none")

    def end_headers(self) -> None:
        self.send_header("Accept-Ranges", "bytes")
        super().end_headers()

    def do_GET(self) -> None:
        span = re.fullmatch(r"bytes=(\d+)-(\d*)", self.headers.get("Range", ""))
        path = Path(self.translate_path(self.path))
        if span is None or not path.is_file():
            super().do_GET()
            return
        size = path.stat().st_size
        first, last = int(span[1]), min(int(span[2] or size), size - 1)
        self.send_response(206)
        self.send_header("Content-Range", f"bytes {first}-{last}/{size}")
        self.send_header("Content-Length", str(last - first + 1))
        self.end_headers()
        with path.open("rb") as stream:
            stream.seek(first)
            self.wfile.write(stream.read(last - first + 1))


class Quiet(ThreadingHTTPServer):
    """A viewer that jumps hangs up in the middle of an answer: that is no error."""

    daemon_threads = True

    def handle_error(self, *_: Any) -> None:
        pass


@contextmanager
def served(files: dict[str, Path], viewer: Path) -> Iterator[str]:
    server = Quiet(("127.0.0.1", 0), partial(Pages, files, viewer))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    try:
        yield f"http://127.0.0.1:{server.server_address[1]}"
    finally:
        server.shutdown()


class Viewer:
    """The viewer in a browser tab."""

    def __init__(self, page: Any, site: str, source: str) -> None:
        self.page, self.complaints, self.close = page, list[str](), "3D!cell"
        page.on("pageerror", lambda error: self.complaints.append(f"page error: {error}"))
        page.goto(f"{site}/index.html?{source}&layoutId=log", timeout=120_000)
        page.get_by_text("START TIME").wait_for(timeout=120_000)
        page.get_by_text("Problems", exact=True).click()
        self.close = self.panels("3D")[-1]  # where the part is large
        if "remote-file" in source:
            self.settled()
        else:
            page.wait_for_timeout(5_000)
        page.on("console", self._hear)  # only now: before the data is there, frames are missing

    def _hear(self, message: Any) -> None:
        if message.type == "error" or (message.type == "warning" and re.match(r"\[.+ > .+\]", message.text)):
            self.complaints.append(f"{message.type}: {message.text}")

    def box(self, panel: str) -> Any:
        return self.page.locator(f'[data-testid="panel-mouseenter-container {panel}"]').bounding_box()

    def picture(self, panel: str = "") -> bytes:
        return self.page.screenshot(**({"clip": self.box(panel)} if panel else {}), timeout=120_000)

    def settled(self, limit: float = 60.0) -> bytes:
        """The scene when it has not changed for two seconds."""
        before, begin, same = b"", time.monotonic(), 0
        while time.monotonic() - begin < limit:
            now = self.picture(self.close)
            same = same + 1 if now == before else 0
            if same == 4:
                break
            before = now
            time.sleep(0.5)
        return before

    def seek(self, part: float) -> bytes:
        """Jump to a part of the log, by a click on the time bar."""
        bar = self.page.locator("[class*=Slider-root]").first.bounding_box()
        x = bar["x"] + min(max(part * bar["width"], 0.01), bar["width"] - 0.01)
        self.page.mouse.click(x, bar["y"] + bar["height"] / 2)
        self.page.mouse.move(bar["x"] + 20.0, 100.0)
        return self.settled()

    def whole(self) -> bytes:
        """The window without side bars, hints and pointer."""
        tabs = self.page.get_by_role("tab")
        if tabs.count():
            tabs.first.click()
        for hint in self.page.locator("[role=tooltip] button").all():
            hint.click()
        self.settled()
        self.page.mouse.move(800.0, 980.0)
        return self.picture()

    def panels(self, kind: str) -> list[str]:
        names = self.page.evaluate("() => [...document.querySelectorAll('[data-testid]')].map(e => e.dataset.testid)")
        return [name.split()[-1] for name in names if f"{kind}!" in name]

    def problems(self) -> str:
        """The viewer's own list, empty when it says so."""
        text = self.page.locator("body").inner_text().split("Problems", 1)[1]
        return "" if "No problems found" in text else " ".join(text.split())[:300]


Picture = NDArray[np.int16]


def pixels(png: bytes) -> Picture:
    """Red, green, blue (rows, columns, 3)."""
    return np.asarray(Image.open(BytesIO(png)).convert("RGB"), dtype=np.int16)


def coloured(picture: Picture) -> int:
    """How many pixels are not grey."""
    most, least = picture.max(axis=2), picture.min(axis=2)
    return int((most - least > 0.35 * most).sum())


def cut_surface(picture: Picture) -> int:
    """How many pixels have the gold of cut surface, in any light."""
    r, g, b = np.moveaxis(picture, 2, 0)
    return int(((r > 1.08 * g) & (g > 1.3 * b) & (r < 1.45 * g)).sum())


def alike(one: Picture, other: Picture) -> bool:
    """Whether the same is drawn: software that smooths edges is off in some pixels."""
    return float((np.abs(one - other).max(axis=2) > 8).mean()) < 1e-4


def check(viewer: Viewer, shots: Path | None = None) -> list[str]:
    """What the viewer did not show as it should; with `shots`, a picture of each moment in files that begin so."""
    wrong, scenes, cut = [], dict[float, Picture](), dict[float, int]()
    for i, part in enumerate(MOMENTS):
        scene = pixels(viewer.seek(part))
        if shots is not None:
            shots.with_name(f"{shots.name}_{i}_{part:.2f}.png").write_bytes(viewer.picture())
        problems = viewer.problems()
        if problems:
            wrong.append(f"at {part:.0%}: problem list: {problems}")
        if part in scenes and not alike(scenes[part], scene):
            wrong.append(f"at {part:.0%}: the scene differs when it is reached backwards")
        scenes[part], cut[part] = scene, cut_surface(scene)
        print(f"  {part:4.0%}: {coloured(scene)} coloured pixels in the scene, {cut[part]} of cut surface")
    if not cut[0.0] < cut[0.5] <= 1.5 * max(cut[1.0], 1):
        wrong.append(f"cut surface does not grow: {cut}")
    if alike(scenes[0.0], scenes[0.5]) or alike(scenes[0.5], scenes[1.0]):
        wrong.append("the scene does not change")
    return [*wrong, *_empty_plots(viewer), *viewer.complaints]


def follow(viewer: Viewer, shots: Path | None = None) -> list[str]:
    """What the viewer does not show of a run that goes on."""
    wrong, scenes = [], list[Picture]()
    for i in range(4):
        scenes.append(pixels(viewer.picture(viewer.close)))
        if shots is not None:
            shots.with_name(f"live_{i}.png").write_bytes(viewer.picture())
        print(f"  {coloured(scenes[-1])} coloured pixels in the scene, {cut_surface(scenes[-1])} of cut surface")
        problems = viewer.problems()
        if problems:
            wrong.append(f"problem list: {problems}")
        time.sleep(2.0)
    if all(alike(scenes[0], scene) for scene in scenes):
        wrong.append("the scene does not change")
    return [*wrong, *_empty_plots(viewer), *viewer.complaints]


def _empty_plots(viewer: Viewer) -> Iterator[str]:
    for plot in viewer.panels("Plot"):
        if coloured(pixels(viewer.picture(plot))) < 150:
            yield f"{plot} shows no curve"


def main() -> int:
    from playwright.sync_api import sync_playwright

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("logs", nargs="+", type=Path, metavar="LOG")
    parser.add_argument("--live", metavar="ADDRESS", help="follow a run at the address that it printed")
    parser.add_argument("--picture", type=Path, help="only take a picture")
    parser.add_argument("--at", type=float, default=0.6, help="part of the log that the picture shows")
    parser.add_argument("--shots", type=Path, metavar="FOLDER", help="keep a picture of each moment")
    parser.add_argument("--layout", type=Path, help="another layout than that of the log")
    parser.add_argument("--folder", type=Path, default=Path.home() / ".cache" / "gcodesim-viewer")
    parser.add_argument("--chromium", default=chromium.PROGRAM or "/usr/bin/chromium")
    arguments = parser.parse_args()
    pages, bad = fetch_viewer(arguments.folder), 0
    with sync_playwright() as playwright, tempfile.TemporaryDirectory() as scratch:
        browser = playwright.chromium.launch(executable_path=arguments.chromium, args=chromium.FLAGS)
        for log in arguments.logs:
            layout = Path(scratch) / "layout.json"
            layout.write_bytes(
                arguments.layout.read_bytes() if arguments.layout else LogFile.open(log).attachment("layout.json")
            )
            with served({"run.mcap": log, "layout.json": layout}, pages) as site:
                page = browser.new_page(viewport={"width": 1720, "height": 1000})
                source = f"ds=remote-file&ds.url={site}/run.mcap"
                if arguments.live:
                    source = f"ds=foxglove-websocket&ds.url={quote(arguments.live, safe='')}"
                viewer = Viewer(page, site, source)
                print(log)
                if arguments.picture:
                    viewer.seek(arguments.at)
                    arguments.picture.write_bytes(viewer.whole())
                    continue
                shots = None if arguments.shots is None else make(arguments.shots) / log.parent.name
                wrong = follow(viewer, shots) if arguments.live else check(viewer, shots)
                bad += bool(wrong)
                print("\n".join(f"  {line}" for line in wrong) if wrong else "  good")
                page.close()
        browser.close()
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
