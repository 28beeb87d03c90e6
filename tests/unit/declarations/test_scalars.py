"""Numbers and switches as cells write them."""

from __future__ import annotations

import math

import pytest

from gcodesim.declarations.scalars import Measured, integer, measured, switch, why_no_number


@pytest.mark.parametrize(
    ("text", "value", "unit"),
    [
        ("10", 10.0, ""),
        ("10 mm", 10.0, "mm"),
        ("10mm", 10.0, "mm"),
        ("1e3", 1000.0, ""),
        ("9e5", 9e5, ""),
        ("1.5e4 N·m/rad", 1.5e4, "N·m/rad"),
        ("-0.25", -0.25, ""),
        ("+.5", 0.5, ""),
        ("5.", 5.0, ""),
        ("3 1/min", 3.0, "1/min"),
        ("50 %", 50.0, "%"),
        (" 7 ", 7.0, ""),
        ("2e", 2.0, "e"),
    ],
)
def test_number_and_unit(text: str, value: float, unit: str) -> None:
    if text == "3 1/min":
        assert measured(text) is None  # reads like two numbers: `rpm` is meant
    else:
        assert measured(text) == Measured(value, unit)


@pytest.mark.parametrize(
    "text",
    [
        "1_0",
        "1,5",
        "1.2.3",
        "0x10",
        "0o17",
        ".inf",
        "-.inf",
        ".nan",
        "nan",
        "inf",
        "on",
        "",
        "-",
        "e5",
        "٥",
        "１０",
        "1-2",
        "5 5",
        "--5",
    ],
)
def test_what_is_no_number(text: str) -> None:
    assert measured(text) is None


def test_a_number_that_overflows_is_infinite_for_the_caller_to_refuse() -> None:
    number = measured("1e400")

    assert number is not None and math.isinf(number.value)


@pytest.mark.parametrize(
    ("text", "hint"), [("1_0", "`10`"), ("1,5", "`1.5`"), (".nan", "finite"), ("0x10", "decimal"), ("٥", "0 to 9")]
)
def test_hints_say_what_to_write(text: str, hint: str) -> None:
    assert hint in why_no_number(text)


@pytest.mark.parametrize(
    ("text", "value"), [("3", 3), ("+3", 3), ("007", 7), ("3.0", None), ("1e3", None), ("1_0", None), ("٣", None)]
)
def test_whole_numbers(text: str, value: int | None) -> None:
    assert integer(text) == value


@pytest.mark.parametrize(
    ("text", "value"), [("true", True), ("False", False), ("on", None), ("yes", None), ("1", None)]
)
def test_switches_are_those_of_yaml_1_2(text: str, value: bool | None) -> None:
    assert switch(text) is value
