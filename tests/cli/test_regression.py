"""`test`, `accept` and `diff` as users meet them: scenarios 5 and 7."""

from __future__ import annotations

import base64
import json
import re
import zlib
from pathlib import Path

import pytest

PART = """G21 G90 G17 G94
T2 M6
G43 H2
S6000 M3
G0 X50 Y30
G0 Z2
G1 Z-5 F200
G0 Z20
M5
M2
"""
RENUMBERED = "(another post)\n" + "".join(f"n{10 * i} {line.lower()} ; x\n" for i, line in enumerate(PART.splitlines()))


@pytest.fixture(autouse=True)
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("GCODESIM_TEST_CACHE", str(tmp_path / "cache"))


def test_a_renumbered_program_is_the_same(cli, write) -> None:
    for name, text in (("old", PART), ("new", RENUMBERED)):
        write("part.nc", text)
        assert cli("run", "part.nc", "--cell", "cell.yaml", "--out", name).status == 0
    done = cli("diff", "old", "new")
    assert (done.status, done.out) == (0, "no difference in motion or result\n")
    assert cli("diff", "old/run.mcap", "new/run.mcap").status == 0


def test_a_deeper_plunge(cli, write) -> None:
    """0.4 mm deeper with 10 mm: pi/4 · 10² · 0.4 = 31.4 mm³ more, and 0.4 mm / 200 mm/min = 0.12 s of feed."""
    cell = Path("cell.yaml").read_text().replace("resolution: 1", "resolution: 0.2")
    write("fine.yaml", cell)
    write("old.nc", PART)
    write("new.nc", PART.replace("Z-5", "Z-5.4"))
    done = cli("diff", "old.nc", "new.nc", "--cell", "fine.yaml")
    assert done.status == 1
    assert "old.nc:7: G1 Z-5 F200" in done.out and "new.nc:7: G1 Z-5.4 F200" in done.out
    assert "Z −5 → −5.4 mm" in done.out
    removed = re.search(r"stocks\.stock\.removed_mm3: .* \(\+([\d.]+); tolerance `volume` allows", done.out)
    assert removed and float(removed[1]) == pytest.approx(31.4, abs=0.3)
    assert re.search(r"time\.feed_s: .*\(\+0\.12; tolerance `time` allows", done.out)
    assert "0.4 mm off at X" in done.out and "broken tolerances: position" in done.out
    value = cli("diff", "old.nc", "new.nc", "--cell", "fine.yaml", "--format", "json").json
    assert value["same"] is False and "Z" in value["quantities"] and "volume" in value["broken_tolerances"]
    page = cli("diff", "old.nc", "new.nc", "--cell", "fine.yaml", "--format", "markdown").out
    assert "| `stocks.stock.removed_mm3` |" in page and "```diff\n- old.nc:7" in page


def test_a_page_of_both_runs(cli, write) -> None:
    write("old.nc", PART)
    write("new.nc", PART.replace("Z-5", "Z-5.4"))
    done = cli("diff", "old.nc", "new.nc", "--cell", "cell.yaml", "--html", "page.html")
    assert done.status == 1 and "wrote page.html" in done.err
    page = Path("page.html").read_text()
    index = re.search(r'id="index">([^<]*)<', page)
    content = json.loads(zlib.decompress(base64.b64decode(index[1])))
    assert [run["program"] for run in content["runs"]] == ["old.nc", "new.nc"]
    assert content["compared"]["summary"] == done.out.splitlines()[-1]
    moved = next(one for one in content["compared"]["differences"] if one["kind"] == "motion")
    assert moved["lines"][:2] == ["− old.nc:7: G1 Z-5 F200", "+ new.nc:7: G1 Z-5.4 F200"]
    assert (moved["old"], moved["new"]) == (["old.nc", 7], ["new.nc", 7])
    assert cli("diff", "old.nc", "new.nc", "--html", "none.html").status == 2  # nothing ran
    assert not Path("none.html").exists()


def test_all_that_can_be_compared_with_all(cli, write) -> None:
    """A folder, its log, its results, accepted results and the program in the cell are one and the same run."""
    write("part.nc", PART)
    write("part.test.yaml", "cell: cell.yaml\n")
    assert cli("run", "part.nc", "--cell", "cell.yaml").status == cli("accept").status == 0
    sides = ("out", "out/run.mcap", "out/results.json", "part.golden.json", "part.nc")
    for new in sides:
        done = cli("diff", "out", new, "--cell", "cell.yaml")
        assert done.status == 0 and done.out.endswith("no difference in motion or result\n"), new
    # positions of a program alone mean nothing on a machine
    for old, new in (("out", "part.nc"), ("part.nc", "part.golden.json")):
        done = cli("diff", old, new)
        assert done.status == 2 and "name that with --cell" in done.err


def test_a_log_without_its_end_is_not_the_same(cli, write) -> None:
    write("part.nc", PART)
    cli("run", "part.nc", "--cell", "cell.yaml")
    whole = Path("out/run.mcap").read_bytes()
    write("cut.mcap", whole[: len(whole) * 2 // 3])
    done = cli("diff", "out/run.mcap", "cut.mcap")
    assert done.status == 1 and "status: ok → incomplete" in done.out
    assert "cut.mcap has no results: only its program is compared" in done.out


def test_folders_of_programs(cli, write, tmp_path: Path) -> None:
    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()
    write("a/one.nc", PART)
    write("b/one.nc", RENUMBERED)
    assert "no difference in motion or result, in 1 program" in cli("diff", "a", "b").out
    write("b/two.nc", PART)
    done = cli("diff", "a", "b")
    assert done.status == 1 and "two.nc: only in the new folder" in done.out


def test_accepting_shows_what_differs_and_then_it_passes(cli, write) -> None:
    write("part.nc", PART)
    write("part.test.yaml", "cell: cell.yaml\n")
    assert "part: accepting part.golden.json for the first time" in cli("accept").out
    done = cli("test")
    assert done.status == 0 and done.out == "none failed, 1 passed\n"
    write("part.nc", PART.replace("Z-5", "Z-5.4"))
    failed = cli("test")
    assert failed.status == 1 and "part.nc:7:1: error GS603: line changed: Z −5 → −5.4 mm" in failed.out
    golden = Path("part.golden.json").read_bytes()
    dry = cli("accept", "--dry-run")
    assert "would accept" in dry.out and Path("part.golden.json").read_bytes() == golden
    told = cli("accept", "--dry-run", "--format", "json").json
    assert told["dry_run"] and told["findings"] == [] and [case["accepted"] for case in told["cases"]] == [True]
    taken = cli("accept")
    assert "Z −5 → −5.4 mm" in taken.out and "stocks.stock.removed_mm3" in taken.out
    assert taken.out.replace("accepting", "would accept").splitlines()[:-1] == dry.out.splitlines()[:-1]
    assert cli("test").status == 0
    assert cli("accept").out == "0 accepted, 1 as before, 0 not accepted\n"


def test_a_dropped_m3_fails_and_its_repair_passes(cli, write) -> None:
    write("part.nc", PART)
    write("part.test.yaml", "cell: cell.yaml\n")
    cli("accept")
    write("part.nc", PART.replace(" M3", ""))
    done = cli("test", "--format", "json")
    assert done.status == 1
    found = done.json["cases"][0]["findings"]
    assert ("GS501", "part.nc", 7) in [(f["code"], f["file"], f["line"]) for f in found if f["state"] == "counts"]
    assert cli("test", "--fail-on", "never").status == 0
    write("part.nc", PART)
    assert cli("test", "--changed").status == 0
    assert cli("test", "--changed").out == "none failed, 1 passed (1 unchanged)\n"


def test_a_baseline_of_a_run(cli, write) -> None:
    write("part.nc", PART.replace(" M3", ""))
    arguments = ("run", "part.nc", "--cell", "cell.yaml")
    assert cli(*arguments).status == 1
    assert cli(*arguments, "--write-baseline", "known.json").status == 0
    done = cli(*arguments, "--baseline", "known.json")
    assert done.status == 0 and "in the baseline, not shown" in done.out
    write("part.nc", PART)
    assert "gone from the baseline: part.nc: GS501" in cli(*arguments, "--baseline", "known.json").out


@pytest.mark.parametrize(
    "arguments",
    [
        ("test", "absent"),
        ("test", "--cell", "absent.yaml"),
        ("test", "-k", "nothing"),
        ("test", "--baseline", "cell.yaml", "slot.nc", "--cell", "cell.yaml"),
        ("test", "--today", "soon"),
        ("diff", "slot.nc", "absent.nc"),
        ("diff", "slot.nc", "slot.nc", "--tolerance", "weight=1"),
        ("diff", "slot.nc", "slot.nc", "--tolerance", "volume=1 mm"),
        ("run", "slot.nc", "--cell", "cell.yaml", "--baseline", "absent.json"),
    ],
)
def test_wrong_usage(cli, arguments: tuple[str, ...]) -> None:
    done = cli(*arguments)
    assert done.status == 2 and "Traceback" not in done.err


@pytest.mark.parametrize(
    "harm", [{"time": None}, {"tools": {"a": 1}}, {"stocks": {"stock": 3}}, {"findings": [7]}, {"status": ...}]
)
def test_results_without_a_part_are_not_equal_to_anything(cli, write, harm) -> None:
    write("part.nc", PART)
    cli("run", "part.nc", "--cell", "cell.yaml")
    whole = json.loads(Path("out/results.json").read_bytes())
    kept = {key: value for key, value in (whole | harm).items() if value is not ...}
    write("odd.json", json.dumps(kept))
    done = cli("diff", "odd.json", "out/results.json")
    assert done.status == 2 and "holds no results of gcodesim" in done.err and f"`{next(iter(harm))}`" in done.err


def test_a_diff_without_end_is_shown_in_part(cli, write) -> None:
    lines = [f"G1 X{i % 7} Y{i % 11}" for i in range(900)]
    write("old.nc", "G21 G90\nF500\n" + "\n".join(lines) + "\nM2\n")
    write(
        "new.nc",
        "G21 G90\nF500\n" + "\n".join(line if i % 2 else line + f" Z{i}" for i, line in enumerate(lines)) + "\nM2\n",
    )
    text, value = cli("diff", "old.nc", "new.nc").out, cli("diff", "old.nc", "new.nc", "--format", "json").json
    more = len(value["moves"]) - 200
    assert more > 0 and f"  … and {more} more; `--format json` has all\n" in text and text.count("\n") < 2000
