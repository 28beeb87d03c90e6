"""What a study may say, and what is wrong with one, with places."""

from __future__ import annotations

from pathlib import Path

import pytest

from gcodesim.diagnostics import SourceText
from gcodesim.sweep.design import count, points
from gcodesim.sweep.study_file import read_study, study_schema

BASE = "program: a.nc\ncell: c.yaml\n"


@pytest.fixture
def read(tmp_path: Path):
    """Read a study in a folder with programs, a cell and a table."""
    for name in ("a.nc", "b.nc", "c.yaml", "job.yaml"):
        (tmp_path / name).write_text("")
    (tmp_path / "t.csv").write_text("D,#depth,x-note\n6 mm,1,ä\n8,2,\n")

    def read(text: str):
        path = tmp_path / "study.yaml"
        path.write_text(text)
        return read_study(SourceText.read(path), path)

    return read


def rows(file) -> list[tuple[object, ...]]:
    return [tuple(level.shown for level in point.values()) for point in points(file.study)]


def test_a_grid_has_each_value_with_each_other_and_units_in_its_columns(read):
    depth = "depth: {parameter: '#<Depth>', from: 1, to: 2, steps: 3}"
    file = read(BASE + f"vary:\n  tools.1.diameter: [6, 8 mm]\n  {depth}\n")

    assert not list(file.findings)
    assert rows(file) == [(6, 1), (6, 1.5), (6, 2), (8, 1), (8, 1.5), (8, 2)]
    assert count(file.study) == 6
    first, second = file.study.vary.values()
    assert (first.heading, first.path, second.parameter) == ("tools.1.diameter_mm", ("tools", "1", "diameter"), "depth")
    assert next(points(file.study))["tools.1.diameter"].node.text == "6 mm"


def test_rows_go_side_by_side(read):
    file = read(BASE + "vary: {a: [1, 2, 3], b: {parameter: 5, from: 0, to: 4, steps: 3}}\ndesign: rows\n")

    assert rows(file) == [(1, 0), (2, 2), (3, 4)]


@pytest.mark.parametrize("design", ["sobol", "latin_hypercube"])
def test_points_are_spread_over_ranges_by_the_seed(read, design: str):
    text = BASE + "vary: {{a: {{from: 0 mm, to: 8, whole: true}}, b: [x, y], c: {{parameter: 5, from: 2, to: 3}}}}\n"
    text += "design: {{type: {}, runs: 8, seed: {}}}\n"

    one, same, other = (rows(read(text.format(design, seed))) for seed in (1, 1, 2))

    assert one == same != other
    assert len(one) == 8
    assert {b for _, b, _ in one} == {"x", "y"}
    assert all(a in range(9) and 2 <= c <= 3 for a, _, c in one)
    assert sorted(int((c - 2) * 8) for _, _, c in one) == list(range(8))  # one in each eighth: both do that


def test_a_table_gives_values_and_its_own_factors(read):
    file = read(BASE + "table: t.csv\nvary: {size: {key: tools.1.diameter, column: D}, other: [u, v]}\n")

    assert not list(file.findings)
    assert rows(file) == [(6, "u", 1), (6, "v", 1), (8, "u", 2), (8, "v", 2)]
    assert file.study.vary["#depth"].parameter == "depth"
    assert count(file.study) == 4


@pytest.mark.parametrize(
    ("text", "code", "line"),
    [
        (BASE + "vary: {a: [1 mm, 2 in]}\n", "GS709", 3),
        (BASE + "vary: {a: {from: 1, to: 2}}\n", "GS705", 3),
        (BASE + "vary: {a: {from: 2, to: 1, steps: 3}}\n", "GS710", 3),
        (BASE + "vary: {a: {from: 2, steps: 3}}\n", "GS705", 3),
        (BASE + "vary: {a: {from: 2 mm, to: 3 in, steps: 3}}\n", "GS709", 3),
        (BASE + "vary: {a: {parameter: 5, values: [1 mm]}}\n", "GS709", 3),
        (BASE + "vary: {a: {parameter: 5, values: [x]}}\n", "GS707", 3),
        (BASE + "vary: {a: {parameter: 1.5, values: [1]}}\n", "GS711", 3),
        (BASE + "vary:\n  a:\n    parameter: #100\n    values: [1]\n", "GS705", 5),
        (BASE + "vary: {a: {parameter: 5, key: b, values: [1]}}\n", "GS711", 3),
        (BASE + "vary: {a..b: [1]}\n", "GS711", 3),
        (BASE + "vary: {a: []}\n", "GS706", 3),
        (BASE + "vary: {a: {steps: 3, values: [1]}}\n", "GS711", 3),
        (BASE + "vary: {a: {key: b, value: [1]}}\n", "GS704", 3),
        (BASE + "vary: {a: {column: q}}\ntable: t.csv\n", "GS705", 3),
        (BASE + "vary: {a: {column: q}}\n", "GS705", 3),
        (BASE + "vary: {program: [a.nc, q.nc]}\n", "GS714", 3),
        (BASE + "vary: {a: [1, 2], b: [1]}\ndesign: rows\n", "GS711", 4),
        (BASE + "vary: {a: [1]}\ndesign: sobol\n", "GS705", 4),
        (BASE + "vary: {a: [1]}\ndesign: {type: grid, runs: 3}\n", "GS711", 4),
        (BASE + "vary: {a: [1]}\nfail: forc > 4 N\n", "GS711", 4),
        (BASE + "vary: {a: [1]}\nfail: force > 4 mm\n", "GS709", 4),
        (BASE + "vary: {a: [1]}\nfail: force > 4\n", "GS708", 4),
        (BASE + "vary: {a: [1]}\nfail: force 4\n", "GS711", 4),
        (BASE + "vary: {a: [1]}\nfind: {least: time, most: removed}\n", "GS711", 4),
        (BASE, "GS705", 1),
        ("cell: c.yaml\nvary: {a: [1]}\n", "GS705", 1),
        ("job: job.yaml\nprogram: a.nc\nvary: {a: [1]}\n", "GS711", 1),
        ("gcodesim-study: 2\n" + BASE + "vary: {a: [1]}\n", "GS711", 1),
    ],
)
def test_faults_have_codes_and_places(read, text: str, code: str, line: int):
    file = read(text)

    assert file.study is None
    assert (code, line) in [(finding.code, finding.span.line) for finding in file.findings]


def test_the_schema_knows_all_keys():
    schema = study_schema()

    assert set(schema["$defs"]["Study"]["properties"]) >= {"program", "cell", "job", "vary", "fail", "find", "design"}


def test_a_range_without_steps_is_told_how_to_be_spread(read) -> None:
    """The hint is a line that works."""
    vary = BASE + "vary: {a: {parameter: 5, from: 2, to: 3}}\n"
    (found,) = read(vary).findings
    design = found.hint.split("`")[3]

    assert design.startswith("design:") and not read(f"{vary}{design}\n").findings
