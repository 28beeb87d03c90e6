"""The part in colours on the page, in a real browser: a place leads to its line, a line to its faces, and back."""

import html
import json
import re
from pathlib import Path

import pytest

from gcodesim.playback import Recording
from gcodesim.report.page import write_page
from scripts import chromium
from tests.unit.report.test_browser import opened

TOP = Path(__file__).parents[3]
PROBE = r"""<script>
(async () => {
  const seen = { errors: [] };
  window.addEventListener("error", (event) => seen.errors.push(String(event.message)));
  const pause = (ms) => new Promise((done) => setTimeout(done, ms));
  for (let i = 0; i < 200 && !document.body.dataset.ready; i++) await pause(50);
  seen.ready = document.body.dataset.ready;
  const [view] = G.views;
  const count = (wanted) => {
    view.dirty = true;
    view.render();
    const copy = document.createElement("canvas"), pen = copy.getContext("2d");
    copy.width = view.renderer.domElement.width;
    copy.height = view.renderer.domElement.height;
    pen.drawImage(view.renderer.domElement, 0, 0);
    const { data } = pen.getImageData(0, 0, copy.width, copy.height);
    let found = 0;
    for (let i = 0; i < data.length; i += 4) {
      if (data[i + 3] > 200 && wanted(data[i], data[i + 1], data[i + 2])) found++;
    }
    return found;
  };
  const red = (r, g, b) => r > 120 && r > 2 * g && r > 2 * b, pink = (r, g, b) => r > 150 && g < 80 && b > 90;
  view.look("top");
  for (const part of ["path", "cell", "force"]) view.shown[part] = false;
  for (const body of view.bodies) body.visible = false;
  const bare = () => { for (const tool of view.tools) tool.group.visible = false; };
  const choice = document.querySelector("select.part-by");
  seen.choices = [...choice.options].map((option) => option.value);
  const choose = (name) => { choice.value = name; choice.dispatchEvent(new Event("change")); bare(); };
  bare();
  seen.red = [count(red)];
  choose("deviation");
  seen.red.push(count(red));
  seen.legend = view.partLegend.innerText;
  // the place out of tolerance: to its line, and the view to it
  const row = [...document.querySelectorAll("tr.go")].find((one) => one.textContent.startsWith("gouge"));
  seen.row = row.textContent;
  G.seek(0);
  row.click();
  seen.line = [G.time, document.querySelector(".lines .row.now")?.textContent];
  // a face: to the line that made it
  choose("line");
  bare();
  view.look("top");
  view.render();
  const mesh = view.paintedMeshes[0], { skin, deviation, maker } = mesh.userData;
  const of21 = (k) => maker[k] >= 0 && skin.makers[maker[k]][1] === 21 && Math.abs(deviation[k]) < 2;
  const f = [...maker.keys()].find(of21);
  const corners = mesh.geometry.attributes.position.array, spot = new THREE.Vector3();
  const mean = (k) => (corners[9 * f + k] + corners[9 * f + 3 + k] + corners[9 * f + 6 + k]) / 3;
  const middle = new THREE.Vector3(mean(0), mean(1), mean(2));
  mesh.updateWorldMatrix(true, false);
  spot.copy(mesh.localToWorld(middle)).project(view.camera);
  G.seek(0);
  bare();
  view.click((spot.x + 1) * 0.5 * view.box.clientWidth, (1 - spot.y) * 0.5 * view.box.clientHeight);
  seen.face = [G.time, view.said.textContent];
  // and back: the faces of the line that runs stand out
  bare();
  seen.pink = [count(pink)];
  G.seek(0);
  bare();
  seen.pink.push(count(pink));
  choose("");
  seen.plain = [view.partLegend.hidden, count(red)];
  const out = document.createElement("pre");
  out.id = "seen";
  out.textContent = JSON.stringify(seen);
  document.body.appendChild(out);
})();
</script></body>"""

pytestmark = pytest.mark.skipif(chromium.PROGRAM is None, reason="chromium is not installed: `make browser` does it")


@pytest.fixture(scope="module")
def seen(tmp_path_factory):
    from gcodesim.cli import main

    folder = tmp_path_factory.mktemp("painting")
    cell = (TOP / "cells/pocket.yaml").read_text().replace("resolution: 0.25", "resolution: 0.5")
    (folder / "pocket.yaml").write_text(cell)
    (folder / "pocket_target.stl").write_bytes((TOP / "cells/pocket_target.stl").read_bytes())
    words = ["--cell", str(folder / "pocket.yaml"), "--world", "kinematic", "--out", str(folder / "out")]
    assert main(["run", str(TOP / "programs/pocket.nc"), *words]) == 1
    page = write_page([Recording.open(folder / "out")])
    document, asked = opened(page.replace("</body>", PROBE), tmp_path_factory.mktemp("browser"))
    assert not asked
    found = re.search(r'<pre id="seen">(.*?)</pre>', document)
    assert found is not None, document[-2000:]
    return json.loads(html.unescape(found[1]))


def test_the_gouge_is_red_on_the_part(seen):
    assert seen["ready"] == "1" and seen["errors"] == []
    assert seen["choices"] == ["", "deviation", "tool", "line"]
    assert seen["red"][0] < 50 < 500 < seen["red"][1]
    assert "gouge" in seen["legend"] and "within ±0.05" in seen["legend"]
    assert seen["plain"][0] is True and seen["plain"][1] < 50


def test_a_place_leads_to_its_line(seen):
    assert "0.500" in seen["row"] and "24" in seen["row"]
    assert seen["line"][0] > 10 and "Z-4.5" in seen["line"][1]


def test_a_face_leads_to_its_line_and_the_line_to_its_faces(seen):
    time, text = seen["face"]
    assert time > 5 and re.match(r"line \d+, T1, [+−]0\.\d+ mm: ", text)
    assert seen["pink"][0] > 100 > seen["pink"][1]
