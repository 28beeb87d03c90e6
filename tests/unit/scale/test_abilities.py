"""Who may work."""

from __future__ import annotations

import pytest

from gcodesim.scale.abilities import abilities, misfits
from gcodesim.scale.crew import _why_not

HERE = {"gcodesim": "1", "python": "3.11", "numpy": "2", "pycollada": "0.9", "numba": "none", "code": "abc"}


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({}, []),
        ({"python": "3.12"}, []),
        ({"gcodesim": "2", "code": "x"}, ["gcodesim 2 in place of 1"]),
        ({"numpy": "1"}, ["numpy 1 in place of 2"]),
        ({"pycollada": "none"}, ["no pycollada"]),
        ({"pycollada": "0.8"}, []),
        ({"numba": "0.6"}, ["numba 0.6 in place of none"]),
        ({"code": "x"}, ["the sources of gcodesim, or of packages that extend it, differ from those here"]),
    ],
)
def test_same_results_or_no_work(change: dict[str, str], told: list[str]):
    assert misfits({**HERE, **change}, HERE) == told


def test_this_process_fits_itself():
    assert misfits(abilities(), abilities()) == []
    assert len(abilities()["code"]) == 64


@pytest.mark.parametrize("reply", [b"[]", b"\x80\x04", None, ValueError("no"), ModuleNotFoundError("gcodesim")])
def test_whoever_does_not_answer_as_we_do_gets_no_work(reply: object):
    assert len(_why_not(reply)) == 1
