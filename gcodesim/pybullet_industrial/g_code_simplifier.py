"""Changes to lists of G-code, each line a dictionary of its words; lines are changed in place and returned."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any, Final

import numpy as np

JOINT_KEY: Final = "RA"
"""Words RA1, RA2 … are joints."""

Lines = list[dict[str, Any]]


def is_joint(word: str) -> bool:
    """Whether a word names a joint."""
    return word.startswith(JOINT_KEY) and word[len(JOINT_KEY) :].isdigit()


def _is_angle(word: str) -> bool:
    return word in ("A", "B", "C") or word.startswith(JOINT_KEY)


def _changed(g_code: Lines, change: Callable[[str, Any], Any]) -> Lines:
    for line in g_code:
        for word, value in line.items():
            line[word] = change(word, value)
    return g_code


class GCodeSimplifier:
    """Functions that make programs shorter or fit another control."""

    @staticmethod
    def round_pose_values(g_code: Lines, decimals_xyz: int = 4, decimals_abc: int = 4) -> Lines:
        """Round X, Y, Z and A, B, C to so many decimals."""
        decimals = dict.fromkeys("XYZ", decimals_xyz) | dict.fromkeys("ABC", decimals_abc)
        return _changed(g_code, lambda word, value: round(value, decimals[word]) if word in decimals else value)

    @staticmethod
    def round_joint_positions(g_code: Lines, decimals_angles: int = 5) -> Lines:
        """Round the words of joints."""
        return _changed(g_code, lambda word, value: round(value, decimals_angles) if is_joint(word) else value)

    @staticmethod
    def scale_g_code(g_code: Lines, scale_factor: float, keys: Iterable[str]) -> Lines:
        """Multiply the words `keys` by a factor."""
        scaled = set(keys)
        return _changed(g_code, lambda word, value: value * scale_factor if word in scaled else value)

    @staticmethod
    def add_offset_to_g_code(g_code: Lines, offset_dict: Mapping[str, float]) -> Lines:
        """Add to each word named in `offset_dict` its offset."""
        return _changed(g_code, lambda word, value: value + offset_dict[word] if word in offset_dict else value)

    @staticmethod
    def convert_to_radians(g_code: Lines) -> Lines:
        """A, B, C and joints from degrees to rad."""
        return _changed(g_code, lambda word, value: np.radians(value) if _is_angle(word) else value)

    @staticmethod
    def convert_to_degrees(g_code: Lines) -> Lines:
        """A, B, C and joints from rad to degrees."""
        return _changed(g_code, lambda word, value: np.degrees(value) if _is_angle(word) else value)

    @staticmethod
    def apply_feedrate(g_code: Lines, feedrate: float | None) -> Lines:
        """Put the word F into every line with G1; None changes nothing."""
        for line in g_code:
            if feedrate is not None and line.get("G") == 1:
                line["F"] = feedrate
        return g_code

    @staticmethod
    def skip_command(g_code: Lines, skip_commands: Mapping[str, Any]) -> Lines:
        """A new list without the words that have the values of `skip_commands`, and without lines that become empty."""
        for line in g_code:
            for word, value in skip_commands.items():
                if word in line and line[word] == value:
                    del line[word]
        return [line for line in g_code if line]
