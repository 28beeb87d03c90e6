"""A cell as it was understood: every value with its unit, defaults marked, places resolved."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Final

import numpy as np

from gcodesim.canon.systems import name_of_system
from gcodesim.cell.cell import MAIN, Cell
from gcodesim.cell.loader import ROOT
from gcodesim.cell.placement import Placement, place
from gcodesim.declarations.kind import Json
from gcodesim.declarations.reading import Path, dotted
from gcodesim.declarations.tables import inline_text
from gcodesim.diagnostics.plain import one_line
from gcodesim.frames import Pose
from gcodesim.units import MM

SCHEMA: Final = "gcodesim-cell/1"
_DEFAULT: Final = "default"


def cell_as_text(cell: Cell) -> str:
    """The cell as YAML with every default written out and marked; derived values follow as comments."""
    marks = {default.path: f"{_DEFAULT}: {default.why}" if default.why else _DEFAULT for default in cell.defaults_used}
    lines = [f"# {one_line(cell.name)} as gcodesim understands it; what is marked {_DEFAULT} is not written there"]
    _tree(ROOT.show(_as_written(cell)), (), "", marks, lines)
    placement = place(cell, next(iter(cell.channels)))
    lines += ["", "# where things stand: x, y, z [mm]; quaternion x, y, z, w"]
    lines += [f"#   {one_line(name)} in {parent}: {_pose_text(X)}" for name, parent, X in _poses(cell, placement)]
    lines += [f"# {finding.level.word} {finding.code}: {one_line(finding.message)}" for finding in placement.findings]
    return "\n".join(lines) + "\n"


def cell_as_json(cell: Cell) -> Json:
    """The same in JSON: units in the names, defaults by path, places resolved."""
    placement = place(cell, next(iter(cell.channels)))
    poses = _poses(cell, placement)
    return {
        "schema": SCHEMA,
        "name": cell.name,
        "cell": ROOT.plain(_as_written(cell))[1],
        "defaults": [{"path": dotted(default.path), "why": default.why} for default in cell.defaults_used],
        "places": {
            name: {"in": parent, "xyz_mm": _mm(X), "quaternion_xyzw": _rounded(X.q)} for name, parent, X in poses
        },
    }


def _as_written(cell: Cell) -> Cell:
    """The keys of a single channel at top level, as in the file."""
    if ("channels",) in cell.spans:
        return cell
    return replace(cell, only_channel=cell.channels[MAIN], channels={})


def _poses(cell: Cell, placement: Placement) -> list[tuple[str, str, Pose]]:
    seconds = {f"{name}/{robot.chain.links[0].name}" for name, robot in cell.robots.items()}
    seconds -= {robot.base_frame for robot in cell.robots.values()}  # other names of bases
    rows = [(name, "world", X) for name, X in cell.frames.items() if name != "world" and name not in seconds]
    systems = placement.given or ((1,) if placement.automatic else ())
    zero = "machine" if cell.machine else "base"
    rows += [(name_of_system(index), zero, placement.work_offsets[index]) for index in systems]
    rows += [(f"stock {name}", "world", X) for name, X in placement.stocks.items()]
    rows += [(f"fixture {name}", "world", X) for name, X in placement.fixtures.items()]
    rows += [(f"part {name}", "world", X) for name, X in placement.parts.items()]
    rows += [(f"sensor {name}", "world", X) for name, X in placement.sensors.items()]
    rows += [(f"device {name}", "world", X) for name, X in placement.devices.items()]
    rows += [(name, on.link, on.X) for name, on in cell.carried.items()]
    rows += [(name.replace("/", " ", 1), on.link, on.X) for name, on in placement.carried.items()]
    return rows + ([("target", "world", placement.target)] if placement.target is not None else [])


def _tree(value: Json, path: Path, indent: str, marks: dict[Path, str], lines: list[str]) -> None:
    for name, content in value.items():
        at = (*path, name)
        mark = f"  # {one_line(marks[at])}" if at in marks else ""
        if isinstance(content, dict) and content:
            lines.append(f"{indent}{inline_text(name)}:{mark}")
            _tree(content, at, indent + "  ", marks, lines)
        else:
            lines.append(f"{indent}{inline_text(name)}: {inline_text(content)}{mark}")


def _rounded(values: Any) -> list[float]:
    return [float(v) + 0.0 for v in np.round(np.asarray(values, dtype=float), 12)]


def _mm(X: Pose) -> list[float]:
    return [float(v) + 0.0 for v in np.round(X.p / MM, 9)]


def _pose_text(X: Pose) -> str:
    turned = not np.allclose(X.R, np.eye(3), atol=1e-12)
    turn = f"; {', '.join(f'{v:.9g}' for v in _rounded(X.q))}" if turned else ""
    return f"{', '.join(f'{v:.9g}' for v in _mm(X))}{turn}"
