"""The library of cutting constants."""

from pathlib import Path

import pytest

from gcodesim.cell.loader import read_cell
from gcodesim.diagnostics import SourceText
from gcodesim.processes.laws import Kienzle, LinearEdge
from gcodesim.processes.materials import LIBRARY, plain


def test_every_entry_names_its_source_and_has_sound_constants():
    for material in LIBRARY.values():
        assert material.source and material.name
        if isinstance(material.law, Kienzle):
            assert 2e8 < material.law.kc11 < 5e9
            assert 0.0 < material.law.mc < 0.4
        elif material.law is not None:
            assert isinstance(material.law, LinearEdge)
            assert material.law.ktc > 2e8
            assert material.law.kte < 5e4 or not material.usable


def test_ids_and_aliases_are_one_name_space():
    names = [plain(name) for material in LIBRARY.values() for name in (material.id, *material.aliases)]

    assert len(names) == len(set(names))
    assert all(LIBRARY[name] is LIBRARY[LIBRARY[name].id] for name in names)


def test_both_tables_are_complete():
    laws = [type(material.law) for material in LIBRARY.values()]

    assert (laws.count(Kienzle), laws.count(LinearEdge)) == (80, 7)


@pytest.mark.parametrize("name", ["42CrMo4", "42crmo4", "42CrMo4 ", "AISI 4140", "seed-42crmo4"])
def test_spelling_is_forgiven(name):
    assert LIBRARY[name].id == "seed_42crmo4"


def test_constants_are_those_of_the_tables():
    steel, aluminium = LIBRARY["42crmo4"].law, LIBRARY["al6082_t6"].law

    assert (steel.kc11, steel.mc, steel.kn11) == pytest.approx((2500e6, 0.26, 750e6))
    assert (aluminium.ktc, aluminium.kte, aluminium.kac) == pytest.approx((631e6, 13e3, 273e6))


def test_what_was_filled_in_is_said():
    assert any("0.3" in text for text in LIBRARY["42crmo4"].assumed)
    assert any("0.24" in text for text in LIBRARY["iscar_38"].assumed)
    assert LIBRARY["al6061_t6"].assumed == ("no axial force",)
    assert LIBRARY["al6082_t6"].assumed == ()


def test_a_doubtful_entry_is_listed_but_marked():
    assert [m.id for m in LIBRARY.values() if not m.usable] == ["almgsi05"]
    assert "Do not use" in LIBRARY["almgsi05"].note


@pytest.mark.parametrize(
    ("wrong", "wanted"),
    [("al6082", "al6082_t6"), ("42crmo", "42crmo4"), ("inconel", "inconel_718"), ("titan", "titanium")],
)
def test_suggestions(wrong, wanted):
    assert wrong not in LIBRARY
    assert wanted in LIBRARY.suggest(wrong)


def test_no_suggestion_for_nonsense():
    assert LIBRARY.suggest("qqqq") == []


@pytest.mark.parametrize("name", ["beech", "MDF", "Delrin", "hdpe", "wax", "graphite", "carbon fibre"])
def test_what_has_no_force_data_is_known_by_name(name):
    material = LIBRARY[name]
    assert material.law is None
    assert "no force data" in material.name


@pytest.mark.parametrize("name", ["ti6al4v", "titanium", "AISI 304", "1.4404"])
def test_titanium_and_stainless_steel_have_constants_with_a_source(name):
    assert LIBRARY[name].law is not None
    assert "ISCAR" in LIBRARY[name].source


@pytest.mark.parametrize(
    ("tool", "codes"),
    [
        ("{type: laser, power: 10 W, diameter: 1, specific_energy: 2 J/mm^3, length: 60}", []),
        ("{type: flat_end_mill, diameter: 6, flutes: 2}", ["GS926"]),
    ],
)
def test_only_what_cuts_asks_for_constants_of_force(tool: str, codes: list[str]) -> None:
    cell = "gcodesim: 1\nmachine: gantry_xyz\nwork_offsets: {G54: {xyz: [400, 300, -300]}}\n"
    cell += "stock: {box: [40, 24, 3], zero: top-front-left, material: plywood}\ntools: {1: " + tool + "}\n"
    found = read_cell(SourceText("cell.yaml", cell.encode()), Path("cell.yaml")).findings
    assert [f.code for f in found] == codes
