"""`gcodesim mcp`: what a client of the protocol gets, and that the tools stay in their folder."""

from __future__ import annotations

import asyncio
import json
import os
import subprocess
import sys
from functools import partial
from pathlib import Path
from typing import Any

import anyio
import pytest
from mcp import ClientSession, StdioServerParameters, stdio_client
from mcp.types import CallToolResult

from gcodesim.cli.folder_tools import FolderTools, stop_calls, stoppable

PROGRAM = "G21 G90\nG1 X10 F100\nG1 Y\nM2\n"
CELL = "gcodesim: 1\nmachine: gantry_xyz\nsimulation: {world: kinematic}\n"


async def _asked(folder: Path, calls: list[tuple[str, dict[str, str]]]) -> tuple[set[str], list[CallToolResult]]:
    """Names of the tools and answers to calls, as a client of the protocol gets them."""
    command = StdioServerParameters(
        command=sys.executable, args=["-m", "gcodesim", "mcp", str(folder)], env=dict(os.environ)
    )
    async with stdio_client(command) as (reading, writing), ClientSession(reading, writing) as session:
        await session.initialize()
        tools = {tool.name for tool in (await session.list_tools()).tools}
        return tools, [await session.call_tool(name, words) for name, words in calls]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    inside = tmp_path / "inside"
    inside.mkdir()
    (inside / "part.nc").write_text(PROGRAM)
    (inside / "good.nc").write_text("G21 G90\nG1 X10 F100\nM2\n")
    (inside / "cell.yaml").write_text(CELL)
    (tmp_path / "secret.nc").write_text("G1 X1\n")
    return inside


def test_the_tools_answer_a_client_what_the_commands_print(folder: Path) -> None:
    both = {"program": "good.nc", "cell": "cell.yaml"}
    calls = [("lint", {"program": "part.nc"}), ("check", both), ("explain", {"code": "GS203"}), ("lint", both)]
    calls += [("lint", {"program": "../secret.nc"}), ("lint", {"no": "program"})]
    calls += [("lint", {"program": "good.nc", "language": "fanuc"})]

    names, (linted, checked, explained, clean, outside, wrong, unknown) = asyncio.run(_asked(folder, calls))
    printed = subprocess.run(
        [sys.executable, "-m", "gcodesim", "lint", "part.nc", "--format", "json"], cwd=folder, capture_output=True
    )

    assert names == {"lint", "check", "run", "diff", "explain"}
    said = linted.structured_content
    assert said is not None and said["exit_status"] == printed.returncode == 1
    assert said["output"] == json.loads(printed.stdout)
    assert json.loads(linted.content[0].text) == said  # type: ignore[union-attr]
    assert checked.structured_content["exit_status"] == 0  # type: ignore[index]
    assert checked.structured_content["output"]["time"]["feed_s"] > 0.0  # type: ignore[index]
    assert explained.structured_content["output"].startswith("GS203")  # type: ignore[index]
    assert clean.structured_content == {"exit_status": 0, "output": {"findings": []}, "messages": ""}
    assert outside.structured_content["exit_status"] == 2  # type: ignore[index]
    assert wrong.is_error and "program" in wrong.content[0].text  # type: ignore[union-attr]
    assert unknown.is_error and "language" in unknown.content[0].text  # type: ignore[union-attr]  # it is not skipped


def test_a_program_is_read_in_the_language_that_is_asked_for(folder: Path) -> None:
    (folder / "fanuc.nc").write_text("%\nO0001\nG21 G90\nG65 P9000 A1.\nM30\n%\n")
    tools = FolderTools(folder)
    codes = {
        language: {found["code"] for found in tools.lint("fanuc.nc", dialect=language)["output"]["findings"]}
        for language in ("", "fanuc")
    }
    assert "GS012" in codes[""] and "GS012" not in codes["fanuc"]
    wrong = tools.lint("fanuc.nc", dialect="klingon")
    assert wrong["exit_status"] == 2 and "klingon" in wrong["messages"]
    for code in ("", " ", "--help"):
        assert tools.explain(code)["messages"] == f"`{code}` is no code of a finding"


def test_run_writes_into_the_folder_and_diff_compares(folder: Path) -> None:
    tools = FolderTools(folder)

    assert tools.run("good.nc", "cell.yaml", "out")["exit_status"] == 0
    assert (folder / "out" / "run.mcap").exists()
    assert tools.diff("good.nc", "good.nc", "cell.yaml")["exit_status"] == 0


@pytest.mark.parametrize("how", ["cancelled", "the server leaves"])
def test_a_call_that_nobody_waits_for_ends_its_process(how: str, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It went on for up to ten minutes, and with it the server whose client had gone."""
    moves = "".join(f"G1 X{k % 50} Y{k * 7 % 30} F100\n" for k in range(100_000))
    (folder / "long.nc").write_text(f"G21 G90\n{moves}M2\n")
    started: list[subprocess.Popen[bytes]] = []
    start = subprocess.Popen

    def kept(*words: Any, **more: Any) -> subprocess.Popen[bytes]:
        started.append(start(*words, **more))
        return started[-1]

    monkeypatch.setattr(subprocess, "Popen", kept)

    async def asked() -> None:
        async with anyio.create_task_group() as tasks:
            tasks.start_soon(partial(stoppable(FolderTools(folder).run), program="long.nc", cell="cell.yaml"))
            while not started:
                await anyio.sleep(0.01)
            if how == "cancelled":
                tasks.cancel_scope.cancel()
            else:
                stop_calls()

    anyio.run(asked)
    assert started[0].wait() < 0


def test_no_text_of_a_stranger_is_hidden_in_an_answer(folder: Path) -> None:
    """A model would read what people do not see: marks of direction, blanks of no width, invisible letters."""
    hidden = "\u202e\u200b\U000e0041\U000e007f\x1b[2J"
    (folder / "cell.yaml").write_text(
        f"{CELL}tools: {{1: {{type: drill, diameter: 6, name: {json.dumps('a' + hidden)}}}}}\n"
    )
    (folder / "good.nc").write_text(f"G21 G90\nT1 M6 ({hidden})\n(MSG,{hidden})\nG1 X10 F100\nM2\n")
    for answer in (FolderTools(folder).check("good.nc", "cell.yaml"), FolderTools(folder).lint("good.nc")):
        text = json.dumps(answer, ensure_ascii=False)
        assert not set(text) & set(hidden[:5])
    assert "a\\\\u202e" in json.dumps(FolderTools(folder).check("good.nc", "cell.yaml"))


@pytest.mark.parametrize("path", ["../secret.nc", "/etc/passwd", "link.nc", "sub/../../secret.nc", "a\0b"])
def test_no_path_leads_out_of_the_folder(path: str, folder: Path) -> None:
    (folder / "link.nc").symlink_to(folder.parent / "secret.nc")
    tools = FolderTools(folder)

    for answer in (
        tools.lint(path),
        tools.check("good.nc", path),
        tools.run("good.nc", "cell.yaml", path),
        tools.diff("good.nc", path),
    ):
        assert answer == {
            "exit_status": 2,
            "output": None,
            "messages": f"`{path}` is outside the folder that is served",
        }
    assert not (folder.parent / "run.mcap").exists()


def test_a_cell_names_no_folder_outside(folder: Path) -> None:
    (folder / "wide.yaml").write_text(CELL + "packages: {other: ../..}\n")

    answer = FolderTools(folder).check("good.nc", "wide.yaml")

    assert answer["messages"] == "`../..` in wide.yaml is outside the folder that is served"


def test_nothing_in_the_folder_starts_python(folder: Path) -> None:
    """Neither modules named like ours, nor options in a name, nor what a program or a cell says."""
    evil = "from pathlib import Path\nPath('started').write_text('x')\n"
    for name in ("gcodesim.py", "numpy.py", "sitecustomize.py", "evil.py", "M100", "M100.py", "sub.py"):
        (folder / name).write_text(evil)
        (folder / name).chmod(0o755)
    (folder / "evil.nc").write_text(
        "G21 G90\nM100 P1\no<sub> call\no<evil.py> call\n(PYTHON, import evil)\n;py,import evil\nM2\n"
    )
    for number, lines in enumerate(
        [
            "m_codes: {M100: {python: evil.py}}\n",
            "x-python: evil.py\npython: evil.py\n",
            "tools: {1: {type: 'evil:Tool'}}\n",
            "tools: {1: !!python/object/apply:os.system ['touch started']}\n",
            "simulation: {world: 'evil:World'}\n",
            "subroutines: [.]\n",
        ]
    ):
        (folder / f"cell{number}.yaml").write_text(CELL.replace("simulation", "x-old") + lines)
    tools = FolderTools(folder)

    answers = [tools.lint("evil.nc"), tools.lint("-c"), tools.explain("--help")]
    answers += [tools.run("evil.nc", f"cell{number}.yaml", f"out{number}") for number in range(6)]

    assert not list(folder.rglob("started")), answers
    assert all(answer["exit_status"] in (1, 2) for answer in answers), answers
