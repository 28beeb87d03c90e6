"""The page of a sweep in a real browser: it draws, filters and sorts, and asks no network for anything."""

from __future__ import annotations

import base64
import html
import json
import re
import subprocess
import zlib
from pathlib import Path

import pytest

from gcodesim.diagnostics import SourceText
from gcodesim.sweep.page import write_page
from gcodesim.sweep.prepared import Allowed, Prepared, prepared
from gcodesim.sweep.row import Cell, headings
from gcodesim.sweep.study_file import read_study
from scripts import chromium

PROBE = """<script>
(async () => {
  const seen = { errors: [] };
  window.addEventListener("error", (event) => seen.errors.push(String(event.message)));
  for (let i = 0; i < 200 && !document.body.dataset.ready; i++) await new Promise((done) => setTimeout(done, 25));
  const numbers = () => [...document.querySelectorAll("#table tr")].slice(1).map((row) => row.cells[0].textContent);
  seen.head = document.getElementById("head").innerText;
  seen.links = [...document.querySelectorAll("#head a")].map((link) => link.getAttribute("href"));
  seen.dots = document.querySelectorAll("#scatter circle").length;
  seen.failing = document.querySelectorAll("#scatter circle.fail").length;
  seen.responses = document.querySelectorAll("#responses svg").length;
  const heads = [...document.querySelectorAll("th")];
  const force = heads.find((cell) => cell.textContent.startsWith("force_N"));
  force.click();
  [...document.querySelectorAll("th")].find((cell) => cell.textContent.startsWith("force_N")).click();
  seen.sorted = numbers();
  const from = document.querySelector('input[aria-label="a_mm from"]');
  from.value = "7";
  from.dispatchEvent(new Event("change"));
  seen.filtered = numbers();
  document.querySelector("#table tr:nth-child(2)").click();
  seen.chosen = document.querySelectorAll("circle.on").length;
  seen.markup = document.querySelectorAll("main img").length;
  const out = document.createElement("pre");
  out.id = "seen";
  out.textContent = JSON.stringify(seen);
  document.body.append(out);
})();
</script>"""


@pytest.fixture
def ready(tmp_path: Path) -> Prepared:
    for name, text in (("a.nc", "M2\n"), ("c.yaml", "machine: gantry_xyz\n")):
        (tmp_path / name).write_text(text)
    path = tmp_path / "study.yaml"
    path.write_text(
        "program: a.nc\ncell: c.yaml\nvary: {a: {key: simulation.x, values: [6, 8 mm]}, b: [x, y]}\nfail: force > 2 N\n"
    )
    file = read_study(SourceText.read(path), path)
    assert file.study is not None
    study = file.study
    ready, _ = prepared(file, type(study)(**{**_fields(study), "vary": {}, "options": study.options}), Allowed())
    assert ready is not None
    return type(ready)(**{**_fields(ready), "study": study})


def _fields(value: object) -> dict[str, object]:
    return {name: getattr(value, name) for name in value.__dataclass_fields__}  # type: ignore[attr-defined]


def rows(ready: Prepared) -> list[list[Cell]]:
    """Four runs; the text of one would be a picture, if it were put in as markup."""
    made = []
    for number, (a, b, force) in enumerate([(6, "x", 1.0), (6, "y", 4.0), (8, "x", 3.0), (8, "<img src=q>", None)]):
        cells: dict[str, Cell] = {"run": number, "a_mm": a, "b": b, "force_N": force, "status": "ok", "codes": ""}
        cells["verdict"] = "fail" if force is not None and force > 2.0 else "ok"
        made.append([cells.get(head.name, "" if head.kind == "text" else None) for head in headings(ready)])
    return made


def test_equal_rows_give_equal_bytes_and_nothing_is_fetched(ready: Prepared):
    pages = [write_page(ready, headings(ready), rows(ready), {0: "runs/x/report.html"}, "force_N", 4) for _ in range(2)]

    assert pages[0] == pages[1]
    assert "http" not in pages[0].replace("http-equiv", "").replace("http://www.w3.org/2000/svg", "")
    assert "<img" not in pages[0]


def test_of_very_many_rows_some_are_shown(ready: Prepared):
    head = headings(ready)
    page = write_page(ready, head, ([n, *[None] * (len(head) - 1)] for n in range(50_000)), {}, "force_N", 50_000)
    index = re.search(r'id="index">(.*?)<', page)
    assert index is not None
    content = json.loads(zlib.decompress(base64.b64decode(index[1])))

    assert content["apart"] == 3
    assert [row[0] for row in content["rows"][:3]] == [0, 3, 6]


@pytest.mark.skipif(chromium.PROGRAM is None, reason="no chromium here")
def test_it_draws_filters_and_sorts(ready: Prepared, tmp_path: Path):
    page = write_page(ready, headings(ready), rows(ready), {1: "runs/x/report.html"}, "force_N", 4)
    (tmp_path / "page.html").write_text(page.replace("</body>", f"{PROBE}</body>"), encoding="utf-8")

    done = subprocess.run(
        [str(chromium.PROGRAM), *chromium.ALONE, "--dump-dom", f"file://{tmp_path / 'page.html'}"],
        capture_output=True,
        timeout=600,
        check=False,
    )
    found = re.search(r'<pre id="seen">(.*?)</pre>', done.stdout.decode(), re.DOTALL)
    assert found is not None, done.stderr[-2000:]
    seen = json.loads(html.unescape(found[1]))

    assert seen["errors"] == []
    assert "4 runs" in seen["head"] and "2 fail" in seen["head"] and "fails if force > 2 N" in seen["head"]
    assert seen["links"] == ["runs/x/report.html"]
    assert (seen["dots"], seen["failing"], seen["responses"]) == (3, 2, 2)
    assert seen["sorted"] == ["run 1", "2", "0", "3"]
    assert seen["filtered"] == ["2", "3"]
    assert seen["chosen"] >= 1
    assert seen["markup"] == 0
