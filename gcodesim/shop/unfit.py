"""What of a cell does not fit its machine: tools that take nothing, meshes that cannot be read."""

from __future__ import annotations

from gcodesim.diagnostics import Diagnostic
from gcodesim.shop.shop import Shop
from gcodesim.solids import Mesh, MeshError, MeshFile, read_mesh


def idle_on_lathe(shop: Shop) -> list[Diagnostic]:
    """GS435 for each tool that could take or add material, but not on this machine."""
    if not (shop.cell.stocks and shop.cell.tools):
        return []
    from gcodesim.processes import PROCESSES

    findings = []
    for number, tool in sorted(shop.cell.tools.items()):
        if shop.mover.lathe and any(PROCESSES[kind].together for kind in tool.processes):
            findings.append(
                Diagnostic(
                    code="GS435",
                    span=shop.cell.span("tools", str(number)),
                    message=f"{tool.name} is moved but does nothing to the work: only lathe tools, drills and driven "
                    "tools change what a lathe turns",
                    hint="`stock: {from: …}` takes what was turned to a machine of another kind, also one with an "
                    "axis about which it turns",
                )
            )
            continue
        turns = "turning" in tool.processes
        if turns == shop.mover.lathe or not (turns or "milling" in tool.processes) or tool.kind == "drill":
            continue
        if tool.is_driven:
            continue
        what = "it stands, unless it is driven" if shop.mover.lathe else "the work does not turn"
        hint = (
            "`driven: true` makes it a driven tool, against which the work stands or is turned by a C axis"
            if shop.mover.lathe
            else "turn with lathe tools on a lathe (`machine: lathe_xz`), mill with mills on other machines"
        )
        findings.append(
            Diagnostic(
                code="GS435",
                span=shop.cell.span("tools", str(number)),
                message=f"{tool.name} is moved but takes nothing: {what}",
                hint=hint,
            )
        )
    return findings


def undrawn(shop: Shop) -> list[Diagnostic]:
    """A finding for each mesh of the robot, or of a tool's own body, that cannot be read."""
    cell = shop.cell
    links = [shape.placed.solid for shape in shop.kinematics.link_shapes]
    owners = [(f"`{shop.name}`", cell.span("robots", shop.name), links)]
    for number, tool in sorted(cell.tools.items()):
        bodies = [placed.solid for _, placed in tool.own_shapes()]
        owners.append((tool.name, cell.span("tools", number, "body"), bodies))
    findings = []
    for name, span, solids in owners:
        meshes = (solid.source for solid in solids if isinstance(solid, Mesh))
        for file in dict.fromkeys(mesh.path for mesh in meshes if isinstance(mesh, MeshFile)):
            try:
                read_mesh(file)
            except MeshError as fault:
                message = f"a mesh of {name} cannot be drawn: {fault}"
                findings.append(Diagnostic(code="GS770", span=span, message=message, hint=fault.hint))
    return findings
