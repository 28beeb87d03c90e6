"""The pytest plugin, in runs of pytest inside folders of their own."""

from __future__ import annotations

from pathlib import Path

import pytest

pytest_plugins = ["pytester"]

CELL = """gcodesim: 1
machine: gantry_xyz
stock: {box: [100, 60, 20], zero: top-front-left, material: al6082_t6, resolution: 2}
tools: {1: {type: flat_end_mill, diameter: 6 mm}}
simulation: {world: kinematic}
"""
SLOT = "G21 G90 G17 G94\nT1 M6\nG43 H1\nS8000 M3\nG0 X10 Y10\nG0 Z2\nG1 Z-1 F400\nG1 X30\nG0 Z20\nM5\nM2\n"


@pytest.fixture(scope="module", autouse=True)
def loaded(tmp_path_factory: pytest.TempPathFactory) -> None:
    """All modules of a run: pytester forgets those that its runs load, and numpy cannot be loaded twice."""
    import gcodesim
    from gcodesim.formats import text  # noqa: F401
    from gcodesim.regress import accept, judge  # noqa: F401

    folder = tmp_path_factory.mktemp("loaded")
    (folder / "cell.yaml").write_text(CELL)
    (folder / "slot.nc").write_text(SLOT.replace(" M3", ""))
    gcodesim.simulate(folder / "slot.nc", folder / "cell.yaml")


@pytest.fixture
def folder(pytester: pytest.Pytester, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A rootdir with a cell and a clean program with its test file; the plugin comes by its entry point."""
    monkeypatch.setenv("GCODESIM_TEST_CACHE", str(pytester.path / "memory"))
    pytester.makeini("[pytest]\n")
    (pytester.path / "suite").mkdir()
    write(pytester, "cell.yaml", CELL)
    write(pytester, "suite/slot.nc", SLOT)
    write(pytester, "suite/slot.test.yaml", "cell: ../cell.yaml\n")
    return pytester.path


def run(pytester: pytest.Pytester, *arguments: str) -> pytest.RunResult:
    """pytest inside this process, without a plugin that happens to be installed and is slow to load."""
    return pytester.runpytest_inprocess("-p", "no:hypothesispytest", *arguments)


def write(pytester: pytest.Pytester, name: str, text: str) -> None:
    (pytester.path / name).write_text(text, encoding="utf-8")


def test_the_entry_point_names_the_plugin() -> None:
    from importlib.metadata import entry_points

    assert {point.value for point in entry_points(group="pytest11", name="gcodesim")} == {"gcodesim.pytest_plugin"}


def test_a_clean_case_passes_and_has_a_name(pytester: pytest.Pytester, folder: Path) -> None:
    done = run(pytester, "-v")
    done.assert_outcomes(passed=1)
    done.stdout.fnmatch_lines(["suite/slot.test.yaml::slot PASSED*"])


def test_a_failure_shows_findings_with_their_lines_and_no_traceback(pytester: pytest.Pytester, folder: Path) -> None:
    write(pytester, "suite/slot.nc", SLOT.replace(" M3", ""))
    done = run(pytester)
    done.assert_outcomes(failed=1)
    done.stdout.fnmatch_lines(
        [
            "*slot.test.yaml: slot*",
            "GS501: T1 feeds through *",
            "suite/slot.nc in cell.yaml",
            "  suite/slot.nc:7:1: error GS501: T1 feeds through *",
            "    7 | G1 Z-1 F400",
            "      | ^^^^^^^^^^^",
            "    hint: start it with *",
            "*Captured gcodesim call*",
            "suite/slot.test.yaml: note GS607:*",
            "FAILED suite/slot.test.yaml::slot - GS501: T1 feeds through *",
        ]
    )
    done.stdout.no_fnmatch_line("*Traceback*")
    done.stdout.no_fnmatch_line("*judge.py*")


def test_what_differs_from_the_accepted_is_named(pytester: pytest.Pytester, folder: Path) -> None:
    from gcodesim.regress.accept import propose, take
    from gcodesim.regress.case import collect
    from gcodesim.regress.outcome import Judging

    for case in collect([folder], folder).cases:
        take(propose(case, Judging(root=folder)))
    run(pytester).assert_outcomes(passed=1)
    write(pytester, "suite/slot.nc", SLOT.replace("X30", "X31"))
    done = run(pytester)
    done.assert_outcomes(failed=1)
    done.stdout.fnmatch_lines(
        [
            "*error GS603: *X 30 → 31 mm*",
            "differs from what was accepted: *X*",
            "*gcodesim accept suite/slot.test.yaml*",
        ]
    )


def test_a_faulty_test_file_fails_and_the_others_run(pytester: pytest.Pytester, folder: Path) -> None:
    write(pytester, "suite/other.test.yaml", "cell: absent.yaml\nprogram: slot.nc\n")
    done = run(pytester)
    done.assert_outcomes(passed=1, failed=1)
    done.stdout.fnmatch_lines(["suite/other.test.yaml:1:*: error GS610: the cell `absent.yaml` is not there"])


def test_a_pattern_leaves_programs_with_their_own_file_to_it(pytester: pytest.Pytester, folder: Path) -> None:
    write(pytester, "suite/twin.nc", SLOT)
    write(pytester, "suite/all.test.yaml", "cell: ../cell.yaml\nprogram: '*.nc'\noptions: {mode: check}\n")
    done = run(pytester, "-v")
    done.assert_outcomes(passed=2)
    done.stdout.fnmatch_lines(["suite/all.test.yaml::twin.nc PASSED*", "suite/slot.test.yaml::slot PASSED*"])


@pytest.mark.parametrize(("day", "outcome"), [("2027-03-01", "passed"), ("2027-03-02", "failed")])
def test_options(pytester: pytest.Pytester, folder: Path, day: str, outcome: str) -> None:
    dated = CELL + "suppress: [{code: GS501, reason: known, until: 2027-03-01}]\n"
    write(pytester, "cell.yaml", dated)
    write(pytester, "suite/slot.nc", SLOT.replace(" M3", ""))
    run(pytester, "--gcodesim-today", day).assert_outcomes(**{outcome: 1})
    never = run(pytester, "--gcodesim-today", day, "--gcodesim-fail-on", "never")
    never.assert_outcomes(passed=1)


def test_a_baseline_takes_what_is_known_and_nothing_else(pytester: pytest.Pytester, folder: Path) -> None:
    from gcodesim.cli import main

    write(pytester, "suite/slot.nc", SLOT.replace(" M3", ""))
    main(["test", "suite", "--write-baseline", "known.json"])
    run(pytester, "--gcodesim-baseline", "known.json").assert_outcomes(passed=1)
    run(pytester).assert_outcomes(failed=1)
    write(pytester, "suite/slot.nc", SLOT.replace(" M3", "").replace("G1 X30", "G1 X30\nG0 X40"))
    done = run(pytester, "--gcodesim-baseline", "known.json")
    done.assert_outcomes(failed=1)
    done.stdout.fnmatch_lines(["*error GS401*", "*Captured gcodesim*", "*error GS501*", "*in the baseline*"])


@pytest.mark.parametrize("text", [None, "{}", "G0 X1"])
def test_a_baseline_that_cannot_be_read_is_wrong_usage(
    pytester: pytest.Pytester, folder: Path, text: str | None
) -> None:
    if text is not None:
        write(pytester, "known.json", text)
    done = run(pytester, "--gcodesim-baseline", "known.json")
    assert done.ret == pytest.ExitCode.USAGE_ERROR
    done.stderr.fnmatch_lines(
        ["*baseline known.json is not there" if text is None else "*baseline known.json cannot be read: *"]
    )


def test_what_passed_is_remembered_and_what_changed_runs(
    pytester: pytest.Pytester, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from gcodesim.cli import main
    from gcodesim.regress import judge

    ran = []
    judged = judge.judge
    monkeypatch.setattr(judge, "judge", lambda case, how: ran.append(case.name) or judged(case, how))
    main(["test", "suite"])  # one memory for both
    ran.clear()
    run(pytester, "--gcodesim-changed").assert_outcomes(passed=1)
    assert ran == []
    run(pytester).assert_outcomes(passed=1)
    write(pytester, "suite/slot.nc", SLOT + "\n(more)\n")
    run(pytester, "--gcodesim-changed").assert_outcomes(passed=1)
    assert ran == ["suite/slot", "suite/slot"]


def test_selection_by_name(pytester: pytest.Pytester, folder: Path) -> None:
    done = run(pytester, "-k", "nothing")
    done.assert_outcomes(deselected=1)
    run(pytester, "suite/slot.test.yaml::slot").assert_outcomes(passed=1)


def test_without_test_files_nothing_of_gcodesim_is_loaded(pytester: pytest.Pytester) -> None:
    """In a process of its own: the plugin costs its own module and the version."""
    pytester.makepyfile(
        """
        import sys

        def test_modules():
            assert {m for m in sys.modules if m.startswith("gcodesim")} == {
                "gcodesim", "gcodesim.version", "gcodesim.pytest_plugin"
            }
        """
    )
    pytester.runpytest_subprocess("-p", "no:hypothesispytest").assert_outcomes(passed=1)


def test_collecting_loads_nothing_heavy(pytester: pytest.Pytester, folder: Path) -> None:
    write(
        pytester,
        "conftest.py",
        "import sys\n\ndef pytest_collection_finish(session):\n"
        "    heavy = {'numba', 'scipy', 'pybullet', 'mcap', 'trimesh', 'lark', 'rich'} & sys.modules.keys()\n"
        "    print('heavy:', sorted(heavy), len(session.items))\n",
    )
    done = pytester.runpytest_subprocess("-p", "no:hypothesispytest", "--collect-only", "-q", "-s")
    done.stdout.fnmatch_lines(["*heavy: [[]] 1"])
