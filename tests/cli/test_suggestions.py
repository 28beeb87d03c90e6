"""Commands, options and names that do not exist: status 2, and what was meant."""

from __future__ import annotations

import pytest

CELL = ("--cell", "cell.yaml")


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (("rnu",), "gcodesim: there is no command rnu; did you mean run?"),
        (("warm_up",), "there is no command warm_up; did you mean warm-up?"),
        (("validate", "cell.yaml"), "there is no command validate; did you mean cell validate?"),
        (("cell", "validat", "cell.yaml"), "gcodesim cell: there is no action validat; did you mean validate?"),
        (("slot.nc",), "slot.nc is no command; did you mean gcodesim run slot.nc?"),
        (("run", "slot.nc", "--cll", "cell.yaml"), "gcodesim run: there is no option --cll; did you mean --cell?"),
        (("run", "slot.nc", "--cll=cell.yaml"), "there is no option --cll; did you mean --cell?"),
        (("cell", "show", "cell.yaml", "--formt", "json"), "there is no option --formt; did you mean --format?"),
        (("canon", "slot.nc", "--out", "x"), "there is no option --out; it is one of run, place, restart"),
        (("list", "tool"), "did you mean tools?"),
        (("run", "slot.nc", *CELL, "--world", "bulet"), "cannot be bulet, only kinematic, bullet; did you mean"),
        (("canon", "slot.nc", "--dialect", "fanuk"), "there is no dialect fanuk; did you mean fanuc?"),
        (("schema", "reslts"), "there is no schema reslts; did you mean results"),
        (("explain", "GS23"), "there is no finding GS23; did you mean"),
        (("completion", "bsh"), "did you mean bash"),
        (("list", "tools", "machines"), "machines is one too many"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, tuple) else "",
)
def test_what_was_meant(cli, arguments: tuple[str, ...], told: str) -> None:
    done = cli(*arguments)

    assert done.status == 2 and not done.out
    assert told in done.err
    assert len(done.err.splitlines()) == 1


@pytest.mark.parametrize("arguments", [("zzzz",), ("run", "slot.nc", *CELL, "--zzzz"), ("run", "slot.nc", *CELL, "-z")])
def test_nothing_is_guessed_where_nothing_is_near(cli, arguments: tuple[str, ...]) -> None:
    done = cli(*arguments)

    assert done.status == 2 and "there is no" in done.err and "did you mean" not in done.err


def test_words_behind_two_dashes_are_no_options(cli, write) -> None:
    write("--odd.nc", "G21 G90\nM2\n")

    assert cli("lint", "--", "--odd.nc").status == 0


def test_names_of_files_become_no_commands_of_a_terminal(cli) -> None:
    done = cli("\x1b[2Jrun\n::warning::x")

    assert done.status == 2 and "\x1b" not in done.err and len(done.err.splitlines()) == 1


def test_without_a_command_the_help_is_shown(cli) -> None:
    for arguments in ((), ("cell",)):
        done = cli(*arguments)
        assert done.status == 2 and not done.out
        assert "usage: gcodesim" in done.err
