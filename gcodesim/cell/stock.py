"""Bodies of the cell that have a shape and a place: stock, fixtures, target."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field, replace
from difflib import get_close_matches
from typing import Any, ClassVar, Final

from gcodesim.cell.film import FilmSpec
from gcodesim.cell.height_map import HeightMap, height_map_of
from gcodesim.cell.leftover import Leftover, leftover
from gcodesim.cell.placing import POINT, Place, names_of
from gcodesim.declarations.composed import ListOf
from gcodesim.declarations.file_kind import File, FileValue
from gcodesim.declarations.keys import all_keys, inline, key
from gcodesim.declarations.kind import POSITIVE, Json, Kind, Range, scalar, short
from gcodesim.declarations.map_of import MapOf
from gcodesim.declarations.mesh_shape import LENGTH_UNIT, MeshShape, mesh_shape
from gcodesim.declarations.nodes import Listing, Node
from gcodesim.declarations.nodes import Mapping as MappingNode
from gcodesim.declarations.quantity import Quantity, Vector
from gcodesim.declarations.reading import UNREAD, Path, Reading, Reference, Unread, suggestion
from gcodesim.declarations.record import FREE, NEARLY, Record
from gcodesim.declarations.units import shown
from gcodesim.frozen import frozen
from gcodesim.solids import Box, Cylinder, Point, Solid

_WORDS: Final = {
    "bottom": (2, 0.0),
    "top": (2, 1.0),
    "front": (1, 0.0),
    "back": (1, 1.0),
    "left": (0, 0.0),
    "right": (0, 1.0),
}
_CENTRES: Final = ("center", "centre", "middle")
_LEAST_SIDE: Final = 1e-6  # m; below a micrometre it is a slip of units
_SIDE: Final = Range(above=0.0, most=1e3)  # m
_GRID: Final = Range(least=1e-7, most=1.0)  # m


StockShape = Box | Cylinder | MeshShape | Leftover


def solid_of(shape: StockShape) -> Solid | None:
    """A shape of the cell as a solid; None for what an earlier run left, which is a stock."""
    if isinstance(shape, Leftover):
        return None
    return shape.solid if isinstance(shape, MeshShape) else shape


def zero_fractions(text: str) -> Point | None:
    """`top-front-left` → that point of a box, as fractions of its edges: (0, 0, 1)."""
    parts: dict[int, float] = {}
    words = text.lower().replace("_", "-").split("-")
    centres = 0
    for word in words:
        if word in _CENTRES:
            centres += 1
        elif word in _WORDS and _WORDS[word][0] not in parts:
            axis, fraction = _WORDS[word]
            parts[axis] = fraction
        else:
            return None
    free = 3 - len(parts)
    if (free and not centres) or centres > free:
        return None
    return (parts.get(0, 0.5), parts.get(1, 0.5), parts.get(2, 0.5))


@frozen(kw_only=False)
class _Corner(Kind):
    """The point of a box that is at its place."""

    @property
    def expected(self) -> str:
        return "a point of the box such as `top-front-left` or `bottom-center`"

    def read(self, node: Node, to: Reading, path: Path) -> str | Unread:
        text = scalar(self, node, to, path)
        if isinstance(text, Unread):
            return UNREAD
        if zero_fractions(text.text) is None:
            return to.fault(
                "GS711",
                text.span,
                f"`zero` is `{short(text.text)}`; {self.expected} is expected",
                suggestion(text.text, CORNERS),
            )
        return text.text

    def schema(self, definitions: dict[str, Json]) -> Json:
        return {"type": "string", "examples": ["top-front-left", "top-center"]}


CORNERS: Final = (
    "top-front-left",
    "top-front-right",
    "top-back-left",
    "top-back-right",
    "top-center",
    "center",
    "bottom-front-left",
    "bottom-front-right",
    "bottom-back-left",
    "bottom-back-right",
    "bottom-center",
)


@frozen
class CylinderSize:
    """A cylinder whose axis is Z."""

    diameter: float = key(Quantity("length", _SIDE), "diameter", example="80 mm")
    height: float = key(Quantity("length", _SIDE), "height", example="40 mm")


@frozen(kw_only=False)
class _CylinderKind(Kind):
    """`{diameter: 80, height: 40}` or `[80, 40]`."""

    @property
    def expected(self) -> str:
        return "`{diameter: 80, height: 40}` or `[diameter, height]`"

    def read(self, node: Node, to: Reading, path: Path) -> CylinderSize | Unread:
        if isinstance(node, Listing):
            pair = Vector(Quantity("length", _SIDE), 2).read(node, to, path)
            return UNREAD if isinstance(pair, Unread) else CylinderSize(diameter=pair[0], height=pair[1])
        value: CylinderSize | Unread = Record(CylinderSize, "a cylinder").read(node, to, path)
        return value

    def schema(self, definitions: dict[str, Json]) -> Json:
        pair = Vector(Quantity("length"), 2).schema(definitions)
        return {"anyOf": [Record(CylinderSize, "a cylinder").schema(definitions), pair]}

    def show(self, value: Any) -> Any:
        return Record(CylinderSize, "a cylinder").show(value)

    def plain(self, value: Any) -> tuple[str, Any]:
        return Record(CylinderSize, "a cylinder").plain(value)


@frozen
class ShapeKeys:
    """A shape by one of `box`, `min` with `max`, `cylinder`, `mesh`; the derived `shape` is in the body's own frame.

    `zero` is the point of a box (or of a cylinder) that stands at `xyz`.
    """

    box: Point | None = key(
        Vector(Quantity("length", _SIDE), 3), "edge lengths", default=None, example="[100, 60, 20 mm]"
    )
    zero: str | None = key(_Corner(), "the point that stands at `xyz` (default bottom-front-left)", default=None)
    min: Point | None = key(POINT, "least corner of a box", default=None, example="[0, 0, -20 mm]")
    max: Point | None = key(POINT, "greatest corner of a box", default=None, example="[100, 60, 0 mm]")
    cylinder: CylinderSize | None = key(_CylinderKind(), "a cylinder about Z", default=None)
    mesh: FileValue | None = key(File("a mesh file"), "a triangle mesh", default=None)
    unit: str | None = key(LENGTH_UNIT, "unit of the mesh file", default=None)


def _shape_of(
    body: ShapeKeys, what: str, extra: tuple[str, ...], to: Reading, path: Path
) -> StockShape | Unread | None:
    """The one shape that a body names; None if it is one of `extra`."""
    corner = ("min", "max")
    given = [name for name in ("box", "cylinder", "mesh", *corner) if getattr(body, name) is not None] + list(extra)
    shapes = list(dict.fromkeys("min/max" if name in corner else name for name in given))
    if not shapes:
        return to.fault(
            "GS705",
            to.span(path),
            f"{what} has no shape",
            "give one of `box`, `min` with `max`, `cylinder`, `mesh`" + (", `from`" if what == "stock" else ""),
        )
    if len(shapes) > 1:
        named = [name for name in given if to.spans.get((*path, name))]
        last = max(named, key=lambda name: (to.spans[(*path, name)].line, to.spans[(*path, name)].column))
        return to.fault(
            "GS719",
            to.key((*path, last)),
            f"{what} has {len(shapes)} shapes: {', '.join(f'`{s}`' for s in shapes)}",
            "give one",
        )
    if body.unit is not None and body.mesh is None and getattr(body, "height_map", None) is None:
        return to.fault(
            "GS719", to.key((*path, "unit")), "`unit` belongs to a `mesh`", "write units behind the numbers"
        )
    if body.zero is not None and body.box is None and body.cylinder is None:
        return to.fault(
            "GS719", to.key((*path, "zero")), "`zero` belongs to a `box` or `cylinder`", "place it by `xyz`"
        )
    if extra:
        return None
    return _single_shape(body, to, path)


def _single_shape(body: ShapeKeys, to: Reading, path: Path) -> StockShape | Unread:
    default_zero = "bottom-front-left" if body.box is not None else "bottom-center"
    if body.zero is None and (body.box is not None or body.cylinder is not None):
        to.default((*path, "zero"), default_zero)
    fractions = zero_fractions(body.zero or default_zero)
    assert fractions is not None
    if body.box is not None:
        return _sound_box(box_about_zero(body.box, fractions), "box", to, path)
    if body.cylinder is not None:
        if fractions[:2] != (0.5, 0.5):
            return to.fault(
                "GS711",
                to.span((*path, "zero")),
                f"the zero of a cylinder lies on its axis, not at `{body.zero}`",
                "`top-center`, `center` or `bottom-center`",
            )
        height = body.cylinder.height
        return Cylinder(
            radius=0.5 * body.cylinder.diameter, bottom=-fractions[2] * height, top=(1.0 - fractions[2]) * height
        )
    if body.mesh is not None:
        return mesh_shape(body.mesh, body.unit, to, path)
    return _box_between(body, to, path)


def box_about_zero(size: Point, fractions: Point) -> Box:
    """The box of `size` whose point at `fractions` of its edges is the origin."""
    lower = tuple(-f * s + 0.0 for f, s in zip(fractions, size, strict=True))
    upper = tuple((1.0 - f) * s for f, s in zip(fractions, size, strict=True))
    return Box(lower=(lower[0], lower[1], lower[2]), upper=(upper[0], upper[1], upper[2]))


def _sound_box(box: Box, name: str, to: Reading, path: Path) -> Box | Unread:
    thin = [axis for axis, side in zip("XYZ", box.size, strict=True) if side < _LEAST_SIDE]
    if not thin:
        return box
    return to.fault(
        "GS710", to.span((*path, name)), f"the box is thinner than {shown(_LEAST_SIDE, 'length')} in {', '.join(thin)}"
    )


def _box_between(body: ShapeKeys, to: Reading, path: Path) -> StockShape | Unread:
    for name, other in (("min", "max"), ("max", "min")):
        if getattr(body, name) is None:
            return to.fault(
                "GS705", to.key((*path, other)), f"`{other}` stands without `{name}`", "a box needs both corners"
            )
    assert body.min is not None and body.max is not None
    for index, axis in enumerate("XYZ"):
        low, high = body.min[index], body.max[index]
        if not high - low >= _LEAST_SIDE:
            span = to.span((*path, "max", index))
            return to.fault(
                "GS710",
                span,
                f"`max` is {shown(high, 'length')} in {axis}; it must be greater than `min`, {shown(low, 'length')}",
            )
    return Box(lower=body.min, upper=body.max)


@frozen(kw_only=False)
class _MaterialName(Kind):
    """The name of a material; its existence is checked once the whole cell has been read."""

    @property
    def expected(self) -> str:
        return "the name of a material"

    def read(self, node: Node, to: Reading, path: Path) -> str | Unread:
        text = scalar(self, node, to, path)
        if isinstance(text, Unread):
            return UNREAD
        to.references.append(Reference(what="material", name=text.text, path=path))
        return text.text

    def schema(self, definitions: dict[str, Json]) -> Json:
        return {"type": "string"}


@frozen
class Chuck:
    """The jaws that hold the stock of a lathe at its lower end."""

    diameter: float = key(Quantity("length", _SIDE), "over the jaws", example="160 mm")
    grip: float = key(Quantity("length", _SIDE), "length of the stock between the jaws", example="25 mm")
    length: float = key(Quantity("length", _SIDE), "length of jaws and chuck", default=0.08, example="80 mm")


@frozen
class Tailstock:
    """A live centre (60 degrees) at the free end of the stock of a lathe, on a quill."""

    diameter: float = key(Quantity("length", _SIDE), "of the quill", example="50 mm")
    length: float = key(Quantity("length", _SIDE), "of centre and quill", default=0.15, example="150 mm")
    tip: float = key(Quantity("length", _SIDE), "of the centre before it is as thick as the quill", default=0.03)


@frozen
class Layer:
    """A layer of a stock, over its whole width."""

    height: float = key(Quantity("length", _SIDE), "thickness of the layer", example="2 mm")
    material: str | None = key(_MaterialName(), "id or alias of a material", default=None)


@frozen
class StockSpec(ShapeKeys):
    """Material to work on. `place.frame` None: placed by the rules of `placement.py`."""

    name: str = "stock"
    leftover: FileValue | None = key(
        File("the folder of an earlier run", is_folder=True), "what an earlier run left", name="from", default=None
    )
    place: Place = inline(Place)
    material: str | None = key(
        _MaterialName(), "id or alias of a material; without one it is cut without force", default=None
    )
    density: float | None = key(
        Quantity("density", POSITIVE),
        "for its mass; without it, that of the pure metal that the material mostly is",
        default=None,
        example="2.7 g/cm^3",
        quiet=True,
    )
    resolution: float | None = key(
        Quantity("length", _GRID),
        "grid of the stock",
        default=None,
        rule="a 24th of the smallest tool, 0.05 to 0.5 mm; up to 2 mm for large tools with plain edges on large stock",
        example="0.2 mm",
    )
    bore: float | None = key(
        Quantity("length", _SIDE), "diameter of the hole of a tube, on a lathe", default=None, example="20 mm"
    )
    chuck: Chuck | None = key(Record(Chuck, "a chuck"), "what holds it on a lathe", default=None)
    tailstock: Tailstock | None = key(
        Record(Tailstock, "a tailstock"), "the centre at its free end on a lathe", default=None
    )
    film: FilmSpec | None = key(FilmSpec, "how thick a coat on it has to be", default=None)
    layers: tuple[Layer, ...] = key(
        ListOf(Record(Layer, "a layer")),
        "layers of other materials, from the top down; each becomes a stock `NAME_layer_1` and so on",
        default=(),
        quiet=True,
    )
    height_map: FileValue | None = key(
        File("a table of probed points"),
        "how high the top of a box really is: a grid of points `x y z` in the stock's frame, a line each, in mm or in "
        "`unit`; straight between them, level beyond them",
        default=None,
        quiet=True,
    )
    inside: str | None = key(
        "text",
        "the stock of which it is a part and whose place it takes, such as a screw in a plate; without `in` it stands "
        "in the frame of that stock",
        default=None,
        quiet=True,
    )
    layer: bool = False
    heights: HeightMap | None = None
    shape: StockShape = field(default=Box(lower=(0.0, 0.0, 0.0), upper=(0.0, 0.0, 0.0)))

    def checked(self, to: Reading, path: Path) -> StockSpec | Unread:
        shape = _shape_of(self, "stock", ("from",) if self.leftover is not None else (), to, path)
        if isinstance(shape, Unread):
            return UNREAD
        if shape is None:
            assert self.leftover is not None
            if self.resolution is not None:
                what = "`resolution` does not go with `from`: what an earlier run left keeps its grid"
                return to.fault("GS719", to.key((*path, "resolution")), what, "leave it out")
            shape = leftover(self.leftover, str(path[1]) if len(path) > 1 else "stock", to, (*path, "from"))
            if isinstance(shape, Unread):
                return UNREAD
        return self._warped(shape, to, path) if self.height_map is not None else replace(self, shape=shape)

    def _warped(self, shape: StockShape, to: Reading, path: Path) -> StockSpec | Unread:
        """With a top as probed; its shape is the box around it."""
        assert self.height_map is not None
        where = (*path, "height_map")
        if not isinstance(shape, Box) or self.layers:
            hint = "give the stock by `box`, or by `min` and `max`, without `layers`"
            return to.fault("GS719", to.key(where), "`height_map` is for a stock that is one box", hint)
        heights = height_map_of(self.height_map, self.unit, to, where)
        if isinstance(heights, Unread):
            return UNREAD
        (x, y, low), (right, back, _) = shape.lower, shape.upper
        if heights.lowest - low < _LEAST_SIDE:
            least, floor = shown(heights.lowest, "length"), shown(low, "length")
            what = f"the top goes down to Z {least}; the underside of the stock is at {floor}"
            return to.fault(
                "GS710", to.span(where), what, "heights count from the `zero` of the stock, as its frame does"
            )
        whole = Box(lower=(x, y, low), upper=(right, back, heights.highest))
        return replace(self, shape=whole, heights=heights)


@frozen
class Fixture(ShapeKeys):
    """A body that must not be touched: vise, clamp, table."""

    what: ClassVar[str] = "fixture"
    name: str = ""
    place: Place = inline(Place)
    film: FilmSpec | None = key(
        FilmSpec, "how thick a coat on it has to be; without this key it is not coated", default=None
    )
    shape: StockShape = field(default=Box(lower=(0.0, 0.0, 0.0), upper=(0.0, 0.0, 0.0)))

    def checked(self, to: Reading, path: Path) -> Fixture | Unread:
        shape = _shape_of(self, f"the {self.what}", (), to, path)
        if isinstance(shape, Unread) or shape is None:
            return UNREAD
        if self.place.frame is None:
            to.default((*path, "in"), "world")
        return replace(self, name=str(path[-1]), shape=shape)


@frozen
class ZoneShape(Fixture):
    """A space in which only one machine may be while several programs run at once; the box around it counts."""

    what: ClassVar[str] = "zone"


@frozen
class Target:
    """The part as it is meant to become."""

    mesh: FileValue = key(File("a mesh file"), "the finished part")
    unit: str | None = key(LENGTH_UNIT, "unit of the mesh file", default=None)
    place: Place = inline(Place)
    tolerance: float = key(
        Quantity("length", _SIDE), "distance allowed between part and target", default=1e-4, example="0.1 mm"
    )
    shape: MeshShape | None = None

    def checked(self, to: Reading, path: Path) -> Target | Unread:
        shape = mesh_shape(self.mesh, self.unit, to, path)
        return UNREAD if isinstance(shape, Unread) else replace(self, shape=shape)


_STOCK: Final = Record(StockSpec, "stock")
_SHAPE_KEYS: Final = ("box", "cylinder", "mesh", "min", "max", "from")


@frozen(kw_only=False)
class StockKind(Kind):
    """One stock if the mapping has a key of a shape, else stock by name."""

    @property
    def expected(self) -> str:
        return "stock such as `{box: [100, 60, 20], zero: top-front-left}`"

    def read(self, node: Node, to: Reading, path: Path) -> Mapping[str, StockSpec] | Unread:
        if isinstance(node, MappingNode) and self._is_one(node):
            one = _STOCK.read(node, to, path)
            return UNREAD if isinstance(one, Unread) else {"stock": one}
        named = MapOf(
            names_of("stock"), _STOCK, "stock by name, or one with a shape key such as `box`", lenient=True
        ).read(node, to, path)
        if isinstance(named, Unread):
            return UNREAD
        return {name: replace(stock, name=name) for name, stock in named.items()}

    @staticmethod
    def _is_one(node: MappingNode) -> bool:
        own = [name.text for name, _ in node.entries if not name.text.startswith(FREE)]
        known = all_keys(StockSpec)
        if any(get_close_matches(name, _SHAPE_KEYS, n=1, cutoff=NEARLY) for name in own):
            return True
        # no shape, but no entry that could be a stock either: one stock whose shape is missing or misspelled
        return bool(own) and not any(
            isinstance(value, MappingNode)
            for name, value in node.entries
            if name.text in own and name.text not in known
        )

    def schema(self, definitions: dict[str, Json]) -> Json:
        one = _STOCK.schema(definitions)
        many = MapOf(names_of("stock"), _STOCK, "stock").schema(definitions)
        return {"anyOf": [one, many]}

    def show(self, value: Any) -> Any:
        shown = {name: _STOCK.show(stock) for name, stock in value.items() if not stock.layer}
        return shown["stock"] if list(shown) == ["stock"] else shown

    def plain(self, value: Any) -> tuple[str, Any]:
        return "", {name: _STOCK.plain(stock)[1] for name, stock in value.items() if not stock.layer}


@frozen(kw_only=False)
class FixtureKind(Kind):
    """Fixtures by name."""

    @property
    def expected(self) -> str:
        return "fixtures by name, such as `clamp: {box: [20, 20, 15], in: table}`"

    def _map(self) -> MapOf:
        return MapOf(names_of("fixture"), Record(Fixture, "the fixture"), self.expected, lenient=True)

    def read(self, node: Node, to: Reading, path: Path) -> Any:
        return self._map().read(node, to, path)

    def schema(self, definitions: dict[str, Json]) -> Json:
        return self._map().schema(definitions)

    def show(self, value: Any) -> Any:
        return self._map().show(value)

    def plain(self, value: Any) -> tuple[str, Any]:
        return self._map().plain(value)
