"""The module has the names and arguments of PyBullet Industrial 1.0.4, and makes the same paths."""

from __future__ import annotations

import importlib
import inspect
import json
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

import gcodesim.pybullet_industrial as pi
from gcodesim.key_page import with_keys
from gcodesim.pybullet_industrial.mapping import COUNTERPARTS, page, public_names
from tests.unit.pybullet_industrial.drawn import DRAWN
from tests.unit.pybullet_industrial.paths import CASES, SINGLE_PRECISION, as_lists
from tests.unit.pybullet_industrial.scenes import SCENES, UP, client

TOP = Path(__file__).parents[3]
ORIGINAL = json.loads((TOP / "tests/data/pybullet_industrial/original.json").read_text())
ADDED = {"ToolPath.moves", "ToolPath.of_moves"}

EXACT = 1e-9
SINGLE = 1e-6  # of coordinates up to 3 m
DRAWN_OFF = 2e-5
PHYSICS = 1e-5  # the client rounds to single precision, and a solver amplifies that


def _thing(name: str) -> Any:
    """What a script gets under a name, from the package or else from the module that has it."""
    head, _, method = name.partition(".")
    homes = [pi, *(importlib.import_module(f"{pi.__name__}.{module}") for module in pi.MODULES)]
    found = next(getattr(home, head) for home in homes if hasattr(home, head))
    return getattr(found, method) if method else found


def _difference(made: dict[str, list[Any]], expected: dict[str, list[Any]]) -> float:
    shapes = [(np.shape(made[key]), np.shape(expected[key])) for key in expected]
    assert all(one == other for one, other in shapes), shapes
    return max(float(np.abs(np.subtract(made[key], expected[key])).max()) for key in expected)


def test_every_name_is_in_the_table() -> None:
    assert len(ORIGINAL["names"]) > 130
    assert set(ORIGINAL["names"]) <= set(public_names())
    assert set(public_names()) >= ADDED
    assert set(COUNTERPARTS) <= set(public_names())


@pytest.mark.parametrize("name", sorted(ORIGINAL["names"]))
def test_arguments_have_the_same_names_and_order(name: str) -> None:
    thing = _thing(name)
    expected = ORIGINAL["names"][name]

    if inspect.isclass(thing):
        thing = thing.__init__
    assert not callable(thing) or list(inspect.signature(thing).parameters) == expected


@pytest.mark.parametrize("name", sorted(CASES))
def test_paths_are_those_of_the_original(name: str) -> None:
    made = as_lists(CASES[name](pi))

    assert _difference(made, ORIGINAL["paths"][name]) <= (SINGLE if name in SINGLE_PRECISION else EXACT)


@pytest.mark.parametrize("name", sorted(SCENES))
def test_robots_and_tools_do_what_those_of_the_original_do(name: str) -> None:
    assert SCENES[name](pi) == pytest.approx(ORIGINAL["scenes"][name], abs=PHYSICS)


@pytest.mark.slow
def test_the_installed_original_is_the_recorded_one() -> None:
    original: ModuleType = importlib.import_module("pybullet_industrial")  # extra test-slow

    for name, run in SCENES.items():
        assert run(original) == pytest.approx(ORIGINAL["scenes"][name], abs=PHYSICS)
    for name, make in CASES.items():
        assert _difference(as_lists(make(original)), ORIGINAL["paths"][name]) <= EXACT
        assert _difference(as_lists(make(pi)), as_lists(make(original))) <= (
            SINGLE if name in SINGLE_PRECISION else EXACT
        )


def _outcome(name: str, module: ModuleType, seed: int) -> Any:
    """What a drawn call gives; None where it is refused."""
    try:
        return DRAWN[name](module, np.random.default_rng(seed))
    except (ValueError, TypeError, KeyError, ZeroDivisionError, AttributeError):
        return None


def _same(made: Any, expected: Any) -> bool:
    """The same structure with the same texts, and numbers that are equal but for single precision."""
    if isinstance(expected, dict):
        return list(made) == list(expected) and all(_same(made[key], expected[key]) for key in expected)
    if isinstance(expected, list | tuple):
        return len(made) == len(expected) and all(_same(one, other) for one, other in zip(made, expected, strict=True))
    if expected is None or isinstance(expected, str):
        return bool(made == expected)
    return np.shape(made) == np.shape(expected) and np.allclose(made, expected, rtol=DRAWN_OFF, atol=DRAWN_OFF)


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(DRAWN))
def test_drawn_calls_do_what_the_installed_original_does(name: str) -> None:
    original: ModuleType = importlib.import_module("pybullet_industrial")  # extra test-slow

    pairs = [(_outcome(name, pi, seed), _outcome(name, original, seed)) for seed in range(100)]

    assert sum(expected is not None for _, expected in pairs) > 50
    assert [seed for seed, (made, expected) in enumerate(pairs) if not _same(made, expected)] == []


def test_a_turn_keeps_its_sign_beyond_its_ends() -> None:
    first, last = np.array([0.0, 0.0, 1.0, 0.0]), np.array([0.6, 0.0, 0.8, 0.0])

    one = pi.interpolation.slerp(first, last, 0.5)
    turned = pi.interpolation.slerp(-first, last, [3.0, -2.0, 0.0])

    assert one.shape == (4,) and one @ first == pytest.approx(np.cos(0.5 * np.arccos(0.8)))
    assert turned @ -first == pytest.approx([np.cos(3 * np.arccos(0.8)), np.cos(2 * np.arccos(0.8)), 1.0])


def test_a_spline_may_have_one_point() -> None:
    assert pi.spline_interpolation([[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]], 1).positions.tolist() == [[1.0], [3.0], [5.0]]


def test_a_path_of_lists_is_moved_and_turned() -> None:
    path = pi.ToolPath([[1.0], [0.0], [0.0]], [[0.0], [0.0], [0.0], [1.0]])

    path.rotate([0, 0, np.sqrt(0.5), np.sqrt(0.5)])
    path.translate([0, 0, 2])
    listed = pi.ToolPath([[1.0], [0.0], [0.0]])
    listed.translate(np.array([1.0, 2.0, 3.0]))

    assert np.allclose(path.positions, [[0], [1], [2]])
    assert np.allclose(listed.positions, [[2], [2], [3]])


def test_a_word_that_is_left_out_stays_to_the_bit() -> None:
    with client() as file:
        arm = pi.RobotBase(file("arm.urdf"), [0, 0, 0], UP)
        runner = pi.GCodeProcessor("G1 A0.5", arm, offset=np.array([[0.1, 0.7, 0.3], [0, 0, 0]]))

        before = arm.get_endeffector_pose()[0]
        for _ in runner:
            pass

        assert runner.new_point.tolist() == before.tolist()


def test_the_page_is_fresh() -> None:
    text = (TOP / "docs/coming-from-pybullet-industrial.md").read_text(encoding="utf-8")

    assert text == with_keys(text, page()), (
        "python -m gcodesim.pybullet_industrial.mapping docs/coming-from-pybullet-industrial.md"
    )
    assert all(f"| `{name}` |" in text for name in public_names())


def test_a_path_becomes_moves_and_comes_back() -> None:
    path = pi.build_box_path([0.4, -0.1, 0.2], [0.5, 0.3], 0.05, [0, 0, 0.6, 0.8], 60)
    path.tool_activations[5:] = 1

    back = pi.ToolPath.of_moves(path.moves(feed=0.02))

    assert np.allclose(back.positions, path.positions, atol=1e-12)
    assert np.allclose(back.orientations, path.orientations, atol=1e-12)
    assert back.tool_activations.tolist() == path.tool_activations.tolist()
    assert set(path.moves(feed=0.02).feed) == {0.02}


@pytest.mark.parametrize(
    ("wrong", "text"),
    [
        (lambda: pi.ToolPath(np.zeros((3, 4)), np.zeros((4, 3))), "3 orientations do not fit 4 positions"),
        (lambda: pi.ToolPath(np.zeros((3, 4)), None, [1]), "1 tool activations do not fit 4"),
        (lambda: pi.JointPath(np.zeros((2, 4)), ["a"]), "2 rows of joint values do not fit 1 joints"),
        (lambda: pi.circular_interpolation([0, 0, 0], [2, 0, 0], 1.0, 5), "more than 1.0 m"),
        (lambda: pi.circular_interpolation([0, 1, 0], [0, 1, 3], 1.0, 5), "the same point"),
        (lambda: pi.GCodeProcessor.read_g_code("G1 X1\nG1 X"), "line 2: `X` has no number"),
    ],
)
def test_wrong_use_is_told(wrong: Any, text: str) -> None:
    with pytest.raises(ValueError, match=text):
        wrong()
