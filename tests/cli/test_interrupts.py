"""Ctrl-C and SIGTERM: a state of its own, in which nothing is accepted and nothing compared."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

import gcodesim
from gcodesim.cli.interrupts import Interrupted, handled
from gcodesim.executor import loop, pacing
from gcodesim.log.logfile import LogFile
from gcodesim.log.reader import decoded
from gcodesim.simulation import one_run

Interrupt = Callable[[int], None]


@pytest.fixture
def interrupt(monkeypatch: pytest.MonkeyPatch) -> Interrupt:
    """Let a Ctrl-C come while a run is in its `after`th window."""

    def interrupt(after: int = 2) -> None:
        move, left = loop.move_through, [after]

        def interrupted(*arguments: Any) -> Any:
            left[0] -= 1
            if left[0] == 0:
                raise KeyboardInterrupt
            return move(*arguments)

        monkeypatch.setattr(loop, "move_through", interrupted)
        monkeypatch.setattr(pacing, "MOST_STEPS", 100)

    return interrupt


def test_accept_accepts_nothing_of_an_interrupted_run(cli, interrupt: Interrupt, tmp_path: Path) -> None:
    interrupt()
    done = cli("accept", "slot.nc", "--cell", "cell.yaml")
    assert (done.status, done.out, done.err) == (130, "", "gcodesim: interrupted\n")
    assert not list(tmp_path.glob("*.golden.json"))


def test_test_compares_nothing_of_an_interrupted_run(cli, interrupt: Interrupt) -> None:
    assert cli("accept", "slot.nc", "--cell", "cell.yaml").status == 0
    interrupt()
    done = cli("test", "slot.nc", "--cell", "cell.yaml")
    assert (done.status, done.out, done.err) == (130, "", "gcodesim: interrupted\n")


def test_diff_of_programs_ends_with_an_interrupt(cli, interrupt: Interrupt) -> None:
    interrupt()
    done = cli("diff", "slot.nc", "slot.nc", "--cell", "cell.yaml")
    assert (done.status, done.out) == (130, "")


@pytest.mark.parametrize("after", [1, 3])
def test_simulate_hands_the_interrupt_on_when_the_files_are_closed(
    cli, interrupt: Interrupt, tmp_path: Path, after: int
) -> None:
    interrupt(after)
    with pytest.raises(KeyboardInterrupt):
        gcodesim.simulate("slot.nc", "cell.yaml", "out")
    assert (tmp_path / "out" / "run.mcap").exists() == (after > 1)  # in the first nothing has happened yet


@pytest.mark.parametrize("after", [2, 3, 5])
def test_the_verdict_says_that_the_run_was_interrupted_and_where(
    cli, interrupt: Interrupt, tmp_path: Path, after: int
) -> None:
    interrupt(after)
    done = cli("run", "slot.nc", "--cell", "cell.yaml", "--junit", "verdict.xml", "--write-baseline", "known.json")
    assert done.status == 130
    assert "slot.nc: interrupted, with 1 error" in done.out and "GS616" in done.out
    results = json.loads((tmp_path / "out" / "results.json").read_text())
    assert results["status"] == "failed"
    assert [finding["code"] for finding in results["findings"] if finding["severity"] == "error"] == ["GS616"]
    assert "GS616" in (tmp_path / "verdict.xml").read_text()
    assert not (tmp_path / "known.json").exists()

    line = results["stopped_at"]["line"]
    assert f"stopped at slot.nc:{line}" in done.out
    told = cli("info", "out", "--format", "json").json
    assert (told["state"], told["stopped_at"]["line"]) == ("interrupted", line)
    refused = cli("diff", "out", "out")
    assert refused.status == 2 and "interrupted" in refused.err


def test_run_and_info_name_the_same_line_wherever_a_run_stops(cli, write, tmp_path: Path, interrupt: Interrupt) -> None:
    """Blocks that begin within a step, at its end, and those in which the machine stands."""
    lines = "".join(f"G1 X{10 + i / 50} F300\nG4 P0.05\n" for i in range(200))
    write("part.nc", f"G21 G90 G17 G94\nT1 M6\nG43 H1\nS8000 M3\nG0 X10 Y10 Z5\n{lines}M5\nM2\n")
    cell = (tmp_path / "cell.yaml").read_text().replace("world: kinematic", "world: kinematic, rate: 250 Hz")
    write("cell.yaml", cell)
    for after in range(14, 26, 2):
        interrupt(after)
        assert cli("run", "part.nc", "--cell", "cell.yaml").status == 130
        results = json.loads((tmp_path / "out" / "results.json").read_text())
        log = LogFile.open(tmp_path / "out" / "run.mcap")
        last = [program for _, program in decoded(log, "/program")][-1]
        assert results["stopped_at"]["line"] == last.line
        assert results["time"]["total_s"] == pytest.approx(log.end_ns * 1e-9, abs=0.01)


@pytest.fixture(params=[signal.SIGTERM, signal.SIGHUP])
def number(request: pytest.FixtureRequest) -> Iterator[signal.Signals]:
    """A signal that nobody ignores; under `nohup`, tests inherit that one is."""
    before = signal.signal(request.param, signal.SIG_DFL)
    yield request.param
    signal.signal(request.param, before)


def test_other_signals_close_the_log_as_well(
    cli, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, number: signal.Signals
) -> None:
    move, left = loop.move_through, [3]

    def killed(*arguments: Any) -> Any:
        left[0] -= 1
        if left[0] == 0:
            signal.raise_signal(number)
        return move(*arguments)

    monkeypatch.setattr(loop, "move_through", killed)
    before = signal.getsignal(number)
    done = cli("run", "slot.nc", "--cell", "cell.yaml")
    assert done.status == 128 + number
    assert "interrupted" in done.out
    assert cli("info", "out", "--format", "json").json["state"] == "interrupted"
    assert signal.getsignal(number) == before


@pytest.mark.parametrize(("together_s", "is_closed"), [(60.0, True), (0.0, False)])
def test_two_signals_that_come_together_are_one(
    cli, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, together_s: float, is_closed: bool
) -> None:
    """`timeout` sends one to the process and one to its group; a second Ctrl-C of a person comes later."""
    move, results_of, left = loop.move_through, one_run.results_of, [3]

    def first(*arguments: Any) -> Any:
        left[0] -= 1
        if left[0] == 0:
            signal.raise_signal(signal.SIGTERM)
        return move(*arguments)

    def second(*arguments: Any, **named: Any) -> Any:
        signal.raise_signal(signal.SIGTERM)
        return results_of(*arguments, **named)

    monkeypatch.setattr(loop, "move_through", first)
    monkeypatch.setattr(one_run, "results_of", second)
    monkeypatch.setattr("gcodesim.cli.simulate._TOGETHER_S", together_s)
    assert cli("run", "slot.nc", "--cell", "cell.yaml").status == 143
    assert (tmp_path / "out" / "results.json").exists() == is_closed


def test_sigterm_ends_other_commands_without_a_trace(cli, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("gcodesim.cli.simulate.check", lambda *_: signal.raise_signal(signal.SIGTERM))
    done = cli("check", "slot.nc", "--cell", "cell.yaml")
    assert (done.status, done.out, done.err) == (143, "", "gcodesim: interrupted\n")


def test_a_signal_in_a_run_of_test_and_accept_has_its_own_status(
    cli, monkeypatch: pytest.MonkeyPatch, number: signal.Signals
) -> None:
    """The run ends in order, and what it tells of that says nothing of the signal."""
    monkeypatch.setattr(loop, "move_through", lambda *_: signal.raise_signal(number))
    for command in ("accept", "test"):
        done = cli(command, "slot.nc", "--cell", "cell.yaml")
        assert (done.status, done.err) == (128 + number, "gcodesim: interrupted\n")


def test_a_signal_before_a_run_moves_ends_it_at_once(cli, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Planning may take minutes, and nothing is open yet that would be closed."""
    monkeypatch.setattr("gcodesim.cli.simulate.prepare", lambda *_: signal.raise_signal(signal.SIGTERM))
    done = cli("run", "slot.nc", "--cell", "cell.yaml")
    assert (done.status, done.out, done.err) == (143, "", "gcodesim: interrupted\n")
    assert not (tmp_path / "out").exists()


def test_a_signal_when_all_has_moved_is_no_success(cli, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """The files are whole, since they are closed first; but whoever goes on with `&&` does not."""
    results_of = one_run.results_of

    def signalled(*arguments: Any, **named: Any) -> Any:
        signal.raise_signal(signal.SIGTERM)
        return results_of(*arguments, **named)

    monkeypatch.setattr(one_run, "results_of", signalled)
    done = cli("run", "slot.nc", "--cell", "cell.yaml", "--write-baseline", "known.json")
    assert done.status == 143
    assert "interrupted when the run was over; what it wrote is whole" in done.err
    assert cli("info", "out", "--format", "json").json["state"] == "finished"
    assert not (tmp_path / "known.json").exists()


def test_a_signal_between_two_setups_ends_the_job(cli, write, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    one = "{program: slot.nc, cell: cell.yaml}"
    write("job.yaml", f"gcodesim-job: 1\nsetups:\n  a: {one}\n  b: {one}\n")
    results_of = one_run.results_of

    def signalled(*arguments: Any, **named: Any) -> Any:
        signal.raise_signal(signal.SIGTERM)
        return results_of(*arguments, **named)

    monkeypatch.setattr(one_run, "results_of", signalled)
    done = cli("run", "job.yaml")
    assert (done.status, "1 of 2 set-ups" in done.out) == (143, True)
    assert not (tmp_path / "out" / "b").exists()
    assert not (tmp_path / "out" / "setups.json").exists()


_HELLO = {
    "lsp": {"processId": None, "rootUri": None, "capabilities": {}},
    "mcp": {"protocolVersion": "2025-03-26", "capabilities": {}, "clientInfo": {"name": "test", "version": "1"}},
}


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("command", _HELLO)
def test_servers_end_while_their_client_says_nothing(command: str, number: signal.Signals, tmp_path: Path) -> None:
    """Their standard input stays open, as that of an editor that hangs, or of a shell."""
    hello = json.dumps({"jsonrpc": "2.0", "id": 1, "method": "initialize", "params": _HELLO[command]}).encode()
    begin = "import signal, sys; signal.signal(signal.SIGINT, signal.default_int_handler)"
    server = subprocess.Popen(
        [sys.executable, "-c", f"{begin}; from gcodesim.cli import main; sys.exit(main([{command!r}]))"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        cwd=tmp_path,
    )
    assert server.stdin and server.stdout and server.stderr
    try:
        server.stdin.write(hello + b"\n" if command == "mcp" else b"Content-Length: %d\r\n\r\n" % len(hello) + hello)
        server.stdin.flush()
        server.stdout.readline()  # it is there
        server.send_signal(number)
        assert server.wait(600) == 128 + number
        assert server.stderr.read().endswith(b"gcodesim: interrupted\n")
    finally:
        server.kill()
        server.wait()
        for pipe in (server.stdin, server.stdout, server.stderr):
            pipe.close()


_UNHEARD = """
import os, select, signal, threading
from gcodesim.cli.interrupts import left_at_once

with left_at_once():
    threading.Timer(0.2, os.kill, [os.getpid(), signal.SIGTERM]).start()
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGTERM})  # another thread gets it, and this one waits on
    select.select([], [], [])
"""


def test_a_server_ends_also_where_its_main_thread_does_not_hear_the_signal() -> None:
    """As when it comes between the last look at signals and the wait for the client."""
    done = subprocess.run([sys.executable, "-c", _UNHEARD], capture_output=True, timeout=600)
    assert (done.returncode, done.stderr) == (143, b"gcodesim: interrupted\n")


_WHILE_LOADING = """
import os, runpy, signal, sys

class Finder:
    def find_spec(self, name, path=None, target=None):
        if name == "gcodesim.cli.parser":
            os.kill(os.getpid(), signal.SIGINT)

sys.meta_path.insert(0, Finder())
sys.argv = ["gcodesim", "explain", "GS203"]
runpy.run_module("gcodesim", run_name="__main__")
"""


@pytest.mark.parametrize(("ignored", "status"), [(False, 130), (True, 0)], ids=["in front", "in the background"])
def test_a_ctrl_c_while_modules_are_loaded_is_no_traceback(ignored: bool, status: int) -> None:
    handler = "SIG_IGN" if ignored else "default_int_handler"  # a test may itself run where it is ignored
    begin = f"import signal; signal.signal(signal.SIGINT, signal.{handler})\n"
    done = subprocess.run([sys.executable, "-c", begin + _WHILE_LOADING], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (status, "" if ignored else "gcodesim: interrupted\n")
    assert bool(done.stdout) is ignored


def test_the_command_begins_where_that_is_taken_care_of() -> None:
    text = (Path(gcodesim.__file__).parents[1] / "pyproject.toml").read_text()
    assert 'gcodesim = "gcodesim.__main__:main"' in text


def test_a_signal_that_python_passes_over_comes_again() -> None:
    """What is raised in a destructor goes nowhere; a command went on computing then."""

    class Fading:
        def __del__(self) -> None:
            signal.raise_signal(signal.SIGTERM)

    begin = time.monotonic()
    with pytest.raises(Interrupted) as raised, handled() as heard:
        Fading()
        time.sleep(600.0)
    assert time.monotonic() - begin < 300.0  # it does not only come once nobody waits any more
    assert (raised.value.number, heard.number) == (signal.SIGTERM, signal.SIGTERM)


def test_other_faults_in_destructors_are_told_as_ever() -> None:
    class Broken:
        def __del__(self) -> None:
            raise ValueError("in a destructor")

    told: list[Any] = []
    before, sys.unraisablehook = sys.unraisablehook, told.append
    try:
        with handled():
            Broken()
        assert sys.unraisablehook == told.append
    finally:
        sys.unraisablehook = before
    assert [type(one.exc_value) for one in told] == [ValueError]
