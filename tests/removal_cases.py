"""Cases of removal with any tool axis (tests/data/removal): run one, and hold the outcome against what is expected."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np

from gcodesim.material import Stock
from gcodesim.material.axis_way import AxisWay
from gcodesim.material.solid_of_revolution import slabs_of_outline
from gcodesim.solids.turned import OutlineArc
from gcodesim.units import MM, MM3
from tests.axis_ways import Helix, along_helix, joined, straight

CASES = Path(__file__).parent / "data" / "removal" / "cases.json"


def read_cases(path=CASES):
    return json.loads(path.read_text())["cases"]


def stock_of(case: dict[str, Any], cell: float) -> Stock:
    if "box" in case["stock"]:
        low, high = (np.array(corner) * MM for corner in case["stock"]["box"])
        return Stock.box(low, high, cell)
    bar = case["stock"]["cylinder"]
    low, high = (z * MM for z in bar["z"])
    return Stock.cylinder((0.0, 0.0, low), 2.0 * bar["radius"] * MM, high - low, cell)


def outline_of(tool):
    def place(point):
        return (point[0] * MM, point[1] * MM)

    return [
        OutlineArc(to=place(p["to"]), centre=place(p["centre"]), ccw=p["turn"] == "ccw")
        if isinstance(p, dict)
        else place(p)
        for p in tool["outline"]
    ]


def way_of(piece, X, cell):
    """A piece of the motion in the stock's own frame."""
    R, p = X

    def into(point):
        return (np.array(point) * MM - p) @ R

    axis = np.array(piece["axis"]) @ R
    if piece["kind"] == "line":
        return straight(into(piece["start"]), into(piece["end"]), axis, np.array(piece["axis_end"]) @ R)
    helix = Helix(
        into(piece["centre"]), np.array(piece["normal"]) @ R, math.radians(piece["angle"]), piece["rise"] * MM
    )
    return along_helix(into(piece["start"]), helix, axis, piece["axis_turns"], cell)


def pose_of(case):
    pose = case["stock"].get("pose")
    return (np.eye(3), np.zeros(3)) if pose is None else (np.array(pose["rotation"]), np.array(pose["origin"]) * MM)


def first_met(surface, origin, direction):
    """The least length [m] along a ray at which it meets a closed mesh; and how often it goes through it."""
    a, b, c = (surface.vertices[surface.faces[:, k]] for k in range(3))
    # Moeller and Trumbore 1997
    e1, e2 = b - a, c - a
    h = np.cross(direction, e2)
    det = np.einsum("ij,ij->i", e1, h)
    with np.errstate(all="ignore"):
        s = origin - a
        u = np.einsum("ij,ij->i", s, h) / det
        q = np.cross(s, e1)
        v = (q @ direction) / det
        t = np.einsum("ij,ij->i", e2, q) / det
        hit = (np.abs(det) > 0) & (u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0)
    return (float(t[hit].min()) if hit.any() else None), int(hit.sum())


ODD = np.array([0.3571, 0.5273, 0.7709]) / np.linalg.norm([0.3571, 0.5273, 0.7709])


def run_case(case, cell=None, looks=True):
    """What compare rules ask for, in mm; with `stock` the stock itself."""
    cell = (case["resolution"] if cell is None else cell) * MM
    X = pose_of(case)
    stock = stock_of(case, cell)
    removed = 0.0
    motion = list(case["motion"])
    while motion:
        number = motion[0]["tool"]
        same = [piece for piece in motion if piece["tool"] == number]
        assert motion[: len(same)] == same, "pieces of one tool come together"
        motion = motion[len(same) :]
        way: AxisWay = joined([way_of(piece, X, cell) for piece in same])
        slabs = slabs_of_outline(outline_of(case["tools"][str(number)]), cell)
        removed += float(stock.sweep(way, slabs).sum())
    got = {"removed": removed / MM3, "resolution": cell / MM, "bound": stock.error_bound() / MM3, "stock": stock}
    if looks:
        R, p = X
        surface = stock.surface(0.0)
        into = lambda points: (np.array(points) * MM - p) @ R  # noqa: E731
        got["inside"] = [first_met(surface, into(probe["at"]), ODD)[1] % 2 == 1 for probe in case["probes"]]
        rays = [first_met(surface, into(r["origin"]), np.array(r["direction"]) @ R)[0] for r in case["rays"]]
        got["rays"] = [None if t is None else t / MM for t in rays]
        got["pieces"] = (stock.piece_volumes() / MM3).tolist()
    return got
