"""Where the teeth of a cutter stand: uneven pitches, a helix of their own, compression edges.

Angles are those of a tooth ahead of the first one in the sense of rotation, at the tip; a tooth with a right-hand helix
is later the higher up one looks. Pitches and helices that differ break up the rhythm in which a cutter chatters
(Altintas 2012, sec. 4.6). Compression edges lift chips below and press them down above, so that both faces of a board
stay clean.
"""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.elementary import tan
from gcodesim.declarations.kind import Range
from gcodesim.declarations.quantity import Quantity
from gcodesim.tools.sizes import exceeds
from gcodesim.units import DEG, MM

if TYPE_CHECKING:
    from gcodesim.tools.cutter import Cutter

Array = NDArray[np.float64]

RAKE: Final = Quantity("angle", Range(least=-45.0 * DEG, most=45.0 * DEG), example="10 deg")
"""Of an edge: between its face and the normal of what it cuts; positive is sharp."""

ROUNDED: Final = 0.5 * DEG
"""By which pitches that are written with few digits may miss a whole turn; they are then stretched to it."""

STEEPEST: Final = 89.0 * DEG
"""Of a helix."""


def helices_of(cutter: Cutter) -> tuple[float, ...]:
    """The helix of each tooth [rad]."""
    return cutter.helices or (cutter.helix,) * cutter.flutes


def starts_of(cutter: Cutter) -> Array:
    """By how much each tooth (flutes,) [rad] stands ahead of the first one at the tip."""
    if cutter.pitches is None:
        even: Array = np.arange(cutter.flutes, dtype=np.float64) * (2.0 * pi / cutter.flutes)
        return even
    pitches = np.array(cutter.pitches)
    return np.concatenate([[0.0], np.cumsum(pitches[:-1])]) * (2.0 * pi / float(pitches.sum()))


def late_at(cutter: Cutter, z: Array) -> Array:
    """By how much each tooth (flutes, n) [rad] is late at heights z (n,) [m] above the tip.

    2 z tan(helix) / D; from the end of the up-cut part on the helix goes back.
    """
    slope = np.array([2.0 * tan(helix) / cutter.diameter for helix in helices_of(cutter)])
    along = z if cutter.up_cut is None else np.minimum(z, 2.0 * cutter.up_cut - z)
    late: Array = slope[:, None] * along[None, :]
    return late


def is_uneven(cutter: Cutter) -> bool:
    """Whether teeth differ in when they come, or in how far out they stand, or change along their height."""
    if cutter.up_cut is not None:
        return True
    apart = any(len(set(values or ())) > 1 for values in (cutter.pitches, cutter.helices))
    return cutter.flutes > 1 and (apart or bool(cutter.runout))


def teeth_problems(cutter: Cutter) -> list[tuple[str, str]]:
    """What is wrong with the keys of the teeth: (key, message)."""
    found = []
    if cutter.flutes < 1:
        found.append(("flutes", f"`flutes` is {cutter.flutes}; a cutter has at least one"))
    if not -STEEPEST < cutter.helix < STEEPEST:
        found.append(("helix", f"`helix` of {cutter.helix / DEG:g} deg is no helix; it lies between -89 and 89 deg"))
    for name in ("pitches", "helices"):
        values = getattr(cutter, name)
        if values is not None and len(values) != cutter.flutes:
            found.append((name, f"`{name}` has {len(values)} angles, and there are {cutter.flutes} teeth (`flutes`)"))
    if found:
        return found
    return [*_pitch_problems(cutter), *_helix_problems(cutter)]


def _pitch_problems(cutter: Cutter) -> list[tuple[str, str]]:
    if cutter.pitches is None:
        return []
    whole = sum(cutter.pitches)
    if abs(whole - 2.0 * pi) <= ROUNDED:
        return []
    return [("pitches", f"`pitches` make {whole / DEG:g} deg together; a turn has 360")]


def _helix_problems(cutter: Cutter) -> list[tuple[str, str]]:
    steep = [helix for helix in cutter.helices or () if not -STEEPEST < helix < STEEPEST]
    if steep:
        return [("helices", f"a helix of {steep[0] / DEG:g} deg is none; it lies between -89 and 89 deg")]
    if cutter.up_cut is not None and exceeds(cutter.up_cut, cutter.flute_length):
        return [
            (
                "up_cut",
                f"`up_cut` {cutter.up_cut / MM:g} mm is more than the edges are long, {cutter.flute_length / MM:g} mm",
            )
        ]
    if cutter.helices is None or cutter.flutes < 2:
        return []
    top = cutter.flute_length if cutter.up_cut is None else min(cutter.up_cut, cutter.flute_length)
    at = starts_of(cutter) - late_at(cutter, np.array([top]))[:, 0]
    if (np.diff(np.append(at, at[0] + 2.0 * pi)) > 0.0).all():
        return []
    return [("helices", f"with these `helices` teeth meet below {top / MM:g} mm, where the edges end")]
