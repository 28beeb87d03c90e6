"""Shipped machines and users' URDFs for the cell: chains with limits, and what a URDF cannot say."""

from __future__ import annotations

import os
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from gcodesim.declarations.file_kind import FileValue
from gcodesim.declarations.reading import UNREAD, Reading, Unread, suggestion
from gcodesim.declarations.reading import Path as KeyPath

if TYPE_CHECKING:
    from gcodesim.kinematics.chain import Chain
    from gcodesim.kinematics.models import ShippedModel


def shipped(name: str, kind: Literal["arm", "machine"], to: Reading, path: KeyPath) -> ShippedModel | Unread:
    """The shipped model of this name, or a finding that names similar ones."""
    from gcodesim.kinematics.models import MODELS

    model: ShippedModel | None = MODELS.get(name)
    if model is not None and model.kind == kind:
        return model
    span = to.span(path)
    if model is not None:
        right = (
            f"write `machine: {name}`"
            if model.kind == "machine"
            else f"write it under `robots:`, as `arm: {{model: {name}}}`"
        )
        what = "a machine tool" if model.kind == "machine" else "a robot arm"
        return to.fault("GS712", span, f"`{name}` is {what}", right)
    known = [m.name for m in MODELS.values() if m.kind == kind]
    what = "machine" if kind == "machine" else "robot"
    return to.fault("GS712", span, f"no {what} model `{name}` ships with gcodesim", suggestion(name, known))


@cache
def shipped_chain(name: str) -> Chain:
    """The chain of a shipped model."""
    from gcodesim.kinematics.models import model_path
    from gcodesim.kinematics.urdf import load_urdf

    chain, findings = load_urdf(model_path(name))
    if chain is None:
        raise RuntimeError(f"the shipped model {name} is broken: {findings}")
    return chain


def user_chain(file: FileValue, to: Reading, path: KeyPath, flange: str | None = None) -> Chain | Unread:
    """The chain of a user's URDF; findings about it point to its own lines. The meshes it names are hashed too.

    `flange` is the link that the cell names as such, beside the key at `path`.
    """
    from gcodesim.kinematics.urdf import NamedFlange, load_urdf

    chain, findings = load_urdf(
        file.path,
        name=file.name,
        packages=to.shelf.packages,
        may_read=to.shelf.may_read,
        flange=None if flange is None else NamedFlange(link=flange, span=to.span((*path[:-1], "flange"))),
    )
    to.findings.extend(findings)
    if chain is None:
        return UNREAD
    for mesh in chain.files:
        name = Path(os.path.relpath(mesh, to.shelf.folder)).as_posix()
        try:
            to.shelf.open(name, mesh)
        except OSError as error:
            return to.fault("GS714", to.span(path), f"mesh `{name}` of `{file.name}` cannot be read: {error.strerror}")
    return chain
