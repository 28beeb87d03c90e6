"""Sines that Bullet calls: the nearest doubles, whatever the processor, and where it finds them."""

from __future__ import annotations

import ctypes
import math
import platform
import sys

import numpy as np
import pytest

from gcodesim.arithmetic import scalars
from gcodesim.world import engine_sines
from gcodesim.world.bullet import import_pybullet

pytestmark = pytest.mark.skipif(
    not (sys.platform == "linux" and platform.machine() == "x86_64"), reason="PyBullet has wheels for nothing else"
)
ONE = ctypes.CFUNCTYPE(ctypes.c_double, ctypes.c_double)
NUMBER = ctypes.POINTER(ctypes.c_double)
BOTH = ctypes.CFUNCTYPE(None, ctypes.c_double, NUMBER, NUMBER)


@pytest.fixture(scope="module")
def addresses():
    return engine_sines._instructions()


@pytest.mark.parametrize("name", ["sin", "cos", "tan"])
def test_they_are_as_good_as_our_own(addresses, name):
    """Both are nearly always the nearest double: the last bit differs in less than one of a hundred."""
    function, own = ONE(addresses[name]), getattr(scalars, name)
    angles = np.random.default_rng(5).uniform(-20.0, 20.0, 4000).tolist()
    off = [abs(function(x) - own(x)) / math.ulp(own(x)) for x in angles]
    assert max(off) <= 1.0 and sum(value > 0.0 for value in off) < 40
    assert function(0.0) == (1.0 if name == "cos" else 0.0)


def test_both_at_once_are_those_of_the_single_ones(addresses):
    sine, cosine, both = ONE(addresses["sin"]), ONE(addresses["cos"]), BOTH(addresses["sincos"])
    for x in (-3.0, -0.0, 1e-300, 0.5, 1e6, 2.0**80):
        a, b = ctypes.c_double(), ctypes.c_double()
        both(x, a, b)
        assert (a.value, b.value) == (sine(x), cosine(x)), x


def test_bullet_calls_them():
    """What Bullet makes of an angle of Euler are products of such sines, and its table leads nowhere else."""
    p = import_pybullet()
    assert engine_sines.give_to(p)
    library = ctypes.CDLL(p.__file__)
    slots = {name: ctypes.c_uint64.from_address(slot).value for name, slot in engine_sines._imports(library)}
    ours = [ctypes.addressof(ctypes.c_char.from_buffer(room)) for room in engine_sines._kept]
    for name in ("sin", "cos", "sincos", "tan"):
        assert name in slots
        assert any(0 <= slots[name] - start < 4096 for start in ours), name
    sine = ONE(slots["sin"])
    angle = 0.7390851332151607
    assert p.getQuaternionFromEuler((angle, 0.0, 0.0))[0] == sine(angle * 0.5)


def test_a_module_without_such_calls_stays_as_it_is():
    import _ctypes

    assert not engine_sines.give_to(_ctypes)
