"""The shape that a tool really has, from a mesh or a URDF, in place of the simple bodies of its kind.

A URDF may have joints that move: those of fingers, which follow the opening of a gripper, and others that follow them.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import field, replace
from functools import cached_property
from typing import Final

import numpy as np

from gcodesim.declarations.file_kind import File, FileValue
from gcodesim.declarations.keys import key
from gcodesim.declarations.mesh_shape import LENGTH_UNIT, MeshShape, mesh_shape
from gcodesim.declarations.plain_kinds import Choice, Text
from gcodesim.declarations.quantity import Quantity, Vector
from gcodesim.declarations.reading import UNREAD, Path, Reading, Unread, suggestion
from gcodesim.frames import Array, Pose
from gcodesim.frozen import frozen
from gcodesim.kinematics.chain import Chain, Inertial
from gcodesim.kinematics.posed_links import posed_links, travel_of
from gcodesim.solids import Placed, triangles_of
from gcodesim.solids.mass import mass_of_skin
from gcodesim.tools.body import STEEL_DENSITY
from gcodesim.tools.parts import Color

MESH_PART: Final = "body"
"""The part of a tool that a mesh is; links of a URDF are parts by their own names."""

_LINK: Final = Text(form="the name of a link")


@frozen(slots=False, eq=False)
class OwnBody:
    """Where a tool's own shape comes from, and how it hangs on the flange."""

    mesh: FileValue | None = key(File("a mesh file"), "a triangle mesh", default=None, example="torch.stl")
    unit: str | None = key(LENGTH_UNIT, "unit of the mesh file", default=None)
    urdf: FileValue | None = key(
        File("a URDF file"),
        "a description with links and joints, such as fingers",
        default=None,
        example="gripper.urdf",
    )
    xyz: tuple[float, ...] = key(
        Vector(Quantity("length"), 3, "[0, 0, 12 mm]"),
        "where the zero of the mesh, or the link `connector`, is on the flange",
        default=(0.0, 0.0, 0.0),
        quiet=True,
    )
    rpy: tuple[float, ...] = key(
        Vector(Quantity("angle"), 3, "[0, 0, 90]"), "how it is turned there", default=(0.0, 0.0, 0.0), quiet=True
    )
    connector: str | None = key(
        _LINK, "the link of the URDF that is coupled to the flange", default=None, rule="its root", quiet=True
    )
    tip: str | None = key(
        _LINK, "the link of the URDF that is the tip of the tool, its Z pointing out", default=None, quiet=True
    )
    tip_axis: str = key(
        Choice(("X", "Y", "Z", "-X", "-Y", "-Z")),
        "the axis of the link `tip` that points out",
        default="Z",
        quiet=True,
    )
    opens: str = key(
        Choice(("upper", "lower")),
        "at which end of the travel of its joints a gripper is open",
        default="upper",
        quiet=True,
    )
    shape: MeshShape | None = field(default=None, repr=False)
    chain: Chain | None = field(default=None, repr=False)

    def checked(self, to: Reading, path: Path) -> OwnBody | Unread:
        """Reads the file."""
        if self.tip is None and self.tip_axis != "Z":
            hint = "name the link as `tip`; `tcp` of the tool turns a tip that is no link"
            return to.fault(
                "GS719", to.key((*path, "tip_axis")), "`tip_axis` is that of a link, and none is named", hint
            )
        if (self.mesh is None) == (self.urdf is None):
            if self.mesh is None:
                return to.fault("GS705", to.span(path), "the body has neither `mesh` nor `urdf`", "give one of them")
            return to.fault("GS719", to.key((*path, "urdf")), "the body has a `mesh` and a `urdf`", "give one of them")
        if self.mesh is not None:
            for name in ("connector", "tip"):
                if getattr(self, name) is not None:
                    hint = "`xyz` and `rpy` say how a mesh hangs on the flange, `tcp` of the tool where its tip is"
                    return to.fault("GS719", to.key((*path, name)), f"`{name}` is a link; a mesh has none", hint)
            shape = mesh_shape(self.mesh, self.unit, to, path)
            return UNREAD if isinstance(shape, Unread) else replace(self, shape=shape)
        assert self.urdf is not None
        if self.unit is not None:
            hint = "a URDF is in metres; `scale` of its <mesh> elements says what is not"
            return to.fault("GS719", to.key((*path, "unit")), "`unit` belongs to a `mesh`", hint)
        from gcodesim.kinematics.user_urdf import user_chain

        chain = user_chain(self.urdf, to, (*path, "urdf"), robot=False)
        if isinstance(chain, Unread):
            return UNREAD
        for name in ("connector", "tip"):
            link = getattr(self, name)
            if link is not None and link not in chain.link_names:
                hint = suggestion(link, list(chain.link_names))
                return to.fault("GS712", to.span((*path, name)), f"`{self.urdf.name}` has no link `{link}`", hint)
        return replace(self, chain=chain)

    @property
    def moves(self) -> bool:
        """Whether it has joints that follow the opening of a gripper."""
        return self.chain is not None and bool(travel_of(self.chain))

    def solids(self, opening: float) -> Iterator[tuple[str, Placed]]:
        """Its bodies by part, seen from the flange, `opening` (0 to 1) open."""
        if self.shape is not None:
            yield MESH_PART, Placed(self.shape.solid, self._X_FB)
        if self.chain is None:
            return
        links = self._links(opening)
        for shape in self.chain.shapes("visual"):
            name = self.chain.link_names[shape.link]
            yield name, shape.placed.at(links[name])

    def color_of(self, part: str) -> Color | None:
        """Of a link, as the URDF paints it."""
        shapes = () if self.chain is None else self.chain.shapes("visual")
        return next((shape.rgba for shape in shapes if self._name(shape.link) == part), None)

    @cached_property
    def X_FT(self) -> Pose | None:
        """The link `tip` seen from the flange, wide open; None if none is named."""
        if self.tip is None:
            return None
        X_FL, X_LT = self._links(1.0)[self.tip], Pose(np.zeros(3), _turned_to(self.tip_axis))
        return X_FL @ X_LT

    @cached_property
    def inertials(self) -> list[tuple[Inertial, Array]]:
        """Masses and X_F (4, 4) of their frames, wide open: those that the URDF gives, else of steel of this size."""
        links = self._links(1.0) if self.chain is not None else {}
        known = [] if self.chain is None else [link for link in self.chain.links if link.inertial is not None]
        given = [
            (link.inertial, links[link.name].matrix) for link in known if link.inertial and link.inertial.mass > 0.0
        ]
        return given or [part for _, placed in self.solids(1.0) for part in _of_steel(placed)]

    def _name(self, link: int) -> str:
        return "" if self.chain is None else self.chain.link_names[link]

    @property
    def _X_FB(self) -> Pose:
        x, y, z = self.xyz
        roll, pitch, yaw = self.rpy
        return Pose.from_xyz_rpy((x, y, z), (roll, pitch, yaw))

    def _links(self, opening: float) -> Mapping[str, Pose]:
        """X_FL of the links."""
        assert self.chain is not None
        ends = {name: ends if self.opens == "upper" else ends[::-1] for name, ends in travel_of(self.chain).items()}
        links = posed_links(self.chain, {name: shut + opening * (wide - shut) for name, (shut, wide) in ends.items()})
        X_FR = self._X_FB @ links[self.connector or self.chain.links[0].name].inverse()
        return {name: X_FR @ X_RL for name, X_RL in links.items()}


def _turned_to(axis: str) -> Array:
    """The axes (3, 3) of a tip, as columns, whose Z is `axis` of a link: its X is that of the link, or Y is."""
    z = (-1.0 if axis.startswith("-") else 1.0) * np.eye(3)["XYZ".index(axis[-1])]
    x = np.cross((0.0, 1.0, 0.0), z) if axis[-1] == "X" else np.array([1.0, 0.0, 0.0])
    return np.column_stack([x, np.cross(z, x), z])


def _of_steel(placed: Placed) -> list[tuple[Inertial, Array]]:
    """A closed body of steel; nothing for what cannot be read."""
    try:
        skin = triangles_of(placed.solid)
    except ValueError:
        return []
    body = mass_of_skin(skin.points, skin.faces, STEEL_DENSITY * abs(placed.solid.volume))  # type: ignore[union-attr]
    return [(Inertial(mass=body.mass, com=body.center, inertia=body.inertia), placed.X.matrix)]
