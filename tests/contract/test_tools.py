"""What every kind of tool promises, whoever adds it."""

from dataclasses import fields

import numpy as np
import pytest

from gcodesim.declarations.composed import ListOf
from gcodesim.declarations.keys import all_keys, inlined
from gcodesim.declarations.plain_kinds import Text, Whole
from gcodesim.declarations.quantity import Quantity
from gcodesim.processes import PROCESSES
from gcodesim.tools import TOOLS
from gcodesim.tools.outline_kind import OutlineKind
from gcodesim.tools.sections import Holder
from gcodesim.tools.suction_gripper import Cup

# a sound value for any required key, by its kind
SAMPLE = {
    ListOf: (Cup(diameter=10.0e-3),),
    Quantity: 4.0e-3,
    Whole: 2,
    Text: "tool",
    OutlineKind: ((0.0, 0.0), (3.0e-3, 1.0e-3), (5.0e-3, 20.0e-3)),
}
# where one value for all would be an impossible tool
SPECIAL = {"diameter": 10.0e-3, "bead_height": 2.0e-3, "tip_diameter": 1.0e-3, "angle": 1.5, "taper": 0.3}


def sample(kind: str, **more):
    keys = all_keys(TOOLS[kind]).values()
    required = {p.field: SPECIAL.get(p.name, SAMPLE[type(p.kind)]) for p in keys if p.required}
    return TOOLS[kind](number=3, **required, **more)


@pytest.mark.parametrize("kind", TOOLS)
def test_is_named_as_in_the_table(kind):
    assert TOOLS[kind].kind == kind
    assert all(process in PROCESSES for process in TOOLS[kind].processes)


@pytest.mark.parametrize("kind", TOOLS)
def test_every_field_but_the_number_is_a_documented_key(kind):
    told = {p.field for p in all_keys(TOOLS[kind]).values()}

    groups = inlined(TOOLS[kind])
    within = {field.name for inner, _ in groups.values() for field in fields(inner)}
    assert told == ({field.name for field in fields(TOOLS[kind])} | within) - {"number", *groups}
    assert all(p.doc and p.kind.expected for p in all_keys(TOOLS[kind]).values())


@pytest.mark.parametrize("kind", TOOLS)
def test_required_keys_are_enough_for_a_sound_tool(kind):
    tool = sample(kind)

    assert tool.problems() == []
    assert tool.name == "T3"


@pytest.mark.parametrize("kind", TOOLS)
def test_bodies_fill_the_true_length(kind):
    holder = Holder(diameter=0.04, length=0.05)
    tool = sample(kind, holder=holder)

    # what acts at a distance is nowhere nearer to its tip than its stand-off
    begin = getattr(tool, "stand_off", 0.0)
    assert min(body.bottom for body in tool.primitives) == pytest.approx(begin, abs=1e-15)
    assert max(body.top for body in tool.primitives) == pytest.approx(tool.true_length)
    assert tool.true_length == pytest.approx(tool.length + 0.05)
    assert tool.X_FT.p[2] == pytest.approx(tool.true_length)


@pytest.mark.parametrize("kind", TOOLS)
def test_weighs_something_between_tip_and_nose(kind):
    tool = sample(kind)
    found = tool.inertia

    assert found.mass > 0.0
    assert 0.0 < found.center < tool.true_length
    assert 0.0 < found.axial <= 2.0 * found.transverse  # a body cannot have more

    assert sample(kind, mass=1.5).inertia.mass == pytest.approx(1.5)


@pytest.mark.parametrize("kind", TOOLS)
def test_tools_are_values(kind):
    assert sample(kind) == sample(kind)
    with pytest.raises(AttributeError):
        sample(kind).length = 1.0


@pytest.mark.parametrize("kind", [kind for kind in TOOLS if "milling" in TOOLS[kind].processes])
def test_shape_and_edge_tell_of_the_same_outline(kind):
    """The underside of the removal shape at a radius is the height of the edge there."""
    from gcodesim.material.kernels import underside

    tool = sample(kind)
    if tool.form is not None:
        pytest.skip("cut by its outline itself")
    for row in tool.edge:
        s = np.linspace(0.05, 0.95, 7)
        if row[0] > 0.0:
            kappa = row[3] + s * (row[4] - row[3])
            r, z = row[1] + row[0] * np.sin(kappa), row[2] - row[0] * np.cos(kappa)
        else:
            r, z = row[1] + s * row[5] * np.cos(row[3]), row[2] + s * row[5] * np.sin(row[3])
        if r[-1] - r[0] > 1e-9:
            assert [underside(tool.cutting_shape, radius) for radius in r] == pytest.approx(list(z), abs=1e-12)
