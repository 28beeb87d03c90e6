"""Cases of configurations over whole cuts (tests/data/configurations): answer them, and judge the answers.

    python -m tests.configuration_cases CASES.json RESULTS.json [CASE ...]

writes the answers; `compare.py` beside the cases judges them.
"""

import importlib.util
import json
import sys
from functools import cache
from pathlib import Path

import numpy as np

from gcodesim.kinematics import kinematics_of, load_urdf, model_path
from gcodesim.planning.configuration import SPINS, grid, search
from gcodesim.planning.ladder import Passage, rungs_of
from gcodesim.planning.ladder_kernels import earliest, link
from gcodesim.units import DEG, MM

FOLDER = Path(__file__).parent / "data" / "configurations"


def read_cases(path=FOLDER / "cases.json"):
    return json.loads(path.read_text())


@cache
def compare():
    """The pass rule."""
    spec = importlib.util.spec_from_file_location("configurations_compare", FOLDER / "compare.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@cache
def kinematics_for(name):
    """The kinematics of a shipped robot."""
    chain, findings = load_urdf(model_path(name), name=name)
    assert chain is not None, list(findings)
    return kinematics_of(chain)


def cut_of(case, free):
    """The `Passage` of a case or a placement."""
    poses = np.array(case["poses"], dtype=float)
    X_BT = np.zeros((len(poses), 4, 4))
    z, x = (v / np.linalg.norm(v, axis=1, keepdims=True) for v in (poses[:, 3:6], poses[:, 6:9]))
    x = x - np.sum(x * z, axis=1, keepdims=True) * z
    x /= np.linalg.norm(x, axis=1, keepdims=True)
    X_BT[:, :3, 0], X_BT[:, :3, 1], X_BT[:, :3, 2] = x, np.cross(z, x), z
    X_BT[:, :3, 3] = poses[:, :3] * MM
    X_BT[:, 3, 3] = 1.0
    X_FT = np.array(case["X_FT_mm"], dtype=float)
    X_FT[:3, 3] *= MM
    return Passage(X_BT=X_BT, X_FT=X_FT, free=free, step=np.full(6, case["step_bound_deg"] * DEG))


def degrees(q):
    """Joints in degrees as lists."""
    return (q / DEG).tolist()


def answer(case, mode):
    """The results of one mode of a case."""
    found = search(kinematics_for(case["robot"]), cut_of(case, mode == "free"))
    if found.continuous:
        return {
            "continuous": True,
            "margin_deg": found.clear.margin / DEG,
            "joints": degrees(found.clear.q),
            "joints_travel": degrees(found.short.q),
        }
    start = {"joints": degrees(found.clear.q)} if found.clear else {}
    return {
        "continuous": False,
        "prefix": found.prefix,
        "reason": str(found.obstacle),
        "stretch": list(found.stretch),
        **start,
    }


def can_run(robot, cut, *, spins=SPINS):
    """Whether there is a continuous way through a cut; `search` would also say which and how far."""
    rungs = rungs_of(robot, cut, grid(cut, spins))
    if not rungs.counts.all():
        return False
    return bool(earliest(rungs.ladder, link(rungs.ladder, cut.step, False))[0] == len(cut))


def answer_placement(case):
    """The shifts of a placement with which the cut can be run."""
    robot = kinematics_for(case["robot"])
    cut = cut_of(case, case["spin"] == "free")
    good = [shift for shift in case["grid_mm"] if can_run(robot, cut.shifted(np.array(shift) * MM))]
    return {"good": len(good), "good_shifts_mm": good}


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    data, wanted = read_cases(Path(sys.argv[1])), sys.argv[3:]
    results = {}
    for case in data["cases"]:
        if not wanted or case["id"] in wanted:
            results.update({f"{case['id']}:{mode}": answer(case, mode) for mode in ("fixed", "free")})
    for case in data["placements"]:
        if not wanted or case["id"] in wanted:
            results[case["id"]] = answer_placement(case)
    Path(sys.argv[2]).write_text(json.dumps(results))
    return 0


if __name__ == "__main__":
    sys.exit(main())
