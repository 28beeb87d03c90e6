"""Work systems by number and name."""

import pytest

from gcodesim.canon.systems import name_of_system, system_index, system_name
from gcodesim.rs274.dialects.systems import first_of_system


@pytest.mark.parametrize(
    ("index", "name", "first"),
    [
        (1, "G54", 5221),
        (6, "G59", 5321),
        (9, "G59.3", 5381),
        (101, "G54.1 P1", 7001),
        (148, "G54.1 P48", 7941),
        (149, "G54.1 P49", 14961),
        (400, "G54.1 P300", 19981),
    ],
)
def test_number_name_and_parameter_belong_together(index, name, first):
    assert name_of_system(index) == name
    assert system_name(name) == name
    assert system_index(name) == index
    assert first_of_system(index) == first


@pytest.mark.parametrize(
    ("text", "name"), [("g54", "G54"), ("G54 P1", "G54.1 P1"), ("g154p017", "G54.1 P17"), ("G54.1P300", "G54.1 P300")]
)
def test_other_spellings(text, name):
    assert system_name(text) == name


@pytest.mark.parametrize("text", ["G53", "G59.4", "G54.1", "G54.1 P0", "G54.1 P301", "G55 P1", "work"])
def test_what_is_no_system(text):
    assert system_name(text) is None
