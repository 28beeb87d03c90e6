"""Completion in real shells: the script is sourced there, and the shell is asked what it would complete."""

from __future__ import annotations

import os
import pty
import re
import select
import shutil
import subprocess
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from gcodesim.cli.outline import Command, outline
from gcodesim.cli.parser import build_parser
from gcodesim.diagnostics import codes

WHOLE = outline(build_parser())
LEAVES = {command.name: command for command in WHOLE.leaves()}

Ask = Callable[[str], set[str]]

_BASH = """source script.bash
COMP_WORDS=("$@"); COMP_CWORD=$(( $# - 1 )); COMPREPLY=()
_gcodesim
printf '%s\\n' "${COMPREPLY[@]}"
"""


def _shell(name: str) -> str:
    path = shutil.which(name)
    if path is None:
        pytest.skip(f"{name} is not installed here")
    return path


@pytest.fixture
def folder(cli, write, tmp_path: Path) -> Path:
    for shell in ("bash", "zsh", "fish"):
        done = cli("completion", shell)
        assert done.status == 0 and not done.err
        write(f"script.{shell}", done.out)
    for name in ("part.nc", "part two.ngc", "notes.txt", "run.mcap"):
        write(name, "")
    (tmp_path / "parts").mkdir()
    return tmp_path


def words_of(line: str) -> list[str]:
    """The words as bash cuts them: `=` is one of its own, and the last word may be empty."""
    words = re.findall(r"=|[^\s=]+", line)
    return [*words, ""] if line.endswith(" ") else words


@pytest.fixture
def bash(folder: Path) -> Ask:
    def ask(line: str) -> set[str]:
        command = [_shell("bash"), "--norc", "-c", _BASH, "bash", *words_of(line)]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True)
        assert not done.stderr
        return set(done.stdout.split("\n")) - {""}

    return ask


@pytest.fixture
def fish(folder: Path, tmp_path_factory: pytest.TempPathFactory) -> Ask:
    home = str(tmp_path_factory.mktemp("home"))

    def ask(line: str) -> set[str]:
        code = f"source script.fish; complete -C '{line}'"
        environment = {**os.environ, "HOME": home, "XDG_CONFIG_HOME": home, "TERM": "dumb"}
        command = [_shell("fish"), "--no-config", "-c", code]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True, env=environment)
        assert not done.stderr
        return {row.split("\t")[0] for row in done.stdout.splitlines()}

    return ask


def typed(shell: list[str], folder: Path, set_up: str, keys: str, *, until: str) -> str:
    """The screen of an interactive shell after `keys`, when `until` has come or some minutes are over."""
    pid, terminal = pty.fork()
    if pid == 0:  # pragma: no cover
        os.chdir(folder)
        os.execve(shell[0], shell, {"PATH": os.environ["PATH"], "HOME": str(folder), "TERM": "dumb", "PS1": "> "})
    said = b""

    def read(mark: bytes) -> None:
        nonlocal said
        end = time.monotonic() + 300
        while mark not in said and time.monotonic() < end:
            if select.select([terminal], [], [], 0.1)[0]:
                said += os.read(terminal, 65536)

    os.write(terminal, f"{set_up}; echo re''ady\n".encode())
    read(b"ready\r\n")
    os.write(terminal, keys.encode())
    read(until.encode())
    os.write(terminal, b"\x03\nexit\n")
    os.close(terminal)
    os.waitpid(pid, 0)
    return said.decode(errors="replace")


@pytest.mark.parametrize("shell", ["bash", "fish"])
class TestAsked:
    """Shells that can be asked without a terminal."""

    @pytest.fixture
    def ask(self, request: pytest.FixtureRequest, shell: str) -> Ask:
        return request.getfixturevalue(shell)

    def test_commands(self, ask: Ask) -> None:
        assert ask("gcodesim ") >= {action.path[-1] for action in WHOLE.actions}
        assert ask("gcodesim re") == {"report", "restart"}
        assert ask("gcodesim cell ") == {"validate", "show", "schema"}

    def test_options_of_each_command(self, ask: Ask) -> None:
        for name, command in LEAVES.items():
            own = {name for option in command.options for name in option.names if name.startswith("--")}
            assert {word.rstrip("=") for word in ask(f"gcodesim {name} --")} == own, name

    def test_choices(self, ask: Ask) -> None:
        assert ask("gcodesim run part.nc --world ") == {"kinematic", "bullet"}
        assert {word.rpartition("=")[2] for word in ask("gcodesim run --world=b")} == {"bullet"}
        assert ask("gcodesim list ma") == {"machines", "materials"}
        assert {"fanuc", "linuxcnc"} <= ask("gcodesim lint part.nc --dialect ")
        assert {"csv", "rosbag2"} <= ask("gcodesim export out --to ")
        assert {"results", "cell"} <= ask("gcodesim schema ")

    def test_codes_of_findings(self, ask: Ask) -> None:
        own = {code.code for code in codes()}
        assert ask("gcodesim explain GS") == own
        assert ask("gcodesim explain GS50") == {code for code in own if code.startswith("GS50")}

    def test_programs_and_cells(self, ask: Ask) -> None:
        programs = {name.replace("\\", "").rstrip("/") for name in ask("gcodesim run ")}
        assert programs == {"part.nc", "part two.ngc", "slot.nc", "parts"}
        cells = {name.rstrip("/") for name in ask("gcodesim check part.nc --cell ")} - {"parts"}
        assert {"arm.yaml", "cell.yaml"} <= cells and not any(name.endswith((".nc", ".txt")) for name in cells)
        assert ask("gcodesim lint not") == {"notes.txt"}  # a program may have any name
        assert {name.rstrip("/") for name in ask("gcodesim run part.nc --out ")} == {"parts"}
        assert ask("gcodesim info run") == {"run.mcap"}

    def test_behind_a_number_nothing_is_offered(self, ask: Ask) -> None:
        assert not ask("gcodesim run part.nc --max-blocks ")


def test_a_real_bash_completes_what_is_typed(folder: Path) -> None:
    shell = [_shell("bash"), "--norc", "--noprofile", "-i"]
    screen = typed(shell, folder, "source script.bash", "echo; gcodesim rep\t ou", until="report  ou")
    assert "gcodesim report " in screen
    screen = typed(shell, folder, "source script.bash", "gcodesim run part\\ \t", until="ngc ")
    assert "gcodesim run part\\ two.ngc " in screen


@pytest.mark.parametrize(
    ("keys", "line"),
    [
        ("gcodesim rep\t", "gcodesim report "),
        ("gcodesim cell val\t", "gcodesim cell validate "),
        ("gcodesim run part.nc --wor\tb\t", "gcodesim run part.nc --world=bullet "),
        ("gcodesim check part.nc --cell ce\t", "gcodesim check part.nc --cell cell.yaml "),
        ("gcodesim explain GS50\t1\t", "gcodesim explain GS501 "),
        ("gcodesim lint sl\t", "gcodesim lint slot.nc "),
        ("gcodesim init --from sl\t", "gcodesim init --from slot.nc "),
        ("gcodesim warm\t", "gcodesim warm-up "),
    ],
)
def test_a_real_zsh_completes_what_is_typed(folder: Path, keys: str, line: str) -> None:
    shell = [_shell("zsh"), "-f", "-i"]
    show = "show() { print -r -- \"<$BUFFER>\" }; zle -N show; bindkey '^X' show"
    set_up = f"autoload -Uz compinit && compinit -u -D; {show}; source script.zsh"
    screen = typed(shell, folder, set_up, f"{keys}\x18", until=f"<{line}>")

    assert f"<{line}>" in screen, screen


def test_every_value_says_what_it_may_be() -> None:
    """A path without a known kind, and a choice without words, would be completed with nothing."""
    values = [
        value
        for command in LEAVES.values()
        for value in (*command.places, *(option.value for option in command.options if option.value is not None))
    ]
    free = {value.name for value in values if not (value.words or value.files or value.folders)}
    lengths = {"MM", "X,Y,Z"}
    assert free - lengths == {
        *("N", "S", "DAY", "PORT", "ORIGIN", "T", "FROM:TO", "FIRST:LAST", "NAME=VALUE", "NAME=PROGRAM", "A,B", "NAME"),
        *("NAME=OUTPUT", "HOST:PORT", "DEG", "CHANNEL", "CHANNEL/OTHER=OUTPUT:INPUT"),
        *("0|1", "FACTOR", "STEP", "OPTIONS", "ADDRESS", "AXIS=PLACE", "DISTANCE"),
    }


def test_the_outline_has_the_whole_command_line() -> None:
    def options(command: Command) -> set[str]:
        return {name for one in command.leaves() for option in one.options for name in option.names}

    parser = build_parser()
    [commands] = [action for action in parser._actions if action.choices]
    for name, of in commands.choices.items():  # type: ignore[union-attr]
        [command] = [action for action in WHOLE.actions if action.path == (name,)]
        shown = set(re.findall(r"(?m)^  (?:-\w[^,\n]*, )?(--[a-z][\w-]+)", of.format_help()))  # type: ignore[attr-defined]
        assert shown
        assert shown <= options(command)
        assert command.says and "%" not in command.says
