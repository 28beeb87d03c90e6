"""`gcodesim mcp`: the tools that it offers, by the protocol, and that they stay in their folder."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from gcodesim.cli.folder_tools import FolderTools

PROGRAM = "G21 G90\nG1 X10 F100\nG1 Y\nM2\n"
CELL = "gcodesim: 1\nmachine: gantry_xyz\nsimulation: {world: kinematic}\n"


class Client:
    """The other end of standard input and output: one JSON message a line."""

    def __init__(self, server: subprocess.Popen[str]) -> None:
        self._server, self._number = server, 0

    def tell(self, method: str, **parameters: Any) -> None:
        assert self._server.stdin is not None
        self._server.stdin.write(json.dumps({"jsonrpc": "2.0", "method": method, "params": parameters}) + "\n")
        self._server.stdin.flush()

    def ask(self, method: str, **parameters: Any) -> Any:
        assert self._server.stdin is not None and self._server.stdout is not None
        self._number += 1
        message = {"jsonrpc": "2.0", "id": self._number, "method": method, "params": parameters}
        self._server.stdin.write(json.dumps(message) + "\n")
        self._server.stdin.flush()
        while True:
            answer = json.loads(self._server.stdout.readline())
            if answer.get("id") == self._number:
                assert "error" not in answer, answer
                return answer["result"]

    def call(self, name: str, **arguments: str) -> Any:
        result = self.ask("tools/call", name=name, arguments=arguments)
        assert not result.get("isError"), result
        return json.loads(result["content"][0]["text"])


@contextmanager
def _served(folder: Path) -> Iterator[Client]:
    command = [sys.executable, "-m", "gcodesim", "mcp", str(folder)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as server:
        client = Client(server)
        own = {"name": "test", "version": "1"}
        client.ask("initialize", protocolVersion="2025-06-18", capabilities={}, clientInfo=own)
        client.tell("notifications/initialized")
        try:
            yield client
        finally:
            assert server.stdin is not None
            server.stdin.close()
            server.wait(600)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    inside = tmp_path / "inside"
    inside.mkdir()
    (inside / "part.nc").write_text(PROGRAM)
    (inside / "good.nc").write_text("G21 G90\nG1 X10 F100\nM2\n")
    (inside / "cell.yaml").write_text(CELL)
    (tmp_path / "secret.nc").write_text("G1 X1\n")
    return inside


def test_the_tools_answer_what_the_commands_print(folder: Path) -> None:
    with _served(folder) as client:
        names = {tool["name"] for tool in client.ask("tools/list")["tools"]}
        linted = client.call("lint", program="part.nc")
        checked = client.call("check", program="good.nc", cell="cell.yaml")
        explained = client.call("explain", code="GS203")
    printed = subprocess.run(
        [sys.executable, "-m", "gcodesim", "lint", "part.nc", "--format", "json"], cwd=folder, capture_output=True
    )

    assert names == {"lint", "check", "run", "diff", "explain"}
    assert linted["exit_status"] == printed.returncode == 1
    assert [f["code"] for f in linted["output"]["findings"]] == [
        f["code"] for f in json.loads(printed.stdout)["findings"]
    ]
    assert checked["exit_status"] == 0 and checked["output"]["time"]["feed_s"] > 0.0
    assert explained["output"].startswith("GS203")


def test_run_writes_into_the_folder_and_diff_compares(folder: Path) -> None:
    tools = FolderTools(folder)

    assert tools.run("good.nc", "cell.yaml", "out")["exit_status"] == 0
    assert (folder / "out" / "run.mcap").exists()
    assert tools.diff("good.nc", "good.nc", "cell.yaml")["exit_status"] == 0


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
