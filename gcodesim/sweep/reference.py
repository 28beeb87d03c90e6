"""All keys of a study, and all figures, as Markdown; `docs/study.md` carries them.

`python -m gcodesim.sweep.reference docs/study.md` rewrites the part of that page between its two markers.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Final

from gcodesim.declarations.keys import keys
from gcodesim.declarations.tables import key_table
from gcodesim.key_page import escaped, rewrite
from gcodesim.sweep.factor import FactorKeys
from gcodesim.sweep.measure import MARGINS, MEASURES
from gcodesim.sweep.study_file import Design, RunOptions, Search, Study

SECTIONS: Final[tuple[tuple[str, type], ...]] = (
    ("Top level", Study),
    ("A factor (`vary`)", FactorKeys),
    ("`design`", Design),
    ("`find`", Search),
    ("`options`", RunOptions),
)


def reference() -> str:
    """A table for each class of keys, and one of the figures."""
    parts = []
    for title, cls in SECTIONS:
        parts += [f"### {title}", "", *key_table(list(keys(cls).values())), ""]
    parts += ["### Figures", "", "| figure | column | meaning |", "|---|---|---|"]
    parts += [f"| `{one.name}` | `{one.heading}` | {escaped(one.says)} |" for one in MEASURES.values()]
    for name, (kind, unit) in MARGINS.items():
        what = "linear axis" if kind == "length" else "rotary axis or joint"
        parts.append(f"| `{name}` | `{name}_{unit}` | least distance of a {what} from the ends of its travel |")
    return "\n".join(parts)


if __name__ == "__main__":
    rewrite(Path(sys.argv[1]), reference())
