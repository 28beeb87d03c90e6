"""`gcodesim info LOG`: what a log is, for people and for programs, and what is missing of one that was cut off."""

import json

import pytest

HEAD = "G21 G90 G17 G94\nT1 M6\nG43 H1\nS8000 M3\n"
PROGRAM = HEAD + "G0 X10 Y10\nG0 Z2\nG1 Z-1 F100\nG1 X30\nG0 X60\nM5\nG1 X70\nM2\n"


@pytest.fixture
def log(cli, write, tmp_path):
    write("part.nc", PROGRAM)
    assert cli("run", "part.nc", "--cell", "cell.yaml").status == 1
    return tmp_path / "out" / "run.mcap"


def test_a_person_reads_what_it_is_and_what_was_found(cli, log):
    said = cli("info", "out/run.mcap")

    assert said.status == 0
    first, *rest = said.out.splitlines()
    assert first.startswith("out/run.mcap: finished, with 2 errors")
    told = dict(line.strip().split("  ", 1) for line in rest if line.startswith("  ") and "  " in line.strip())
    assert told["program"].strip() == "part.nc" and told["cell"].strip() == "cell.yaml"
    assert told["steps"].strip() == "4 ms; every 20 ms in the log"
    assert any("error GS401 part.nc:9: rapid move of T1 takes" in line for line in rest)
    assert any("error GS501 part.nc:11: T1 feeds through" in line for line in rest)


def test_a_program_gets_the_same_as_json(cli, log):
    facts = cli("info", "out/run.mcap", "--format", "json").json
    results = json.loads((log.parent / "results.json").read_text())

    assert facts["schema"] == "gcodesim-info/1"
    assert (facts["file"], facts["complete"], facts["state"]) == ("run.mcap", True, "finished")
    assert facts["missing"] == [] and facts["problem"] is None and facts["stopped_at"] is None
    assert facts["duration_s"] == pytest.approx(results["time"]["total_s"], abs=0.004)
    assert facts["bytes"] == log.stat().st_size
    assert facts["run"]["program_sha256"] == results["inputs"]["program"]["sha256"]
    assert sorted((f["code"], f["line"]) for f in facts["findings"]) == sorted(
        (f["code"], f["line"]) for f in results["findings"]
    )
    topics = {topic["name"]: topic for topic in facts["topics"]}
    assert topics["/tf"]["count"] == topics["/wrench"]["count"] > 100
    assert topics["/tf"]["rate_Hz"] == pytest.approx(50, rel=0.02)
    assert {"name": "program.nc", "bytes": len(PROGRAM)} in facts["attachments"]


def test_what_is_missing_of_a_log_that_was_cut_off_is_named(cli, log, tmp_path):
    whole = log.read_bytes()
    (tmp_path / "cut.mcap").write_bytes(whole[: len(whole) * 2 // 3])
    facts = cli("info", "cut.mcap", "--format", "json").json
    complete = cli("info", "out/run.mcap", "--format", "json").json

    assert not facts["complete"] and facts["state"] == "running"
    assert facts["verdict"] == f"incomplete, stopped at part.nc:{facts['stopped_at']['line']}"
    assert 0.0 < facts["duration_s"] < complete["duration_s"]
    line = facts["stopped_at"]["line"]
    assert f"what came after {facts['duration_s']:.3f} s, in or after part.nc:{line}" in facts["missing"]
    assert {"the index", "the result", "results.json"} <= set(facts["missing"])
    assert any("hold no whole record" in text for text in facts["missing"])
    assert {"program.nc", "cell.yaml", "layout.json"} <= {a["name"] for a in facts["attachments"]}
    said = cli("info", "cut.mcap").out
    assert said.startswith("cut.mcap: incomplete, stopped at part.nc:")
    assert all(f"  missing     {text}" in said for text in facts["missing"])


def test_a_layout_of_any_kind_comes_out_of_the_log(cli, log, tmp_path):
    own = cli("info", "out/run.mcap", "--layout").json
    assert cli("info", "out/run.mcap", "--extract", "inside").status == 0
    assert own == json.loads((tmp_path / "inside" / "layout.json").read_text())
    assert cli("info", "out/run.mcap", "--layout", "milling").json == own

    other = cli("info", "out/run.mcap", "--layout", "robot").json
    assert "Plot!efforts" in other["configById"] and "Plot!efforts" not in own["configById"]
    joints = [path["value"] for path in other["configById"]["Plot!joints"]["paths"]]
    assert joints == [f'/motion.joints[:]{{name=="machine/{axis}"}}.position_shown' for axis in "XYZ"]
    cameras = [layout["configById"]["3D!cell"]["cameraState"] for layout in (own, other)]
    assert cameras[0] == cameras[1]

    wrong = cli("info", "out/run.mcap", "--layout", "turning")
    assert wrong.status == 2 and "there are milling, robot, process" in wrong.err


@pytest.mark.parametrize("name", ["none.mcap", "cell.yaml"])
def test_what_is_no_log_is_wrong_usage(cli, name):
    said = cli("info", name)
    assert said.status == 2 and said.out == "" and name in said.err


def test_results_that_are_nested_too_deeply_are_refused(cli, tmp_path) -> None:
    (tmp_path / "results.json").write_text("[" * 100_000 + "]" * 100_000)
    (tmp_path / "run.mcap").write_bytes(b"")
    done = cli("diff", tmp_path / "results.json", tmp_path / "results.json")
    assert done.status == 2 and "Traceback" not in done.err
