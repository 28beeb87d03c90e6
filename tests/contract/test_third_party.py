"""A package of somebody else, installed beside us, extends gcodesim at every place that `docs/extending.md` names.

It adds a tool with a part and keys of its own, a process with a signal and a column in a unit of its own, a dialect, a
machine, a finding and an exporter, each by one line of its `pyproject.toml`; the real command line then knows them all.
"""

from __future__ import annotations

import csv
import json
import re
import shutil
import subprocess
import sys
from importlib.metadata import PathDistribution
from importlib.util import find_spec
from pathlib import Path

import pytest

from gcodesim.family import Family
from gcodesim.playback import Recording
from gcodesim.report.pack import Pack
from gcodesim.report.page import run_data
from tests.contract.third_party import OURS, PROJECT, SOURCE, Done, add_metadata, gcodesim_with, install

FAMILIES = ("tools", "parts", "processes", "sensors", "dialects", "machines", "findings", "exporters", "controllers")


class Shop:
    """A folder with the example of the package, and the command line that knows it."""

    def __init__(self, site: Path, folder: Path) -> None:
        self.site, self.folder = site, folder

    def __call__(self, *arguments: object) -> Done:
        return gcodesim_with(self.site, self.folder, *arguments)

    def write(self, name: str, old: str, new: str) -> None:
        """Change a file of the example."""
        path = self.folder / name
        text = path.read_text()
        assert old in text
        path.write_text(text.replace(old, new))


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("site")
    install(folder)
    return folder


@pytest.fixture
def shop(site: Path, tmp_path: Path) -> Shop:
    shutil.copytree(SOURCE / "example", tmp_path, dirs_exist_ok=True)
    return Shop(site, tmp_path)


@pytest.fixture(scope="module")
def ran(site: Path, tmp_path_factory: pytest.TempPathFactory) -> tuple[Shop, Done]:
    folder = tmp_path_factory.mktemp("ran")
    shutil.copytree(SOURCE / "example", folder, dirs_exist_ok=True)
    shop = Shop(site, folder)
    return shop, shop("run", "sign.nc", "--cell", "engraver.yaml", "--out", "out")


def test_the_package_adds_to_every_family_by_one_line_each() -> None:
    assert set(PROJECT["entry-points"]) == {f"gcodesim.{name}" for name in FAMILIES}
    assert all(len(points) == 1 for points in PROJECT["entry-points"].values())


@pytest.mark.parametrize(
    ("family", "row"),
    [
        ("tools", "laser_engraver"),
        ("processes", "engraving"),
        ("sensors", "beam_gauge"),
        ("dialects", "bright"),
        ("machines", "bright_table          Bright engraving table"),
        ("codes", "ENGRAVER-101  warning  The beam burns during a rapid move"),
        ("controllers", "steady"),
        ("exporters", "doses    place of the tip [mm] and dose [J/mm^2], one line for each sample with the beam on"),
    ],
)
def test_list_has_its_newcomers(shop: Shop, family: str, row: str) -> None:
    assert row in shop("list", family).out.splitlines()


def test_cell_show_and_schema_have_its_keys(shop: Shop) -> None:
    shown = shop("cell", "show", "engraver.yaml").out
    schema = shop("cell", "schema").json

    assert "type: laser_engraver" in shown and "full_speed: 1000 rpm" in shown and "focus: 2 mm  # default" in shown
    assert schema["$defs"]["laser_engraver"]["properties"]["power"]["description"] == "power of the beam"
    assert "bright" in json.dumps(schema)


def test_its_keys_are_checked_as_ours(shop: Shop) -> None:
    shop.write("engraver.yaml", "power: 40 W", "power: 40 mm")
    done = shop("cell", "validate", "engraver.yaml")

    assert done.status == 1
    assert "engraver.yaml:9:36: error GS709: `power` is 40 mm, a length; a power such as `40 W` is expected" in done.out


def test_its_dialect_reads_the_program(shop: Shop) -> None:
    shop.write("sign.nc", "(the beam burns a line, then another)", "(the beam burns a line, and then another one)")

    assert (
        "sign.nc:1:41: error GS002: the line has 45 characters; 40 are allowed"
        in shop("lint", "sign.nc", "--dialect", "bright").out
    )


def test_run_knows_its_process_its_column_and_its_finding(ran: tuple[Shop, Done]) -> None:
    shop, done = ran
    results = json.loads((shop.folder / "out" / "results.json").read_text())
    (tool,) = results["tools"]
    with (shop.folder / "out" / "lines.csv").open() as file:
        (line,) = [row for row in csv.DictReader(file) if row["line"] == "8"]

    assert done.status == 0
    assert "sign.nc:9:1: warning ENGRAVER-101: T1 burns" in done.out
    assert "greatest dose" in done.out and "J/mm²" in done.out
    assert [finding["code"] for finding in results["findings"]] == ["ENGRAVER-101"]
    assert float(line["burnt_energy_J"]) == pytest.approx(16.0, rel=0.01)  # 80 % of 20 W for 1 s
    assert float(line["removed_mm3"]) == pytest.approx(20.0 * 0.4 * (0.3 + 0.1), rel=0.1)  # 2 mm - 1.7 mm, and Q
    assert 2.5 <= float(line["max_dose_J_mm2"]) <= 2.7  # 20 W / (20 mm/s · 0.4 mm), more while it slows down
    assert tool["max_dose_J_mm2"] >= float(line["max_dose_J_mm2"])


def test_a_word_that_the_cell_names_sets_its_signal(shop: Shop) -> None:
    """`per` scales it; without the entry it has its default, and the word is told as not simulated."""

    def burnt() -> tuple[float, str]:
        done = shop("run", "sign.nc", "--cell", "engraver.yaml", "--out", "out")
        with (shop.folder / "out" / "lines.csv").open() as file:
            return next(float(row["removed_mm3"]) for row in csv.DictReader(file) if row["line"] == "8"), done.out

    shop.write("engraver.yaml", "per: 1 mm", "per: 2 mm")
    assert "signals:\n  lowered:\n    word: M67 E0\n    per: 2 mm\n" in shop("cell", "show", "engraver.yaml").out
    assert burnt()[0] == pytest.approx(20.0 * 0.4 * (0.3 + 0.2), rel=0.1)
    shop.write("engraver.yaml", "signals: {lowered: {word: M67 E0, per: 2 mm}}\n", "")
    removed, said = burnt()
    assert removed == pytest.approx(20.0 * 0.4 * 0.3, rel=0.1)
    assert "sign.nc:7:1: note GS904: M67 E0 is read, but not simulated" in said
    shop.write("engraver.yaml", "tools:\n", "signals: {lowered: {word: M67 E0, per: 1 W}}\ntools:\n")
    assert (
        "7:40: error GS709: `per` is 1 W; the signal `lowered` is in m" in shop("cell", "validate", "engraver.yaml").out
    )


def test_its_exporter_writes_the_doses(ran: tuple[Shop, Done]) -> None:
    shop, _ = ran
    rows = [row.split() for row in shop("export", "out", "--to", "doses", "--lines", "8:8").out.splitlines()]
    written = shop("export", "out", "--to", "doses", "-o", "d.txt", "--period", "0.1")

    assert float(rows[len(rows) // 2][3]) == pytest.approx(2.5, rel=1e-6)
    assert {row[2] for row in rows} == {"-138.300"}
    assert written.out == f"wrote {len((shop.folder / 'd.txt').read_text().splitlines())} doses into d.txt\n"
    assert shop("export", "out", "--to", "doses", "--at", "1").err.endswith("--at means nothing for doses\n")
    assert "csv, doses, glb, " in shop("export", "out", "--to", "tea").err


def test_a_robot_has_its_controller(shop: Shop) -> None:
    """The cut bends an arm with it by less than one whose motors do not know of the force."""
    (shop.folder / "arm.yaml").write_text(
        "gcodesim: 1\nrobots: {arm: {model: ur10e, controller: {type: steady, share: 90 %}}}\n"
        "frames: {table: {in: world, xyz: [700, 0, 200]}}\nwork_offsets: {G54: {in: table}}\n"
        "stock: {box: [40, 20, 10], in: table, zero: top-front-left, material: al6082_t6, resolution: 1}\n"
        "tools:\n  1: {type: flat_end_mill, diameter: 6, flutes: 2, length: 40}\n"
    )
    (shop.folder / "slot.nc").write_text(
        "G21 G90 T1 M6\nG43 H1 S9000 M3\nG0 X-6 Y10 Z5\nG0 Z-1\nG1 X10 F600\nG0 Z20\nM5\nM2\n"
    )
    done = shop("cell", "show", "arm.yaml")
    assert "type: steady" in done.out and "share: 0.9" in done.out, done.err

    off = []
    for kind in ("steady, share: 90 %", "flexible"):
        shop.write("arm.yaml", "steady, share: 90 %", kind)
        done = shop(
            "run",
            "slot.nc",
            "--cell",
            "arm.yaml",
            "--world",
            "kinematic",
            "--out",
            "out",
            "--force",
            "--format",
            "json",
        )
        off.append(done.json["path_accuracy"]["rms_mm"])
    assert off[0] < 0.85 * off[1]


def test_other_views_of_the_run_have_its_column(ran: tuple[Shop, Done]) -> None:
    shop, _ = ran
    table = shop("export", "out", "--to", "csv").out.partition("\n")[0].split(",")
    report = shop("report", "out", "-o", "run.html")
    page = run_data(Recording.open(shop.folder / "out"), "run", Pack())  # here, where nobody knows the package

    assert "process.dose_j_mm2" in table
    assert report.status == 0 and report.out.startswith("wrote run.html")
    assert [finding["code"] for finding in page["findings"]] == ["ENGRAVER-101"]
    assert "Burnt energy j" in {chart["title"] for chart in page["charts"]}
    assert "ENGRAVER-101" in shop("info", "out").out


def test_explain_and_the_checks_of_a_cell_know_its_code(shop: Shop) -> None:
    assert shop("explain", "engraver-101").out.startswith(
        "ENGRAVER-101: The beam burns during a rapid move (warning)\n\n  A rapid move leads across"
    )
    with (shop.folder / "engraver.yaml").open("a") as cell:
        cell.write("checks: {engraver-1xx: error}\n")
    done = shop("run", "sign.nc", "--cell", "engraver.yaml", "--format", "json")

    assert done.status == 1
    assert [(finding["code"], finding["severity"]) for finding in done.json["findings"]] == [("ENGRAVER-101", "error")]
    shop.write("engraver.yaml", "engraver-1xx", "engraver-2xx")
    assert "no finding of this version has the code ENGRAVER-2xx" in shop("cell", "validate", "engraver.yaml").out


def test_its_code_can_be_suppressed(shop: Shop) -> None:
    with (shop.folder / "engraver.yaml").open("a") as cell:
        cell.write("suppress: [{code: ENGRAVER-101, program: sign.nc, line: 9, reason: it is wanted}]\n")

    assert "ENGRAVER-101" not in shop("run", "sign.nc", "--cell", "engraver.yaml").out


def test_suites_expect_accept_and_report_its_finding(shop: Shop) -> None:
    first = shop("test", ".", "--sarif", "found.sarif")
    accepted = shop("accept", ".")
    again = shop("test", ".")

    assert first.out == "none failed, 1 passed, 1 finding expected, 1 without accepted results (`gcodesim accept`)\n"
    assert accepted.status == 0 and "accepting sign.golden.json for the first time" in accepted.out
    assert again.out == "none failed, 1 passed, 1 finding expected\n"
    assert "max_dose_J_mm2" in (shop.folder / "sign.golden.json").read_text()
    rules = json.loads((shop.folder / "found.sarif").read_text())["runs"][0]["tool"]["driver"]["rules"]
    assert rules[-1]["id"] == "ENGRAVER-101" and rules[-1]["properties"]["tags"] == ["engraver"]


def test_a_suite_remembers_nothing_of_another_version_of_the_package(tmp_path: Path) -> None:
    own = tmp_path / "site"
    install(own)
    shutil.copytree(SOURCE / "example", tmp_path / "example")
    shop = Shop(own, tmp_path / "example")
    shop("test", ".", "--changed")
    assert "unchanged" in shop("test", ".", "--changed").out

    process = own / "bright_engraver" / "process.py"
    process.write_text(process.read_text().replace("rows.events(burnt > 0.0)", "rows.events(burnt > 1.0)"))

    assert "ENGRAVER-101 is expected in line 9, and did not come" in shop("test", ".", "--changed").out


BROKEN = {
    "is not there": ("tools", "away", "no_such_module:Tool", "ModuleNotFoundError: No module named 'no_such_module'"),
    "has no such name": ("tools", "away", "math:Tool", "AttributeError: module 'math' has no attribute 'Tool'"),
    "is something else": ("tools", "away", "math:pi", "which is no Tool"),
    "has another name": ("tools", "away", "bright_engraver.tool:Engraver", "whose `kind` is `laser_engraver`"),
}


@pytest.mark.parametrize(("family", "name", "place", "words"), BROKEN.values(), ids=BROKEN)
def test_what_is_broken_names_its_package(
    site: Path, tmp_path: Path, family: str, name: str, place: str, words: str
) -> None:
    own = tmp_path / "site"
    shutil.copytree(site, own)
    add_metadata(own, "shaky", "0.1", {f"gcodesim.{family}": {name: place}})
    shutil.copytree(SOURCE / "example", tmp_path, dirs_exist_ok=True)
    shop = Shop(own, tmp_path)
    fine = shop("cell", "validate", "engraver.yaml")
    shop.write("engraver.yaml", "type: laser_engraver", "type: away")
    done = shop("cell", "validate", "engraver.yaml")

    assert fine.status == 0  # it hurts nobody who does not use it
    assert done.status == 2
    said = f"gcodesim: the package shaky 0.1 adds `away` to `gcodesim.tools` as `{place}`, "
    assert done.err.startswith(said) and words in done.err
    assert len(done.err.splitlines()) == 1


def test_a_case_of_a_suite_that_needs_what_is_broken_says_so(site: Path, tmp_path: Path) -> None:
    own = tmp_path / "site"
    shutil.copytree(site, own)
    (own / "bright_engraver" / "process.py").write_text("raise RuntimeError('out of\\nlight')\n")
    shutil.copytree(SOURCE / "example", tmp_path, dirs_exist_ok=True)
    done = Shop(own, tmp_path)("test", ".")

    assert "the package bright-engraver 1.2 adds `engraving` to `gcodesim.processes`" in done.out
    assert "which cannot be loaded: RuntimeError: out of light" in done.out


def test_a_fault_in_its_code_is_not_ours(site: Path, tmp_path: Path) -> None:
    own = tmp_path / "site"
    shutil.copytree(site, own)
    process = own / "bright_engraver" / "process.py"
    process.write_text(process.read_text().replace("        kept = np.exp(-passed)\n", "        kept = {}['kept']\n"))
    shutil.copytree(SOURCE / "example", tmp_path, dirs_exist_ok=True)
    shop = Shop(own, tmp_path)
    run, suite = shop("run", "sign.nc", "--cell", "engraver.yaml", "--out", "out"), shop("test", ".")

    assert run.status == suite.status == 70
    assert "This is a fault of the package bright-engraver 1.2, which extends gcodesim, not of your program" in run.err
    assert "Please report it to its authors with the text above" in run.err
    assert "this is a fault of the package bright-engraver 1.2; please report it" in suite.out


def test_two_packages_with_one_name_are_told(site: Path, tmp_path: Path) -> None:
    own = tmp_path / "site"
    shutil.copytree(site, own)
    add_metadata(own, "other-engraver", "3.0", {"gcodesim.tools": {"laser_engraver": "other:Engraver"}})
    shutil.copytree(SOURCE / "example", tmp_path, dirs_exist_ok=True)
    done = Shop(own, tmp_path)("cell", "validate", "engraver.yaml")

    assert done.status == 2
    assert done.err == (
        "gcodesim: the package bright-engraver 1.2 and the package other-engraver 3.0 both add `laser_engraver` to "
        "`gcodesim.tools`; one of them has to go\n"
    )


def test_codes_of_others_have_the_name_of_their_package(site: Path, tmp_path: Path) -> None:
    own = tmp_path / "site"
    shutil.copytree(site, own)
    findings = own / "bright_engraver" / "findings.py"
    findings.write_text(findings.read_text().replace('"ENGRAVER-101"', '"GS101"'))
    done = Shop(own, tmp_path)("list", "codes")

    assert done.status == 2
    assert "the findings `engraver` of another package have the code GS101; theirs are `ENGRAVER-` and" in done.err


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("Severity.WARNING", '"warning"', "`severity` of ENGRAVER-101 is 'warning'; it has to be one of `Severity`"),
        ('why="', 'why=3, remedy="', "`why` of ENGRAVER-101 is 3; it has to be a text"),
        ("CODES = (", "CODES = {}; _ = (", "are no list of `Code`"),
    ],
)
def test_a_fault_in_codes_of_others_is_told_as_theirs(
    site: Path, tmp_path: Path, old: str, new: str, says: str
) -> None:
    own = tmp_path / "site"
    shutil.copytree(site, own)
    findings = own / "bright_engraver" / "findings.py"
    text = findings.read_text().replace(old, new)
    if "remedy" in new:
        text = "\n".join(line for line in text.splitlines() if not line.lstrip().startswith("remedy="))
    findings.write_text(text)
    for words in (("explain", "ENGRAVER-101"), ("list", "codes")):
        done = Shop(own, tmp_path)(*words)
        assert (done.status, says in done.err, "Traceback" in done.err) == (2, True, False)


@pytest.mark.skipif(find_spec("setuptools") is None, reason="needs setuptools")
def test_an_installer_makes_the_same_of_it(tmp_path: Path) -> None:
    source, own = tmp_path / "source", tmp_path / "site"
    shutil.copytree(SOURCE, source)
    steps = ["build_py", "install_lib", "--install-dir", str(own), "install_egg_info", "--install-dir", str(own)]
    command = [sys.executable, "-c", "from setuptools import setup; setup()", *steps]
    done = subprocess.run(command, cwd=source, capture_output=True, text=True, check=False)

    assert done.returncode == 0, done.stderr
    (metadata,) = own.glob("*.egg-info")
    found = {(p.group, p.name, p.value) for p in PathDistribution(metadata).entry_points}
    groups = PROJECT["entry-points"].items()
    assert found == {(group, name, place) for group, points in groups for name, place in points.items()}
    shutil.copytree(SOURCE / "example", tmp_path, dirs_exist_ok=True)
    assert Shop(own, tmp_path)("check", "sign.nc", "--cell", "engraver.yaml").status == 0


def test_asking_whether_a_name_is_there_imports_nothing() -> None:
    family = Family("nothing", there="no_such_module:Name")

    assert "there" in family and "elsewhere" not in family and list(family) == ["there"]


def test_the_docs_name_the_line_of_each_family() -> None:
    table = (OURS / "docs" / "extending.md").read_text(encoding="utf-8")

    for group in PROJECT["entry-points"]:
        (row,) = [line for line in table.splitlines() if line.startswith("|") and line.endswith(f"`{group}` |")]
        name, place = re.fullmatch(r"`(\w+)` in `([\w/.]+)`.*", row.split("|")[3].strip()).groups()
        assert re.search(rf"^{name}\b", (OURS / place).read_text(encoding="utf-8"), re.MULTILINE), row
