"""Each code of each dialect has a meaning in words."""

import pytest

from gcodesim.cli import main
from gcodesim.rs274.dialects import DIALECTS
from gcodesim.rs274.dialects.meanings import meanings_of
from gcodesim.rs274.marlin.codes import CODES
from gcodesim.rs274.marlin.machine_moves import MACHINE_MOVES
from gcodesim.rs274.marlin.moves import MOVES


@pytest.mark.parametrize("name", DIALECTS)
def test_every_code_means_something(name):
    dialect = DIALECTS[name]
    codes = {f"G{code / 10:g}" for code in dialect.g_groups} | {f"M{code}" for code in dialect.m_groups}
    if dialect.prints:
        codes = {*CODES, *MOVES, *MACHINE_MOVES}

    assert codes - set(meanings_of(dialect)) == set()


def test_the_same_code_differs_between_controls():
    assert meanings_of(DIALECTS["linuxcnc"])["G76"] != meanings_of(DIALECTS["fanuc"])["G76"]
    assert "Q" in meanings_of(DIALECTS["linuxcnc"])["G71"]
    assert "P to Q" in meanings_of(DIALECTS["fanuc_lathe"])["G71"]


def test_explain_tells_it(capsys):
    assert main(["explain", "g043.0"]) == 0
    assert "tool length on, offset H (fanuc, fanuc_lathe, fanuc_lathe_b)" in capsys.readouterr().out
    assert main(["explain", "G999"]) == 2
