"""Form cutters as a cell writes them: read, shown again, and refused with a reason."""

import pytest

from gcodesim.cell.show import cell_as_text
from gcodesim.tools import TOOLS
from gcodesim.tools.cutter import Cutter
from tests.unit.cell.text import loaded, sound

HEAD = "machine: gantry_xyz\ntools:\n  1: "
SIZES = {
    "bull_nose_end_mill": "diameter: 8, corner_radius: 1",
    "corner_rounding_mill": "corner_radius: 2, tip_diameter: 4",
    "dovetail_mill": "diameter: 12, flute_length: 4",
    "key_cutter": "diameter: 16, flute_length: 4",
    "profile_mill": "outline: [[0, 0], {arc: [3, 3], centre: [0, 3]}, [4, 12 mm]]",
    "saw": "diameter: 60, flute_length: 1.5",
    "step_drill": "diameter: 8, tip_diameter: 4, step_length: 5",
    "t_slot_mill": "diameter: 16, flute_length: 4",
    "tap": "diameter: 8, pitch: 1.25",
    "taper_ball_end_mill": "diameter: 6, tip_diameter: 1, taper: 5",
    "v_bit": "diameter: 12, angle: 60",
}
CUTTERS = sorted(kind for kind in TOOLS.own() if issubclass(TOOLS[kind], Cutter))


@pytest.mark.parametrize("kind", CUTTERS)
def test_every_kind_is_read_and_shown_as_it_can_be_written(kind):
    cell = sound(f"{HEAD}{{type: {kind}, {SIZES.get(kind, 'diameter: 10')}}}\n")
    tool = cell.tools[1]
    assert tool.kind == kind
    assert tool.problems() == []
    assert tool.flute_length > 0.0
    assert tool.inertia.mass > 0.0
    text = cell_as_text(cell)
    again = sound(text).tools[1]
    assert again.cutting_shape == pytest.approx(tool.cutting_shape)
    assert again.edge == pytest.approx(tool.edge)


@pytest.mark.parametrize(
    ("written", "said"),
    [
        ("profile_mill, outline: [[1, 0], [3, 5]]", "begins at the tip"),
        ("profile_mill, outline: [[0, 0], [3, 5], [4, 2]]", "comes back down to 2 mm"),
        ("profile_mill, outline: [[0, 0], {arc: [3, 3], centre: [0, 2]}, [3, 9]]", "not as far from"),
        ("chamfer_mill, diameter: 10, tip_diameter: 12", "does not lie between 0 and `diameter`"),
        ("v_bit, diameter: 10, angle: 190", "no cone"),
        ("dovetail_mill, diameter: 6, flute_length: 8", "flanks meet"),
        ("thread_mill, diameter: 8, rows: 3", "need their `pitch`"),
        ("step_drill, diameter: 8, tip_diameter: 4, step_length: 0.5", "ends within the point"),
        ("face_mill, diameter: 10, flute_length: 6", "leaves nothing at the bottom"),
        ("taper_ball_end_mill, diameter: 6, tip_diameter: 7, taper: 5", "less than `diameter`"),
    ],
)
def test_what_cannot_exist_is_refused_with_a_reason(written, said):
    result = loaded(f"{HEAD}{{type: {written}}}\n")
    assert [finding.code for finding in result.findings if finding.code == "GS720"]
    assert any(said in finding.message for finding in result.findings)
