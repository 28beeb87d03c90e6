"""Findings GS3xx: what touches what must not be touched."""

from gcodesim.diagnostics.catalogue.code import Code
from gcodesim.diagnostics.finding import Severity

_HOW = (
    " The check sweeps the exact body of the tool along the path and needs no world; the run goes on as if nothing had"
    " been there."
)

CODES: tuple[Code, ...] = (
    Code(
        code="GS301",
        severity=Severity.ERROR,
        title="Cutter hits a fixture",
        what="The cutting part of the tool enters a fixture." + _HOW,
        why="The cutter breaks, the clamp is cut or torn off, and the part comes loose.",
        remedy="Go round the fixture or above it, or move the fixture. The message says where in the work system; when"
        " rapids of the machine move axis by axis, the way of the tool is not the straight line (`rapids`).",
    ),
    Code(
        code="GS302",
        severity=Severity.ERROR,
        title="Shank hits a fixture",
        what="The part of the tool between flutes and holder enters a fixture." + _HOW,
        why="The tool bends or breaks.",
        remedy="Keep more distance to the fixture, or use a longer tool.",
    ),
    Code(
        code="GS303",
        severity=Severity.ERROR,
        title="Holder hits a fixture",
        what="The tool holder enters a fixture." + _HOW,
        why="The holder is much stronger than the tool: spindle, fixture and part are damaged.",
        remedy="Use a longer tool or a slimmer holder, or a lower fixture.",
    ),
    Code(
        code="GS304",
        severity=Severity.ERROR,
        title="Process tool hits a fixture",
        what="The nozzle or body of a process tool enters a fixture." + _HOW,
        why="The tool is bent or torn off, and its calibration is lost.",
        remedy="Lift the tool before it passes the fixture, or move the fixture.",
    ),
)
