"""`export`, `plot` and `report` as a user types them."""

import json

import pytest

from gcodesim.cli import main


@pytest.fixture
def run(slot_folder, tmp_path, monkeypatch, capsys):
    """A command about the finished run, in a fresh folder."""
    monkeypatch.chdir(tmp_path)

    def run(command, *arguments, log=slot_folder):
        capsys.readouterr()
        try:
            status = main([command, str(log), *map(str, arguments)])
        except SystemExit as end:  # argparse
            status = end.code
        said = capsys.readouterr()
        return status, said.out, said.err

    return run


def test_tables_go_to_the_standard_output_or_a_file(run, tmp_path):
    status, out, _ = run("export", "--to", "csv", "--topics", "process,wrench", "--lines", "9:9", "--period", "0.5")
    rows = out.splitlines()

    assert status == 0 and rows[0].startswith("time_s,file,line,tool,motion,process.")
    assert 5 <= len(rows) - 1 <= 8 and all(",slot.nc,9," in row or ",slot.nc,10," in row for row in rows[1:])
    status, out, _ = run("export", "--to", "csv", "-o", "t.csv", "--units", "mm", "--time", "1:2 s")
    assert status == 0 and "wrote 51 rows" in out and "motion.x_mm" in (tmp_path / "t.csv").read_text()


def test_json_lines_without_a_file(run):
    status, out, _ = run("export", "--to", "jsonl", "--topics", "/event")

    assert status == 0 and json.loads(out.splitlines()[0])["message"]["code"] == "start"


@pytest.mark.parametrize(("kind", "name"), [("stl", "slot.stl"), ("glb", "slot.glb"), ("rosbag2", "slot_bag")])
def test_files_are_named_after_the_program(run, tmp_path, kind, name):
    options = ["--period", "1 s"] if kind == "rosbag2" else ["--at", "9.5 s"]
    status, out, _ = run("export", "--to", kind, *options)

    assert status == 0 and name in out and (tmp_path / name).exists()


def test_charts_end_in_svg_or_png(run, tmp_path):
    assert run("plot", "--what", "force")[0] == 0
    assert run("plot", "--what", "force,joints", "--lines", "8:12", "-o", "b.png")[0] == 0

    assert (tmp_path / "slot.svg").read_bytes().startswith(b"<?xml")
    assert (tmp_path / "b.png").read_bytes().startswith(b"\x89PNG")


def test_a_report_is_one_file(run, tmp_path):
    status, out, _ = run("report")

    assert status == 0 and "wrote report.html" in out
    assert (tmp_path / "report.html").read_text(encoding="utf-8").startswith("<!DOCTYPE html>")


def test_times_as_text_and_json(run):
    status, text, _ = run("report", "--times")
    value = json.loads(run("report", "--times", "--format", "json")[1])

    assert status == 0 and text.startswith("18.8 s in all") and "slot.nc:14" in text
    assert sum(line["time_s"] for line in value["lines"]) == pytest.approx(value["total_s"])


@pytest.mark.parametrize(
    ("command", "arguments", "words"),
    [
        ("export", ["--to", "stl", "--topics", "/tcp"], "--topics means nothing for stl"),
        ("export", ["--to", "csv", "--at", "3"], "--at means nothing for csv"),
        ("export", ["--to", "stl", "--at", "1 min"], "the run ends at"),
        ("export", ["--to", "csv", "--topics", "/nothing"], "no topic /nothing"),
        ("export", ["--to", "csv", "--lines", "90:99"], "no line from 90 to 99"),
        ("export", ["--to", "csv", "--time", "80:90"], "the run ends at"),
        ("export", ["--to", "csv", "--time", "5"], "no range of time"),
        ("export", ["--to", "csv", "--period", "soon"], "no time"),
        ("export", ["--to", "stl", "--stock", "other"], "it has stock"),
        ("plot", ["--what", "heat"], "there is no quantity heat"),
        ("plot", ["-o", "a.bmp"], "ends in .svg, .png or .pdf"),
        ("report", ["--format", "json"], "--times has numbers"),
    ],
)
def test_wrong_wishes_are_usage(run, command, arguments, words):
    status, _, said = run(command, *arguments)

    assert status == 2 and words in said


@pytest.mark.parametrize("command", [["export", "--to", "csv"], ["plot"], ["report"]])
def test_what_is_not_there_is_usage(run, tmp_path, command):
    for log in (tmp_path, tmp_path / "no.mcap"):
        status, _, said = run(*command, log=log)
        assert status == 2 and "Traceback" not in said and said.startswith("gcodesim: ")


@pytest.fixture
def damaged(slot_folder, tmp_path):
    """Logs with something wrong: another byte in a chunk, nothing but zeros in all, cut before the first, of others."""
    from mcap.reader import make_reader
    from mcap.writer import Writer

    whole = (slot_folder / "run.mcap").read_bytes()
    with (slot_folder / "run.mcap").open("rb") as stream:
        chunks = make_reader(stream).get_summary().chunk_indexes
    chunk = chunks[0]
    nothing = bytearray(whole)
    for one in chunks:
        nothing[one.chunk_start_offset : one.chunk_start_offset + one.chunk_length] = bytes(one.chunk_length)
    (tmp_path / "zeros.mcap").write_bytes(nothing)
    at = chunk.chunk_start_offset + chunk.chunk_length // 2
    (tmp_path / "bit.mcap").write_bytes(whole[:at] + bytes([whole[at] ^ 255]) + whole[at + 1 :])
    (tmp_path / "early.mcap").write_bytes(whole[: chunk.chunk_start_offset])
    with (tmp_path / "other.mcap").open("wb") as stream:
        writer = Writer(stream)
        writer.start()
        channel = writer.register_channel("/chat", "json", writer.register_schema("chat", "jsonschema", b"{}"))
        writer.add_message(channel, 5, b"{}", 5)
        writer.finish()
    return tmp_path


@pytest.mark.parametrize(
    "command",
    [
        *(["export", "--to", form, "-o", "out"] for form in ("csv", "jsonl", "stl", "glb", "rosbag2")),
        *(["plot"], ["report"], ["report", "--times"]),
    ],
)
def test_logs_of_which_nothing_can_be_read_are_usage_and_leave_nothing(run, damaged, command):
    before = sorted(damaged.iterdir())
    told = {name: run(*command, log=damaged / f"{name}.mcap") for name in ("zeros", "early", "other")}

    assert [status for status, _, _ in told.values()] == [2, 2, 2], told
    assert all(said.startswith("gcodesim: ") and said.count("\n") == 1 for _, _, said in told.values()), told
    assert "holds nothing that can be read: 0.000 to " in told["zeros"][2]
    assert "no log of gcodesim" in told["other"][2]
    assert "holds nothing that can be read" in told["early"][2]
    assert sorted(damaged.iterdir()) == before


@pytest.mark.parametrize(
    "command",
    [
        *(["export", "--to", form, "-o", "out.file"] for form in ("csv", "jsonl", "stl", "glb", "rosbag2")),
        *(["plot", "-o", "out.file.svg"], ["report", "-o", "out.file"]),
    ],
)
def test_of_a_damaged_log_comes_what_can_be_read_and_a_finding(run, damaged, command):
    status, out, said = run(*command, log=damaged / "bit.mcap")

    assert status == 1 and out.startswith("wrote ")
    assert said.startswith("bit.mcap: error GS614: 0.000 to ") and "what was in it is left out" in said
    assert len(list(damaged.glob("out.file*"))) == 1


def test_whatever_is_damaged_nothing_is_a_fault_of_ours(run, slot_folder, tmp_path):
    from random import Random

    whole, chance, seen = (slot_folder / "run.mcap").read_bytes(), Random(8), set()
    commands = [["info"], ["info", "--layout"], ["plot"], ["report", "--times"]]
    commands += [["export", "--to", form, "-o", "out"] for form in ("csv", "glb", "stl")]
    commands += [["export", "--to", "stl", "--at", "3", "-o", "out"], ["export", "--to", "csv", "--topics", "/event"]]
    for round in range(36):
        data = bytearray(whole)
        for _ in range(chance.choice([1, 1, 3])):
            at = chance.randrange(8, chance.choice([len(data), 40_000]))
            data[at : at + 30] = chance.choice([bytes(30), chance.randbytes(30), b"", chance.randbytes(3000)])
        (tmp_path / "harmed.mcap").write_bytes(data[: chance.choice([len(data), chance.randrange(len(data))])])
        status, _, said = run(*commands[round % len(commands)], log=tmp_path / "harmed.mcap")
        seen.add(status)
        assert status in (0, 1, 2) and "Traceback" not in said
    assert seen == {0, 1, 2}


def test_a_page_says_that_its_log_is_damaged(run, damaged, tmp_path):
    from gcodesim.playback import Recording
    from gcodesim.report.pack import Pack
    from gcodesim.report.page import run_data

    shown = run_data(Recording.open(damaged / "bit.mcap"), "", Pack())
    (finding,) = [finding for finding in shown["findings"] if finding["code"] == "GS614"]
    assert shown["damaged"] and finding["severity"] == "error" and finding["t"] == 0


def test_times_of_a_log_that_was_cut_off_come_with_a_warning(run, slot_folder, tmp_path):
    whole = (slot_folder / "run.mcap").read_bytes()
    (tmp_path / "cut.mcap").write_bytes(whole[: len(whole) * 9 // 10])
    status, out, said = run("report", "--times", log=tmp_path / "cut.mcap")

    assert status == 0 and "by tool" in out
    assert said.startswith("cut.mcap: warning GS614: the file ends before its index; what came after ")


def test_a_log_of_others_is_known_as_such(run, damaged):
    status, _, said = run("diff", "bit.mcap", log=damaged / "other.mcap")
    assert status == 2 and "holds neither a program nor results" in said
    status, out, _ = run("info", log=damaged / "other.mcap")
    assert status == 0 and out.splitlines()[0].endswith("other.mcap: an MCAP file, but no log of gcodesim")


def test_a_package_without_its_script_is_named(run, monkeypatch):
    from gcodesim.report import libraries

    monkeypatch.setattr(libraries, "_CHART_FOLDER", "nowhere")
    status, _, said = run("report")

    assert status == 2 and "metaflow-card-uplot" in said and "uPlot.iife.min.js" in said
