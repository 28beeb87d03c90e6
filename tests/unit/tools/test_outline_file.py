"""Outlines of form cutters from drawings."""

from __future__ import annotations

from pathlib import Path

import pytest

from gcodesim.cell.loader import load_cell
from gcodesim.solids.turned import OutlineArc, end_of
from gcodesim.tools.drawing_files import strokes_of
from gcodesim.tools.outline_file import DrawingError, outline_of

MM = 1e-3
BALL = (
    (0.0, 0.0),
    OutlineArc(to=(3 * MM, 3 * MM), centre=(0.0, 3 * MM), ccw=True),
    (3 * MM, 12 * MM),
    (4 * MM, 12 * MM),
)


def groups(*pairs: tuple[int, object]) -> str:
    return "".join(f"{code}\n{value}\n" for code, value in pairs)


def dxf(*entities: tuple[tuple[int, object], ...], unit: int = 4) -> bytes:
    head = groups(
        (0, "SECTION"), (2, "HEADER"), (9, "$INSUNITS"), (70, unit), (0, "ENDSEC"), (0, "SECTION"), (2, "ENTITIES")
    )
    return (head + "".join(groups(*entity) for entity in entities) + groups((0, "ENDSEC"), (0, "EOF"))).encode()


def line(x0: float, y0: float, x1: float, y1: float) -> tuple[tuple[int, object], ...]:
    return ((0, "LINE"), (8, "0"), (10, x0), (20, y0), (11, x1), (21, y1))


def arc(x: float, y: float, r: float, begin: float, end: float) -> tuple[tuple[int, object], ...]:
    return ((0, "ARC"), (8, "0"), (10, x), (20, y), (40, r), (50, begin), (51, end))


def svg(data: str, unit: str = "mm", more: str = "") -> bytes:
    text = (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="50{unit}" viewBox="0 0 50 50">{more}<path d="{data}"/></svg>'
    )
    return text.encode()


def assert_ball(name: str, raw: bytes, scale: float = 1.0) -> None:
    found = outline_of(strokes_of(name, raw))
    assert len(found) == len(BALL)
    for own, known in zip(found, BALL, strict=True):
        assert end_of(own) == pytest.approx([scale * value for value in end_of(known)], abs=1e-9)
        assert isinstance(own, OutlineArc) == isinstance(known, OutlineArc)
        if isinstance(own, OutlineArc) and isinstance(known, OutlineArc):
            assert own.centre == pytest.approx([scale * value for value in known.centre], abs=1e-9)
            assert own.ccw is known.ccw


def test_a_half_section_in_any_order_and_direction() -> None:
    assert_ball("ball.dxf", dxf(line(4, 12, 3, 12), line(3, 12, 3, 3), arc(0, 3, 3, 270, 0)))


def test_a_whole_section_with_its_axis_stands_anywhere_along_it() -> None:
    """The left half, a centre line and the line that closes the top do not count; the tip is the origin."""
    drawn = dxf(
        arc(0, 43, 3, 180, 0), line(3, 43, 3, 52), line(3, 52, 4, 52), line(4, 52, -4, 52), line(-4, 52, -3, 52),
        line(-3, 52, -3, 43), line(0, 30, 0, 60),
    )  # fmt: skip
    assert_ball("ball.DXF", drawn)


def test_bulges_and_inches() -> None:
    bulge = 0.41421356237309503  # tan(90° / 4)
    polyline = (
        (0, "LWPOLYLINE"),
        (70, 0),
        (10, 0),
        (20, 0),
        (42, bulge),
        (10, 3),
        (20, 3),
        (10, 3),
        (20, 12),
        (10, 4),
        (20, 12),
    )
    assert_ball("ball.dxf", dxf(polyline, unit=1), 25.4)


@pytest.mark.parametrize(
    "data",
    [
        "M0,0A3 3 0 0 0 3,-3V-12H4",
        "m 4 -12 h -1 v 9 a 3,3 0 0 1 -3,3",
        "M-3-12L-3-3A3 3 0 0 0 3-3V-12L4-12",
    ],
)
def test_paths(data: str) -> None:
    assert_ball("ball.svg", svg(data))
    assert_ball("ball.svg", svg(data, "cm"), 10.0)


def test_curves_become_chords() -> None:
    k = 0.5522847498307936  # a quarter of a circle, within 0.03 %
    found = outline_of(strokes_of("ball.svg", svg(f"M0 0C{3 * k} 0 3 {-3 + 3 * k} 3 -3V-12")))
    assert len(found) == 34
    for x, y in (end_of(piece) for piece in found[:-1]):
        assert (x**2 + (y - 3 * MM) ** 2) ** 0.5 == pytest.approx(3 * MM, rel=5e-4)


@pytest.mark.parametrize(
    ("name", "raw", "why"),
    [
        ("a.dxf", dxf(((0, "SPLINE"), (8, "0"))), "SPLINE"),
        ("a.dxf", b"AutoCAD Binary DXF\r\n", "binary"),
        ("a.dxf", b"this is\nno drawing\n", "no DXF"),
        ("a.dxf", dxf(line(1, 0, 3, 5)), "begins on the axis"),
        ("a.dxf", dxf(line(-1, 0, -3, 5)), "right of the axis"),
        ("a.dxf", dxf(line(0, 0, 3, 0), line(3, 1, 3, 9)), "x 3.000 y 1.000 mm is not joined"),
        ("a.dxf", dxf(((0, "LINE"), (10, 0))), "lacks a coordinate"),
        ("a.svg", svg("M0 0A3 2 0 0 0 3 -3"), "elliptical"),
        ("a.svg", svg("M0 0T3 -3"), "`T`"),
        ("a.svg", svg("M0 0L3"), "lack numbers"),
        ("a.svg", svg("M0 0H3", more='<g transform="scale(2)"/>'), "transform"),
        ("a.svg", svg("M0 0H3", more="<rect/>"), "<rect>"),
        ("a.svg", b"<svg", "line 1"),
    ],
)
def test_what_is_no_outline_says_why(name: str, raw: bytes, why: str) -> None:
    with pytest.raises(DrawingError, match=why):
        outline_of(strokes_of(name, raw))


CELL = """gcodesim: 1
machine: gantry_xyz
stock: {{box: [60, 40, 12], zero: top-front-left, material: al6082_t6, resolution: 1}}
tools: {{1: {{type: profile_mill, outline: {name}, flutes: 2}}}}
"""


def test_a_cell_names_the_drawing(tmp_path: Path) -> None:
    (tmp_path / "form.dxf").write_bytes(dxf(arc(0, 3, 3, 270, 0), line(3, 3, 3, 12)))
    (tmp_path / "cell.yaml").write_text(CELL.format(name="form.dxf"))
    loaded = load_cell(tmp_path / "cell.yaml")

    assert loaded.cell is not None
    tool = loaded.cell.tools[1]
    assert tool.diameter == pytest.approx(6 * MM) and tool.flute_length == pytest.approx(12 * MM)  # type: ignore[attr-defined]
    assert [file.name for file in loaded.files] == ["cell.yaml", "form.dxf"]


def test_a_drawing_that_is_no_outline_is_a_finding(tmp_path: Path) -> None:
    (tmp_path / "form.svg").write_bytes(svg("M1 0L3 -6"))
    for name, told in (("form.svg", "is no outline: no line begins on the axis"), ("gone.dxf", "is not there")):
        (tmp_path / "cell.yaml").write_text(CELL.format(name=name))
        (found,) = [f for f in load_cell(tmp_path / "cell.yaml").findings if f.level.name == "ERROR"]
        assert found.code == "GS714" and told in found.message and found.span.line == 4
