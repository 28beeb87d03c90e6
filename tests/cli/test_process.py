"""`gcodesim process`: the calculator on the command line."""

from __future__ import annotations

import json

import jsonschema
import pytest

SLOT = ("endmill", "diameter=10 mm", "flutes=4", "ap=5mm", "feed_per_tooth=0.05 mm", "spindle=4000 rpm")


def test_models_are_listed_and_described(cli) -> None:
    listed = cli("process")
    assert listed.status == 0 and "endmill " in listed.out and "kienzle " in listed.out

    described = cli("process", "turning")
    assert described.status == 0
    assert "entering_angle" in described.out and "Fc" in described.out and "Kienzle 1952" in described.out


def test_results_have_units_and_a_source(cli) -> None:
    done = cli("process", *SLOT, "material=42CrMo4")

    assert done.status == 0
    assert "mrr                  666.667 mm^3/s" in done.out
    assert "source: Altintas 2012" in done.out and "AISI 4140" in done.out


def test_json_has_the_inputs_and_the_results(cli) -> None:
    done = cli("process", *SLOT, "kc=2500 N/mm^2", "mc=0.26", "--format", "json")
    said = json.loads(done.out)

    assert said["model"] == "endmill" and said["inputs"]["diameter_mm"] == 10.0
    assert said["results"]["mrr_mm3_s"] == pytest.approx(2000.0 / 3.0)
    assert said["remarks"] == ["assumed: normal force 0.3, axial 0 of the tangential one"]


def test_a_chart_of_one_revolution_is_the_same_each_time(cli, tmp_path) -> None:
    for name in ("a.svg", "b.svg"):
        assert cli("process", *SLOT, "material=42CrMo4", "--chart", name).status == 0
    assert (tmp_path / "a.svg").read_bytes() == (tmp_path / "b.svg").read_bytes()


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (("process", "endmil", "ap=1"), "did you mean endmill"),
        (("process", *SLOT, "material=42CrMo"), "there is no material 42CrMo"),
        (("process", *SLOT), "no material: give"),
        (("process", "endmill", "diameter=10", "ap=1", "ae=11", "mode=up", "material=42CrMo4"), "`ae` 11 mm"),
        (("process", "kienzle", "h=0.1mm", "b=1mm", "material=42CrMo4", "--chart", "x.svg"), "has no chart"),
        (("process", "--out", "x.json"), "--cases"),
        (("process", "--cases", "none.json"), "none.json"),
    ],
)
def test_misuse_is_one_line_and_status_2(cli, arguments: tuple[str, ...], told: str) -> None:
    done = cli(*arguments)

    assert done.status == 2 and not done.out
    assert told in done.err and len(done.err.splitlines()) == 1


def test_cases_go_in_and_results_come_out(cli, tmp_path) -> None:
    case = {"id": "K", "model": "kienzle", "inputs": {"kc": 2500, "mc": 0.26, "b_mm": 5, "h_mm": 0.1}}
    case["expected"] = {"Fc_kN": {}}
    (tmp_path / "cases.json").write_text(json.dumps({"cases": [case]}))
    done = cli("process", "--cases", "cases.json", "--out", "results.json")

    assert done.status == 0 and not done.err
    assert json.loads((tmp_path / "results.json").read_text())["K"]["Fc_kN"] == pytest.approx(2.27462607326)

    (tmp_path / "cases.json").write_text(json.dumps({"cases": [case, {"id": "L", "model": "lathe"}]}))
    done = cli("process", "--cases", "cases.json")
    assert done.status == 1 and "L: there is no model lathe" in done.err and set(json.loads(done.out)) == {"K"}


def test_the_json_is_as_its_schema_says(cli) -> None:
    schema = json.loads(cli("schema", "process").out)
    done = cli("process", *SLOT, "kc=2500 N/mm^2", "mc=0.26", "runout=5 um", "theta=[10]", "--format", "json")

    jsonschema.validate(json.loads(done.out), schema)
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate({"schema": "gcodesim-process/1"}, schema)


@pytest.mark.parametrize(
    "text",
    ["[" * 100_000 + "]" * 100_000, '[{"model": "endmill", "diameter_mm": NaN}]', "", "[1]"],
    ids=["deep", "NaN", "empty", "no case"],
)
def test_cases_that_cannot_be_read_are_refused(cli, tmp_path, text) -> None:
    (tmp_path / "cases.json").write_text(text)
    done = cli("process", "--cases", tmp_path / "cases.json")
    assert (done.status, done.out) == (2, "")
    assert done.err.startswith("gcodesim: ") and done.err.count("\n") == 1


def test_ridges_between_passes(cli) -> None:
    """R = 5 mm and s = 2 mm: h = 5 - sqrt(24); on 60 degrees passes seen 1 mm apart are 2 mm apart along the face."""
    height = 5.0 - 24.0**0.5

    def found(*words: str) -> dict[str, float]:
        done = cli("process", "scallop", "diameter=10 mm", *words, "--format", "json")
        assert done.status == 0
        return json.loads(done.out)["results"]

    assert found("s=2 mm")["scallop_height_mm"] == pytest.approx(height, rel=1e-12)
    assert found("step_over=1 mm", "slope=60 deg")["scallop_height_mm"] == pytest.approx(height, rel=1e-9)
    assert found(f"h={height!r} mm")["step_over_mm"] == pytest.approx(2.0, rel=1e-9)
    across = [5.0 - (25.0 - (k * 1e-3) ** 2) ** 0.5 for k in range(1001)]
    assert found("s=2 mm")["mean_height_mm"] == pytest.approx(sum(across) / 1001, rel=1e-3)
    bull = ("type=bull", "corner_radius=1 mm")
    assert found(*bull, "s=8 mm")["scallop_height_mm"] == 0.0  # the flat reaches over
    assert found(*bull, "s=9 mm")["scallop_height_mm"] == pytest.approx(1.0 - 0.75**0.5, rel=1e-9)
    for words in (("s=11 mm",), ("h=6 mm",), (), ("s=1 mm", "h=1 mm"), ("s=1 mm", "type=bull")):
        assert cli("process", "scallop", "diameter=10 mm", *words).status == 2


def test_values_may_stand_behind_an_option(cli) -> None:
    behind = cli("process", "additive.bead", "--format", "json", "height=3mm", "width=6mm")

    assert behind.status == 0
    assert behind.out == cli("process", "additive.bead", "height=3mm", "width=6mm", "--format", "json").out
