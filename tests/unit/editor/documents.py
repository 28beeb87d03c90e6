"""Programs and cells as an editor has them, for the tests of what it asks."""

from gcodesim.editor.program_document import Choices, ProgramDocument

CELL = """gcodesim: 1
machine: gantry_xyz
stock: {box: [100, 60, 20], zero: top-front-left, material: al6082_t6, resolution: 1}
tools:
  1: {type: flat_end_mill, diameter: 6 mm, name: Schlichter}
  12: {type: flat_end_mill, diameter: 10 mm}
"""
PROGRAM = """(pocket)
G21 G90 G17
T1 M6 (finisher)
G43 H1
S8000 M3
#<depth>=2
#100=5
o<hole> sub
#<depth>=[#1*2]
G1 Z-#<depth> F200
o<hole> endsub
(holes)
G0 X10 Y#100
o<HOLE> call [1.5]
T12 M6
G43 H12
G0 X[#<depth>+#100]
M2
"""


def program(tmp_path, text=PROGRAM, cell=CELL, **choices):
    if cell:
        (tmp_path / "cell.yaml").write_text(cell)
    path = tmp_path / "part.nc"
    path.write_text(text)
    document = ProgramDocument(path, text, Choices(**choices))
    document.go_on(100_000)
    return document


def at(text, needle, nth=0):
    """Line and column of the nth place of a text."""
    place = -1
    for _ in range(nth + 1):
        place = text.index(needle, place + 1)
    return text.count("\n", 0, place), place - (text.rfind("\n", 0, place) + 1)
