"""One vocabulary of solids, for everything in a cell, for machines and tools, and for drawing.

Knows no cell, no machine and no tool; each of these has one place that says which solids it consists of.
"""

from gcodesim.solids.convex import facets_of, hulls_of
from gcodesim.solids.hull import Hull
from gcodesim.solids.mass import moments
from gcodesim.solids.mesh_file import MeshError, MeshFile, Triangles, read_mesh
from gcodesim.solids.outline import outline_of, widest
from gcodesim.solids.solid import Box, Cone, Cylinder, Hulls, Mesh, Placed, Point, Revolution, Solid, Sphere
from gcodesim.solids.triangles import room_of, triangles_of

__all__ = [
    "Box",
    "Cone",
    "Cylinder",
    "Hull",
    "Hulls",
    "Mesh",
    "MeshError",
    "MeshFile",
    "Placed",
    "Point",
    "Revolution",
    "Solid",
    "Sphere",
    "Triangles",
    "facets_of",
    "hulls_of",
    "moments",
    "outline_of",
    "read_mesh",
    "room_of",
    "triangles_of",
    "widest",
]
