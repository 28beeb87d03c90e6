"""The page in a real browser: it draws, its time moves, and it asks no network for anything.

The browser is Debian's chromium without a window. A probe is added to the page,
which uses it as a person would and writes what it saw into the document.
"""

import html
import json
import re
import subprocess

import pytest

from gcodesim.playback import Recording
from gcodesim.report.page import Difference, write_page
from scripts import chromium

PROBE = r"""<script>
(async () => {
  const seen = { errors: [] };
  window.addEventListener("error", (event) => seen.errors.push(String(event.message)));
  const pause = (ms) => new Promise((done) => setTimeout(done, ms));
  for (let i = 0; i < 200 && !document.body.dataset.ready; i++) await pause(50);
  // how many pixels of the view are those of a colour family
  const count = (view, wanted) => {
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
  const gold = (r, g, b) => r > 120 && r > 1.15 * b && g > b && r - b > 40; // cut surface
  const anything = () => true;
  const click = (element, x, y) => {
    for (const type of ["pointerdown", "pointerup", "click"]) {
      const event = new PointerEvent(type, { bubbles: true, clientX: x, clientY: y, pointerId: 1 });
      try { element.dispatchEvent(event); } catch (problem) { seen.errors.push(String(problem)); }
    }
  };
  seen.ready = document.body.dataset.ready;
  seen.start = G.time;
  seen.views = G.views.length;
  seen.headings = [...document.querySelectorAll("th")].map((heading) => heading.textContent);
  // how far from the middle of the view, as a share of half its size, the corners of what is there at first lie
  seen.opening = (() => {
    const view = G.views[0], camera = view.camera;
    camera.updateMatrixWorld(true);
    view.scene.updateMatrixWorld(true);
    const corners = (box) => {
      let most = 0;
      for (let i = 0; i < 8; i++) {
        const at = box.min.clone();
        if (i & 1) at.x = box.max.x;
        if (i & 2) at.y = box.max.y;
        if (i & 4) at.z = box.max.z;
        at.project(camera);
        most = Math.max(most, Math.abs(at.x), Math.abs(at.y));
      }
      return most;
    };
    const { cell, part } = view.extents();
    const bodies = view.holders().map((body) => corners(cell.clone().makeEmpty().setFromObject(body)));
    return { part: corners(part), bodies, tools: view.tools.filter(({ group }) => group.visible).length };
  })();
  for (const view of G.views) view.look("top");
  for (const part of ["path", "cell", "force"]) G.views[0].shown[part] = false;
  for (const body of G.views[0].bodies) body.visible = false;
  const cut = [];
  for (const share of [0, 0.5, 1, 0]) {
    G.seek(share * G.end);
    for (const tool of G.views[0].tools) tool.group.visible = false;
    cut.push(count(G.views[0], gold));
  }
  seen.cut = cut;
  seen.drawn = count(G.views[0], anything);
  // the bar: a click in its middle
  const canvas = document.querySelector("footer canvas"), box = canvas.getBoundingClientRect();
  canvas.setPointerCapture = () => {};
  click(canvas, box.left + 0.5 * box.width, box.top + 0.5 * box.height);
  seen.middle = G.time / G.end;
  seen.now = (document.querySelector(".lines .row.now") || {}).textContent;
  seen.clock = document.querySelector(".clock b").textContent;
  // a finding, a line of the program and the play button
  document.querySelector(".finding.go").click();
  seen.finding = G.time;
  G.seek(0);
  [...document.querySelectorAll(".lines .row")].find((row) => row.textContent.includes("G1 X30")).click();
  seen.line = G.time;
  G.seek(0);
  document.querySelector(".difference.go").click();
  seen.difference = G.time;
  seen.differences = document.querySelector(".differences").innerText;
  // a closer look: modals, colours, a section, picking and measuring
  G.seek(seen.line);
  const [view] = G.views, frame = view.frame(view.run.replay.track.frame);
  seen.modals = document.querySelector(".modals").innerText;
  const choice = document.querySelector("select.by"), before = view.trackColors.slice();
  seen.choices = [...choice.options].map((option) => option.value);
  choice.value = "force";
  choice.dispatchEvent(new Event("change"));
  seen.recoloured = view.trackColors.some((value, i) => value !== before[i]);
  seen.legend = view.legend.innerText;
  const screen = (point) => {
    const spot = frame.localToWorld(point.clone()).project(view.camera);
    return [(spot.x + 1) * 0.5 * view.box.clientWidth, (1 - spot.y) * 0.5 * view.box.clientHeight];
  };
  view.shown.path = true;
  view.look("top");
  view.render();
  const i = [...view.kind.keys()].find((k) => view.kind[k] === 2 && view.times[k] > seen.line + 0.5);
  const tip = new THREE.Vector3().fromArray(view.trackPoints, 3 * i);
  view.click(...screen(tip));
  seen.picked = [G.time, view.times[i], view.said.textContent];
  view.shown.path = false;
  G.seek(view.times[i] + 0.3); // what came last up to now counts: the way back goes through the same place
  view.click(...screen(tip));
  seen.worked = [G.time, document.querySelector(".lines .row.now")?.textContent];
  view.measuring = [];
  view.click(...screen(tip.clone().add(new THREE.Vector3(0, 0.01, 0))));
  view.click(...screen(tip.clone().add(new THREE.Vector3(0.01, 0.01, 0))));
  seen.measured = view.said.textContent;
  view.measuring = null;
  for (const tool of view.tools) tool.group.visible = false;
  const whole = count(view, anything);
  view.section("X", 0.5);
  seen.section = [whole, count(view, anything), view.said.textContent];
  view.section("none", 0);
  seen.unsection = count(view, anything);
  const feeds = G.plots.find(({ box }) => box.querySelector("h2").textContent.startsWith("Feed"));
  seen.feeds = [feeds.plot.scales.y.max, Math.max(...feeds.plot.data.slice(1).flat().filter((v) => v !== null))];
  G.seek(seen.line);
  document.querySelector(".play").click();
  await pause(600);
  seen.played = G.time;
  seen.charts = document.querySelectorAll(".chart canvas").length;
  seen.tables = document.querySelectorAll("table").length;
  seen.fetched = performance.getEntriesByType("resource").map((entry) => entry.name);
  const out = document.createElement("pre");
  out.id = "seen";
  out.textContent = JSON.stringify(seen);
  document.body.appendChild(out);
})();
</script></body>"""

pytestmark = pytest.mark.skipif(chromium.PROGRAM is None, reason="chromium is not installed: `make browser` does it")


def opened(page, folder):
    """The document that a page has become, and the addresses that it asked for."""
    (folder / "page.html").write_text(page, encoding="utf-8")
    log = folder / "net.json"
    own = [f"--user-data-dir={folder / 'profile'}", f"--log-net-log={log}", "--window-size=1200,900", "--dump-dom"]
    command = [chromium.PROGRAM, *chromium.ALONE, *own, f"file://{folder / 'page.html'}"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=600, check=True)
    asked = set()
    for event in json.loads(log.read_text(errors="replace"))["events"]:
        seen = event.get("params", {})
        # what the browser asks on its own account has no initiator
        if str(seen.get("url", "")).startswith("http") and seen.get("initiator", "not an origin") != "not an origin":
            asked.add(seen["url"])
    return done.stdout, asked


@pytest.fixture(scope="module")
def seen(slot_folder, tmp_path_factory):
    """What the probe saw."""
    lines = ("− slot.nc:9: G1 X20", "+ slot.nc:9: G1 X30")
    difference = Difference(kind="motion", lines=lines, old=None, new=("slot.nc", 9))
    both = [Recording.open(slot_folder), Recording.open(slot_folder)]
    page = write_page(both, names=("old", "new"), compared=("1 difference", [difference]))
    document, asked = opened(page.replace("</body>", PROBE), tmp_path_factory.mktemp("browser"))
    found = re.search(r'<pre id="seen">(.*?)</pre>', document)
    assert found is not None, document[-2000:]
    return {**json.loads(html.unescape(found[1])), "asked": asked}


def test_the_page_comes_up_without_an_error(seen):
    assert seen["ready"] == "1" and seen["errors"] == [] and seen["start"] == 0
    assert seen["views"] == 2 and seen["charts"] >= 5 and seen["tables"] >= 5


def test_it_opens_with_part_tool_and_machine_in_view(seen):
    opening = seen["opening"]

    assert 0.05 < opening["part"] < 1.0  # neither lost nor cut off
    assert len(opening["bodies"]) >= 2 and opening["tools"] >= 1  # the tool, and the body that is nearest to its tip
    assert max(opening["bodies"]) < 1.0


def test_columns_of_results_have_words_and_units(seen):
    assert {"mean feed mm/min", "peak torque N·m"} <= {heading.removeprefix("max ") for heading in seen["headings"]}
    assert not [heading for heading in seen["headings"] if re.search(r"_|mm min|Nm|mm\d", heading)]


def test_the_part_is_drawn_and_loses_material_in_time(seen):
    before, half, end, back = seen["cut"]

    assert seen["drawn"] > 20_000  # of a million: the block from above
    assert before < 50 < half < end  # the slot, then the hole as well
    assert back == before  # also backwards


def test_bar_findings_lines_and_play_move_the_time(seen, slot):
    timeline = slot.timeline
    line = timeline.t_ns[timeline.line.tolist().index(9)] * 1e-9

    assert seen["middle"] == pytest.approx(0.5, abs=0.01)
    assert seen["clock"] == "0:09.4"
    assert "G1 Z-2" in seen["now"] or "G1 X" in seen["now"]
    assert seen["finding"] == pytest.approx(timeline.t_ns[timeline.line.tolist().index(13)] * 1e-9, abs=1e-3)
    assert seen["line"] == pytest.approx(line, abs=1e-3)
    assert seen["played"] > seen["line"]


def test_a_difference_leads_to_its_line(seen):
    assert seen["difference"] == pytest.approx(seen["line"], abs=1e-3)
    assert "1 difference" in seen["differences"] and "+ slot.nc:9: G1 X30" in seen["differences"]


def test_nothing_is_asked_of_a_network(seen):
    assert seen["fetched"] == []
    assert not seen["asked"]


def test_a_page_that_asked_would_be_noticed(tmp_path):
    address = "http://127.0.0.1:9/picture.png"

    _, asked = opened(f'<!DOCTYPE html><img src="{address}">', tmp_path)

    assert asked == {address}


def test_what_holds_stands_beside_the_program(seen):
    assert "G54" in seen["modals"] and "G21" in seen["modals"] and "T1" in seen["modals"]
    assert re.search(r"F\s[1-9]", seen["modals"]) and re.search(r"S\s[1-9]", seen["modals"])


def test_the_path_is_coloured_by_what_one_chooses(seen):
    assert "force" in seen["choices"] and "feed" in seen["choices"]
    assert "deviation" not in seen["choices"]  # this machine is where it was told to be
    assert seen["recoloured"] and "force N" in seen["legend"]


def test_a_click_on_path_or_part_leads_to_its_line(seen):
    time, wanted, text = seen["picked"]
    assert time == pytest.approx(wanted, abs=0.3) and "G1 X30" in text
    assert "G1 X30" in seen["worked"][1]


def test_two_clicks_measure_and_a_section_takes_half_away(seen):
    distance = float(re.match(r"([\d.]+) mm", seen["measured"])[1])
    assert distance == pytest.approx(10.0, abs=0.5) and "ΔX" in seen["measured"]
    whole, half, text = seen["section"]
    assert 0 < half < 0.9 * whole and "section at X" in text
    assert seen["unsection"] == whole


def test_rapids_do_not_set_the_scale_of_the_feed(seen):
    shown, whole = seen["feeds"]
    assert shown < 0.7 * whole
