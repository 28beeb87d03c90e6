"""Short names for legends, in which there is little room."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Final

LONGEST_LABEL: Final = 8


def short_names(names: Sequence[str]) -> list[str]:
    """Names for a legend: `joint_1` is J1, of others the first letters of each word; those that would be equal stay."""
    short = [_short(name) for name in names]
    return [new if short.count(new) == 1 else name for name, new in zip(names, short, strict=True)]


def _short(name: str) -> str:
    numbered = re.fullmatch(r"(?:.*[^A-Za-z])?([A-Za-z])[a-z]*[ _-]*(\d+)", name)
    if numbered is not None:
        return f"{numbered[1].upper()}{numbered[2]}"
    words = [word for word in re.split(r"[ _-]+", name) if word and word not in ("joint", "axis")]
    if len(" ".join(words)) <= LONGEST_LABEL:
        return " ".join(words)
    return " ".join(word[:3] for word in words)[:LONGEST_LABEL]


def labels_of(figures: Sequence[str]) -> list[str]:
    """For each figure the shortest of its words that no other one has: `depth` of `axial_depth_m`."""
    words = [figure.split("_") for figure in figures]
    labels = []
    for mine in words:
        alone = [word for word in mine[:-1] if sum(word in others for others in words) == 1]
        labels.append(min(reversed(alone), key=len) if alone else " ".join(mine[:-1]))
    return labels
