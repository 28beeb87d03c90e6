"""Finger gripper: two fingers that close along X of the tool, both by the same way."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from gcodesim.declarations.file_kind import File, FileValue
from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import POSITIVE
from gcodesim.declarations.plain_kinds import Choice
from gcodesim.declarations.quantity import Quantity
from gcodesim.frames import Array, Pose
from gcodesim.frozen import frozen
from gcodesim.solids import Box, Mesh, MeshFile, Placed
from gcodesim.tools.body import Primitive, cylinder
from gcodesim.tools.gripper import Gripper, PadFaces
from gcodesim.units import MM


@frozen
class FingerGripper(Gripper):
    """Two fingers; their pads are `finger_width` wide along Y and reach `finger_length` up from the tip."""

    kind: ClassVar[str] = "finger_gripper"

    stroke: float = key(Quantity("length", POSITIVE), "greatest distance of the fingers", example="40 mm")
    force: float = key(Quantity("force", POSITIVE), "with which each finger presses", example="60 N")
    finger_width: float = key(Quantity("length", POSITIVE), "of a pad, along Y of the tool", default=20.0 * MM)
    finger_length: float = key(
        Quantity("length", POSITIVE),
        "of a pad, from the tip up",
        derive=lambda tool: min(40.0 * MM, 0.5 * tool.length),
        rule="40 mm, at most half the length",
    )
    finger_thickness: float = key(Quantity("length", POSITIVE), "of a finger, along X", default=10.0 * MM)
    hold: str = key(
        Choice(("statics", "contacts")),
        "how it holds a part in bullet: rigidly while statics allows, or by contact forces alone, so that it slides "
        "and turns; in the kinematic world always by statics",
        default="statics",
        quiet=True,
    )
    mesh: FileValue | None = key(
        File("a mesh file"),
        "shape of the finger on the side of +X in mm, its pad in the plane X = 0 of the tool; the other is its mirror",
        default=None,
    )

    @property
    def widest(self) -> float:
        return self.stroke

    @property
    def primitives(self) -> tuple[Primitive, ...]:
        """The fingers as round bars, wide open, and the body above them."""
        radius = 0.5 * self.finger_thickness
        bars = [cylinder("finger", radius, 0.0, self.finger_length) for _ in range(2)]
        aside = 0.5 * self.stroke + radius
        fingers = (
            Primitive(bar.part, bar.placed.at(Pose.from_xyz_rpy((side * aside, 0.0, 0.0))))
            for bar, side in zip(bars, (1.0, -1.0), strict=True)
        )
        body = cylinder("gripper", max(0.5 * self.stroke, 2.0 * radius), self.finger_length, self.length)
        return (*fingers, body, *self._holder_bodies())

    def shapes(self, opening: float) -> list[tuple[str, Placed]]:
        aside, y = 0.5 * opening * self.stroke, 0.5 * self.finger_width
        if self.mesh is None:
            box = Box(lower=(0.0, -y, -self.finger_length), upper=(self.finger_thickness, y, 0.0))
            right = left = Placed(box)
            left = Placed(Box(lower=(-self.finger_thickness, -y, -self.finger_length), upper=(0.0, y, 0.0)))
        else:
            right = Placed(Mesh(source=MeshFile(path=self.mesh.path, scale=(MM, MM, MM))))
            triangles = right.solid.triangles  # type: ignore[union-attr]
            faces = np.asarray(triangles.faces[:, ::-1], dtype=float)
            left = Placed(Mesh.of(triangles.points * np.array([-1.0, 1.0, 1.0]), faces))
        moved = [("finger", side.at(Pose.from_xyz_rpy((x, 0.0, 0.0)))) for side, x in ((right, aside), (left, -aside))]
        return moved + [(body.part, body.placed) for body in self.primitives if body.part != "finger"]

    def has(self, contacts: Array) -> float:
        return self.force

    def needs(self, load: Array, moment: Array, mu: float, contacts: Array) -> Array:
        """Of each finger; see `grip_laws.friction_force`."""
        from gcodesim.tools.grip_laws import friction_force, tangential_of

        return friction_force(*tangential_of(load, 0), mu)

    def contacts(self, skin: Array, opening: float) -> tuple[Array, float] | None:
        between = self._between(skin)
        if between is None or 2.0 * max(abs(between[0]), abs(between[1])) > opening * self.stroke + 1e-9:
            return None
        low, high = between
        y = z = 0.0
        pads = np.array([[low, y, z, self.finger_width], [high, y, z, self.finger_width]])
        return pads, min((high - low) / self.stroke, 1.0)

    def pads(self, contacts: Array) -> PadFaces | None:
        if self.hold == "statics":
            return None
        return PadFaces(
            left=float(contacts[0, 0]),
            right=float(contacts[1, 0]),
            width=self.finger_width,
            length=self.finger_length,
            thickness=self.finger_thickness,
        )

    def too_wide(self, skin: Array, opening: float) -> float | None:
        between = self._between(skin)
        if between is None or not between[0] < 0.0 < between[1]:
            return None
        wide = 2.0 * max(abs(between[0]), abs(between[1]))
        return wide if wide > opening * self.stroke + 1e-9 else None

    def _between(self, skin: Array) -> tuple[float, float] | None:
        """From where to where along X a body of triangles (t, 3, 3) is between the planes of the pads' edges."""
        half = 0.5 * self.finger_width
        polygons = [skin[(skin[:, :, 2].max(axis=1) >= -self.finger_length) & (skin[:, :, 2].min(axis=1) <= 0.0)]]
        low, high = np.inf, -np.inf
        for triangle in polygons[0]:
            points = triangle
            for normal, limit in (
                ((0.0, 1.0, 0.0), half),
                ((0.0, -1.0, 0.0), half),
                ((0.0, 0.0, 1.0), 0.0),
                ((0.0, 0.0, -1.0), self.finger_length),
            ):
                points = _clipped(points, np.array(normal), limit)
                if not len(points):
                    break
            if len(points):
                low, high = min(low, float(points[:, 0].min())), max(high, float(points[:, 0].max()))
        if not low < high or low > 0.5 * self.stroke or high < -0.5 * self.stroke:
            return None
        return low, high


def _clipped(points: Array, normal: Array, limit: float) -> Array:
    """The polygon (k, 3) cut off where `normal · p` is more than `limit` (Sutherland and Hodgman 1974)."""
    distance = (points * normal).sum(axis=1) - limit
    kept = []
    for i in range(len(points)):
        j = (i + 1) % len(points)
        if distance[i] <= 0.0:
            kept.append(points[i])
        if (distance[i] < 0.0 < distance[j]) or (distance[j] < 0.0 < distance[i]):
            kept.append(points[i] + (points[j] - points[i]) * (distance[i] / (distance[i] - distance[j])))
    return np.array(kept).reshape(-1, 3)
