"""`gcodesim fmt` as a user sees it."""

import io
import json
import sys

from tests.binary_gcode import file_of

UGLY, FINE, BAD = b"g21g90\ng01x.50f100\nm2\n", b"G21 G90\nG1 X0.5 F100\nM2\n", b"g1x\nm2\n"


def test_writes_what_changes_and_says_so(cli, tmp_path):
    ugly, fine = tmp_path / "ugly.nc", tmp_path / "fine.nc"
    ugly.write_bytes(UGLY)
    fine.write_bytes(FINE)
    ugly.chmod(0o640)
    before = fine.stat().st_mtime_ns
    (tmp_path / "slot.nc").unlink()
    outcome = cli("fmt", ".")

    assert (outcome.status, outcome.out) == (0, "")
    assert outcome.err.splitlines() == ["ugly.nc: 3 lines changed", "1 program changed, 1 as before, 0 left alone"]
    assert ugly.read_bytes() == FINE
    assert ugly.stat().st_mode & 0o777 == 0o640
    assert fine.stat().st_mtime_ns == before


def test_a_program_with_errors_stays(cli, tmp_path):
    (tmp_path / "bad.nc").write_bytes(BAD)
    outcome = cli("fmt", "bad.nc")

    assert outcome.status == 1
    assert "bad.nc:1:3: error GS004" in outcome.out
    assert "bad.nc is left alone: it has errors" in outcome.err
    assert (tmp_path / "bad.nc").read_bytes() == BAD


def test_check_writes_nothing(cli, tmp_path):
    for name, raw in (("ugly.nc", UGLY), ("fine.nc", FINE), ("bad.nc", BAD)):
        (tmp_path / name).write_bytes(raw)
    outcome = cli("fmt", "--check", "--format", "json", ".")

    assert outcome.status == 1
    found = {(one["file"], one["code"]) for one in json.loads(outcome.out)["findings"]}
    assert found == {("ugly.nc", "GS023"), ("bad.nc", "GS004")}
    assert (tmp_path / "ugly.nc").read_bytes() == UGLY
    assert cli("fmt", "--check", "fine.nc").status == 0


def test_check_for_build_servers(cli, tmp_path):
    (tmp_path / "ugly.nc").write_bytes(UGLY)
    outcome = cli("fmt", "--check", "--github", "ugly.nc")

    assert outcome.status == 1
    assert "::error file=ugly.nc,line=1" in outcome.out


def test_diff(cli, tmp_path):
    (tmp_path / "ugly.nc").write_bytes(UGLY)
    outcome = cli("fmt", "--diff", "ugly.nc")

    assert outcome.status == 1
    assert outcome.out.splitlines()[:5] == ["--- ugly.nc", "+++ ugly.nc", "@@ -1,3 +1,3 @@", "-g21g90", "-g01x.50f100"]
    assert (tmp_path / "ugly.nc").read_bytes() == UGLY


def test_from_stdin_to_stdout(cli, monkeypatch):
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(UGLY)))

    assert cli("fmt", "-").out == FINE.decode()


def test_errors_of_stdin_do_not_mix_with_a_program(cli, monkeypatch):
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(BAD)))
    outcome = cli("fmt", "-")

    assert (outcome.status, outcome.out) == (1, "")
    assert "GS004" in outcome.err


def test_a_link_is_followed_and_folders_lead_nowhere_else(cli, tmp_path):
    (tmp_path / "real.nc").write_bytes(UGLY)
    (tmp_path / "shop").mkdir()
    (tmp_path / "shop" / "link.nc").symlink_to(tmp_path / "real.nc")

    assert cli("fmt", "shop").status == 2
    assert cli("fmt", "shop/link.nc").status == 0
    assert (tmp_path / "shop" / "link.nc").is_symlink()
    assert (tmp_path / "real.nc").read_bytes() == FINE


def test_dialect_of_the_cell(cli, tmp_path):
    (tmp_path / "mill.yaml").write_text("gcodesim: 1\nmachine: gantry_xyz\ndialect: fanuc\n")
    (tmp_path / "p.nc").write_bytes(b"o0001\n#1=#2+1.00\nm30\n")

    assert cli("fmt", "p.nc", "--cell", "mill.yaml").status == 0
    assert (tmp_path / "p.nc").read_bytes() == b"O0001\n#1 = #2 + 1.\nM30\n"


def test_wrong_usage(cli, tmp_path):
    (tmp_path / "p.nc").write_bytes(FINE)

    assert cli("fmt", "gone.nc").status == 2
    assert cli("fmt", "-", "p.nc").status == 2
    assert cli("fmt", "p.nc", "--renumber", "0").status == 2


def test_the_style_of_the_folder_and_what_the_command_line_says_of_it(cli, tmp_path):
    (tmp_path / "gcodesim.yaml").write_text("format: {case: lower, decimals: 3, code_digits: 2}\n")
    program = tmp_path / "part.nc"
    program.write_bytes(UGLY)

    assert cli("fmt", "part.nc", "--check").status == 1
    assert cli("fmt", "part.nc").status == 0
    assert program.read_bytes() == b"g21 g90\ng01 x0.500 f100\nm02\n"
    assert cli("fmt", "part.nc", "--check").status == 0
    assert cli("fmt", "part.nc", "--case", "upper", "--decimals", "1").status == 0
    assert program.read_bytes() == b"G21 G90\nG01 X0.5 F100\nM02\n"


def test_a_fault_in_the_settings_leaves_programs_alone(cli, tmp_path):
    (tmp_path / "gcodesim.yaml").write_text("format: {case: lowr}\n")
    (tmp_path / "ugly.nc").write_bytes(UGLY)
    outcome = cli("fmt", "ugly.nc", "--check")

    assert outcome.status == 1
    assert "gcodesim.yaml:1:16: error GS711" in outcome.out and "`lower`" in outcome.out
    assert cli("fmt", "ugly.nc").status == 1
    assert (tmp_path / "ugly.nc").read_bytes() == UGLY


def test_binary_programs_are_not_overwritten_by_text(cli, tmp_path, monkeypatch):
    raw = file_of("M83\nG1 X10 E1 F1200\n")
    (tmp_path / "print.bgcode").write_bytes(raw)
    (tmp_path / "fine.nc").write_bytes(FINE)
    (tmp_path / "slot.nc").unlink()

    assert cli("fmt", "--dialect", "marlin", "print.bgcode").err == (
        "gcodesim: print.bgcode is binary G-code, and what is written is text: "
        "gcodesim fmt - < print.bgcode > print.gcode\n"
    )
    assert cli("fmt", ".").err == "0 programs changed, 1 as before, 0 left alone\n"
    assert (tmp_path / "print.bgcode").read_bytes() == raw
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(raw)))
    outcome = cli("fmt", "--dialect", "marlin", "-")
    assert outcome.status == 0 and "\nM83\nG1 X10 E1 F1200\n" in outcome.out
