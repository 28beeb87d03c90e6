"""The GitHub Action, the GitLab template and the pre-commit hooks, carried out in a small repository.

Their `run:` steps, scripts and entries are executed as they stand; only the step that installs gcodesim is left out,
because the environment of the tests has it, and `uses:` steps of others cannot run here.
"""

from __future__ import annotations

import json
import os
import re
import shlex
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from check_jsonschema.builtin_schemas import get_builtin_schema
from ruamel.yaml import YAML

TOP = Path(__file__).parents[2]
CELL = """gcodesim: 1
machine: gantry_xyz
stock: {box: [100, 60, 20], zero: top-front-left, material: al6082_t6, resolution: 2}
tools: {1: {type: flat_end_mill, diameter: 6 mm}}
simulation: {world: kinematic}
"""
SLOT = "G21 G90 G17 G94\nT1 M6\nG43 H1\nS8000 M3\nG0 X10 Y10\nG0 Z2\nG1 Z-1 F400\nG1 X30\nG0 Z20\nM5\nM2\n"
WITHOUT_SPINDLE = SLOT.replace(" M3", "")
EXPRESSION = re.compile(r"\$\{\{(.*?)\}\}")


def yaml_of(name: str) -> Any:
    return YAML(typ="safe", pure=True).load((TOP / name).read_text(encoding="utf-8"))


@pytest.fixture
def repository(tmp_path: Path) -> Path:
    return make_repository(tmp_path / "work")


def make_repository(top: Path, slot: str = WITHOUT_SPINDLE) -> Path:
    """A repository whose programs lie in `cnc`; by default one of them feeds with the spindle stopped."""
    files = {"cnc/cell.yaml": CELL, "cnc/suite/slot.nc": slot, "cnc/suite/slot.test.yaml": "cell: ../cell.yaml\n"}
    for name, text in files.items():
        (top / name).parent.mkdir(parents=True, exist_ok=True)
        (top / name).write_text(text)
    (top / ".git").mkdir()
    return top


def environment(folder: Path, **more: str) -> dict[str, str]:
    """What a runner's shell has: our commands first, a home of its own, but kernels that are compiled already."""
    kernels = (
        os.environ.get("NUMBA_CACHE_DIR")
        or Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "gcodesim"
    )
    return {
        "PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}",
        "HOME": str(folder),
        "NUMBA_CACHE_DIR": str(kernels),
        "GCODESIM_TEST_CACHE": str(folder / "tests"),
        "LC_ALL": "C.UTF-8",
        **more,
    }


# ---- GitHub Action


@dataclass
class Job:
    """A job that has this action as its only step."""

    workspace: Path
    temporary: Path
    inputs: Mapping[str, str] = field(default_factory=dict)
    printed: str = ""
    status: int = 0
    outputs: dict[str, dict[str, str]] = field(default_factory=dict)

    def run(self) -> Job:
        action = yaml_of("action.yml")
        given = {name: str(one.get("default", "")) for name, one in action["inputs"].items()} | dict(self.inputs)
        self.temporary.mkdir(parents=True)
        assert set(given) == set(action["inputs"])
        for step in action["runs"]["steps"]:
            if "uses" in step or step["id"] == "install" or self.status:
                continue
            output, summary = self.temporary / "output", self.temporary / "summary"
            output.write_text("")
            done = subprocess.run(
                ["bash", "--noprofile", "--norc", "-eo", "pipefail", "-c", step["run"]],
                cwd=self.workspace / self._filled(step.get("working-directory", "."), given),
                env=environment(
                    self.temporary,
                    GITHUB_OUTPUT=str(output),
                    GITHUB_STEP_SUMMARY=str(summary),
                    RUNNER_TEMP=str(self.temporary),
                    **{name: self._filled(text, given) for name, text in step.get("env", {}).items()},
                ),
                capture_output=True,
                text=True,
                check=False,
            )
            self.printed += done.stdout
            self.status = done.returncode
            assert done.returncode in (0, 1), done.stderr
            pairs = [line.split("=", 1) for line in output.read_text().splitlines()]
            self.outputs[step["id"]] = dict(pairs)
        return self

    def _filled(self, text: str, inputs: Mapping[str, str]) -> str:
        """A text with its expressions: these steps use names of `inputs` only."""

        def value(match: re.Match[str]) -> str:
            context, _, name = match[1].strip().partition(".")
            assert context == "inputs"
            return inputs[name]

        return EXPRESSION.sub(value, str(text))

    @property
    def summary(self) -> str:
        return (self.temporary / "summary").read_text()


def test_the_action_fits_the_schema_of_actions() -> None:
    action = yaml_of("action.yml")
    jsonschema.validate(action, get_builtin_schema("vendor.github-actions"))
    used = {match[1].strip() for match in EXPRESSION.finditer((TOP / "action.yml").read_text())}
    inputs = {name.removeprefix("inputs.") for name in used if re.fullmatch(r"inputs\.[\w-]+", name)}
    assert inputs <= set(action["inputs"])
    install = next(step for step in action["runs"]["steps"] if step.get("id") == "install")
    assert install["run"].split()[:4] == ["python", "-m", "pip", "install"] and '"$SOURCE"' in install["run"]
    # no input is pasted into a script: that would let a branch name run commands
    assert not any(EXPRESSION.search(step.get("run", "")) for step in action["runs"]["steps"])


def test_the_action_fails_on_a_finding_and_says_where(repository: Path, tmp_path: Path) -> None:
    job = Job(repository, tmp_path / "t", {"working-directory": "cnc", "paths": "suite"}).run()
    assert job.status == 1
    assert job.outputs["run"] == {"status": "1", "junit": "cnc/gcodesim-junit.xml", "sarif": "cnc/gcodesim.sarif"}
    assert re.search(r"^::error file=cnc/suite/slot\.nc,line=7,.*GS501", job.printed, re.MULTILINE)
    sarif = json.loads((repository / job.outputs["run"]["sarif"]).read_text())
    assert [one["ruleId"] for one in sarif["runs"][0]["results"] if one["level"] == "error"] == ["GS501"]
    assert 'failures="1"' in (repository / job.outputs["run"]["junit"]).read_text()
    assert "FAILED suite/slot" in job.summary and "::error" not in job.summary


def test_the_repaired_program_passes_with_the_same_bytes_everywhere(tmp_path: Path) -> None:
    written = []
    for name in ("a", "somewhere/else/b"):
        repository = make_repository(tmp_path / name, SLOT)
        job = Job(repository, tmp_path / name / "temporary", {"working-directory": "cnc"}).run()
        assert job.status == 0 and job.outputs["run"]["status"] == "0" and "::" not in job.printed
        written.append([(repository / job.outputs["run"][kind]).read_bytes() for kind in ("junit", "sarif")])
    assert written[0] == written[1]
    assert str(tmp_path).encode() not in b"".join(written[0])


def test_the_other_inputs_of_the_action(repository: Path, tmp_path: Path) -> None:
    (repository / "cnc/suite/odd name.nc").write_text("G21\nG1 X5\nM2\n")
    (repository / "known.json").write_text(
        '{"schema": "gcodesim-baseline/1", "findings": [{"file": "cnc/suite/odd name.nc", "code": "GS107",'
        ' "line": "G1 X5", "message": "G1 without a feed: F is #"}]}'
    )
    linted = {"command": "lint", "paths": "cnc/suite/*.nc", "arguments": "--dialect linuxcnc --max-blocks 99"}
    assert Job(repository, tmp_path / "1", linted).run().status == 1
    assert Job(repository, tmp_path / "2", {**linted, "baseline": "known.json"}).run().status == 0
    checked = {"command": "check", "paths": "cnc/suite/slot.nc", "cell": "cnc/cell.yaml", "fail-on": "note"}
    assert Job(repository, tmp_path / "3", checked).run().status == 1


def test_no_file_of_a_pull_request_is_an_option(repository: Path, tmp_path: Path) -> None:
    (repository / "--fail-on=never.nc").write_text("G21\nG1 X5\nM2\n")
    job = Job(repository, tmp_path / "1", {"command": "lint", "paths": "*.nc"}).run()
    assert job.status == 1 and "GS107" in job.printed
    script = yaml_of("docs/gitlab-ci.yml")[".gcodesim"]["script"]
    variables = {"GCODESIM_COMMAND": "lint", "GCODESIM_PATHS": "*.nc", "GCODESIM_ARGUMENTS": ""}
    done = subprocess.run(
        ["sh", "-ec", "\n".join(script)],
        cwd=repository,
        env=environment(tmp_path, **variables),
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 1 and "GS107" in done.stdout


# ---- GitLab template


def test_the_gitlab_job(repository: Path, tmp_path: Path) -> None:
    template = yaml_of("docs/gitlab-ci.yml")
    jsonschema.validate({**template, "gcodesim": {"extends": ".gcodesim"}}, get_builtin_schema("vendor.gitlab-ci"))
    job = template[".gcodesim"]
    install, *before = job["before_script"]
    assert install.startswith("python -m pip install") and '"${GCODESIM_SOURCE:?' in install
    variables = {**job["variables"], "GCODESIM_PATHS": "cnc/suite", "CI_PROJECT_DIR": str(repository)}
    done = subprocess.run(
        ["bash", "-eo", "pipefail", "-c", "\n".join([*before, *job["script"]])],
        cwd=repository,
        env=environment(
            tmp_path, **{name: value.replace("$CI_PROJECT_DIR", str(repository)) for name, value in variables.items()}
        ),
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 1, done.stderr
    for path in job["artifacts"]["paths"]:
        assert (repository / path).is_file()
    assert set(job["artifacts"]["reports"].values()) == set(job["artifacts"]["paths"])
    issues = json.loads((repository / job["artifacts"]["reports"]["codequality"]).read_text())
    assert [
        (issue["check_name"], issue["location"]["path"]) for issue in issues if issue["severity"] == "critical"
    ] == [("GS501", "cnc/suite/slot.nc")]


# ---- pre-commit


def hooks() -> dict[str, dict[str, Any]]:
    return {hook["id"]: hook for hook in yaml_of(".pre-commit-hooks.yaml")}


def run_hook(hook: Mapping[str, Any], folder: Path, home: Path, arguments: tuple[str, ...] = ()) -> int:
    """As pre-commit does it: the entry, then `args`, then all files of the repository that `files` finds."""
    names = sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file())
    passed = [name for name in names if re.search(hook.get("files", ""), name)]
    command = [*shlex.split(hook["entry"]), *hook.get("args", []), *arguments]
    assert passed
    return subprocess.run(
        command + (passed if hook.get("pass_filenames", True) else []),
        cwd=folder,
        env=environment(home),
        capture_output=True,
        check=False,
    ).returncode


def test_hooks_have_what_pre_commit_wants() -> None:
    known = {"id", "name", "description", "entry", "language", "files", "pass_filenames", "always_run", "args", "types"}
    assert list(hooks()) == ["gcodesim-lint", "gcodesim-check", "gcodesim-cell", "gcodesim-test"]
    for hook in hooks().values():
        assert {"id", "name", "entry", "language"} <= hook.keys() <= known
        assert hook["language"] == "python"
        re.compile(hook.get("files", ""))


@pytest.mark.parametrize(("name", "arguments"), [("lint", ()), ("check", ("--cell", "cnc/cell.yaml")), ("test", ())])
def test_hooks_see_a_fault(repository: Path, tmp_path: Path, name: str, arguments: tuple[str, ...]) -> None:
    (repository / "cnc/suite/second.NC").write_text("G21\nG1 X5\nM2\n")
    assert run_hook(hooks()[f"gcodesim-{name}"], repository, tmp_path, arguments) == 1


@pytest.mark.parametrize(("name", "arguments"), [("lint", ()), ("check", ("--cell", "cnc/cell.yaml")), ("cell", ())])
def test_hooks_pass_what_is_good(tmp_path: Path, name: str, arguments: tuple[str, ...]) -> None:
    repository = make_repository(tmp_path / "work", SLOT)
    hook = hooks()[f"gcodesim-{name}"]
    assert run_hook(hook, repository, tmp_path, arguments) == 0


def test_the_hook_of_cells_sees_a_fault(repository: Path, tmp_path: Path) -> None:
    (repository / "cnc/cell.yaml").write_text(CELL.replace("machine:", "machin:"))
    assert run_hook(hooks()["gcodesim-cell"], repository, tmp_path) == 1
