"""Families: what ships, and what other distributions add by entry points."""

import subprocess
import sys

import pytest

from gcodesim.family import Family

ASK = """
import sys
sys.path.insert(0, sys.argv[1])
from gcodesim.family import Family
family = Family("colours", red="math:pi", blue="math:e")
print(sorted(family), [family[name] for name in family])
"""


@pytest.mark.parametrize(
    ("folder", "group", "found"),
    [
        ("other-1.0.dist-info", "gcodesim.colours", "['blue', 'green', 'red']"),
        ("other.egg-info", "gcodesim.colours", "['blue', 'green', 'red']"),
        ("other-1.0.dist-info", "gcodesim.sounds", "['blue', 'red']"),
        ("other-1.0.dist-info", "console_scripts", "['blue', 'red']"),
        ("other", "gcodesim.colours", "['blue', 'red']"),
    ],
)
def test_others_add_theirs(tmp_path, folder, group, found):
    (tmp_path / folder).mkdir()
    (tmp_path / folder / "METADATA").write_text("Metadata-Version: 2.1\nName: other\nVersion: 1.0\n")
    (tmp_path / folder / "PKG-INFO").write_text("Metadata-Version: 2.1\nName: other\nVersion: 1.0\n")
    (tmp_path / folder / "entry_points.txt").write_text(f"[{group}]\ngreen = math:tau\nred = math:inf\n")
    done = subprocess.run([sys.executable, "-c", ASK, str(tmp_path)], capture_output=True, text=True, check=True)
    assert done.stdout.startswith(found)
    assert "inf" not in done.stdout  # what ships keeps its name


def test_a_name_that_is_not_there():
    with pytest.raises(KeyError):
        Family("colours", red="math:pi")["green"]
