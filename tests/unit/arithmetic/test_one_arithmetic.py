"""Nothing that may reach a file is computed by code that depends on the processor; see docs/decisions/0009."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

import gcodesim

ROOT = Path(gcodesim.__file__).parent
FUNCTIONS = {
    *("sin", "cos", "tan", "asin", "acos", "atan", "atan2", "sinh", "cosh", "tanh", "asinh", "acosh", "atanh"),
    *("arcsin", "arccos", "arctan", "arctan2", "arcsinh", "arccosh", "arctanh", "exp", "exp2", "expm1"),
    *("log", "log2", "log10", "log1p", "pow", "power", "float_power", "cbrt", "erf", "gamma", "lgamma", "sinc"),
}
OF_NUMPY = {
    *("dot", "matmul", "vdot", "inner", "tensordot", "einsum", "linalg", "polyfit", "polyval", "convolve", "correlate"),
    *("hypot", "cov", "corrcoef", "fft", "logspace", "geomspace"),
}
# modules that may, and why
LIBRARIES = {
    "motion/builders.py": "splines by scipy: paths that a Python program builds, before the first file",
    "compiled/compiling.py": "keeps numba from loading scipy",
    "material/skin.py": "which of given points is nearest: scipy's tree compares plain sums",
    "sweep/design.py": "which points of a study are spread: whole numbers and their halves",
    "sweep/search.py": "which points a search tries: they are in its table, and each run says what it is",
}
# where `@` joins poses, which are no arrays
POSES = {
    *("cell/placement.py", "cell/placing.py", "cell/reach.py", "checks/clearance.py", "checks/missing_length.py"),
    *(
        "executor/part_run.py",
        "executor/track.py",
        "planning/shop_posing.py",
        "recorder/frames.py",
        "scene/scene.py",
        *(f"shop/{name}.py" for name in ("blanks", "opening", "shop", "stands", "stocking")),
    ),
    *("checks/machine_bodies.py", "checks/machine_collisions.py", "checks/sharing.py", "jobs/meetings.py"),
    *(
        "session/arm.py",
        "session/cell_in_hand.py",
        "session/path_frame.py",
        "solids/solid.py",
        "kinematics/assembly.py",
        "cell/externals.py",
    ),
    *("jobs/verification.py", "jobs/collisions.py", "cell/assembly.py", "checks/cell_bodies.py"),
    *("checks/cell_meetings.py", "kinematics/posed_links.py", "tools/own_body.py", "tools/tool.py"),
    *("recorder/bodies.py", "recorder/loose.py", "cell/machine.py", "cell/surfaces.py"),
    *("checks/stock_watch.py", "post/language.py", "post/from_plan.py", "material/beam.py"),
}
SCREEN = {"world/window.py", "observation/spectator.py"}
"""What is seen in a window and clicked at; nothing of it comes into a file."""
SCRIPTS = "pybullet_industrial"
"""This package computes what scripts of another project computed, by the same functions; programs do not get there."""
ARRAYS = {"R", "T", "p", "q", "matrix", "turn"}  # attributes that are arrays, not poses


def faults(path: str, source: str) -> Iterator[str]:
    """What is not allowed in the module `path`, with its line."""
    for node in ast.walk(ast.parse(source)):
        if found := fault(path, node):
            yield f"{path}:{getattr(node, 'lineno', 0)}: {found}"


def fault(path: str, node: ast.AST) -> str:
    """What is wrong with a part of a module; empty if nothing is."""
    if isinstance(node, ast.Attribute):
        owner = node.value.id if isinstance(node.value, ast.Name) else ""
        of_c = owner == "cmath" or (owner == "math" and node.attr in FUNCTIONS)
        of_numpy = owner in ("np", "numpy") and node.attr in FUNCTIONS | OF_NUMPY
        return f"{owner}.{node.attr}" if of_c or of_numpy or node.attr == "dot" else ""
    if isinstance(node, ast.ImportFrom | ast.Import):
        module = (node.module or "") if isinstance(node, ast.ImportFrom) else ""
        names = {alias.name for alias in node.names}
        if (module in ("math", "numpy") and names & (FUNCTIONS | OF_NUMPY)) or module.startswith("numpy.linalg"):
            return f"{module}: {sorted(names)}"
        scipy = any(name.split(".")[0] == "scipy" for name in (module, *names))
        return "scipy" if scipy and path not in LIBRARIES else ""
    if isinstance(node, ast.AugAssign):
        return "**= or @=" if isinstance(node.op, ast.Pow | ast.MatMult) else ""
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Pow):
        exact = isinstance(node.left, ast.Constant) and node.left.value in (2, 10)
        return "" if exact else "** of anything but 2 and 10, whose whole powers are exact"
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.MatMult):
        return "" if path in POSES and not any(map(is_array, (node.left, node.right))) else "@"
    return ""


def is_array(side: ast.expr) -> bool:
    """Whether an operand is plainly an array: `X_WB.R`, `a[0]`; `frames["table"]` may be a pose."""
    if isinstance(side, ast.Attribute):
        return side.attr in ARRAYS
    return isinstance(side, ast.Subscript) and not isinstance(side.value, ast.Attribute)


def test_no_module_asks_the_library_of_c_numpy_or_blas() -> None:
    found = [
        fault
        for path in sorted(ROOT.rglob("*.py"))
        if SCRIPTS not in path.parts and path.relative_to(ROOT).as_posix() not in SCREEN
        for fault in faults(path.relative_to(ROOT).as_posix(), path.read_text(encoding="utf-8"))
    ]
    assert not found, "\n".join(["use gcodesim.arithmetic:", *found])


@pytest.mark.parametrize(
    "line",
    [
        *("math.sin(x)", "np.exp(x)", "A @ B", "np.linalg.norm(x)", "x**2", "2.5**x", "A.dot(B)", "A.T.dot(B)"),
        *("x **= 3", "from math import atan2", "from scipy.spatial import KDTree", "import scipy.linalg"),
    ],
)
def test_each_way_out_is_found(line: str) -> None:
    assert list(faults("planning/plan.py", line))


@pytest.mark.parametrize("line", ["math.sqrt(x)", "math.hypot(x, y)", "10.0**n", "2**k", "np.cross(a, b)"])
def test_what_is_exact_or_made_of_exact_steps_may_stay(line: str) -> None:
    assert not list(faults("planning/plan.py", line))


def test_poses_may_be_joined_where_they_are_and_arrays_may_not() -> None:
    assert not list(faults("shop/stands.py", "X_WB @ stand.X"))
    for line in ("X_WB.R @ v", "X_WB.R.T @ v", "a[0] @ b"):
        assert list(faults("shop/stands.py", line))


def test_exceptions_are_still_needed() -> None:
    for path in LIBRARIES:
        assert "scipy" in (ROOT / path).read_text(encoding="utf-8")
    for path in POSES:
        assert " @ " in (ROOT / path).read_text(encoding="utf-8")
