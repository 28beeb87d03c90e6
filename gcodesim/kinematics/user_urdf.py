"""URDF files that a cell names, as chains."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from gcodesim.declarations.file_kind import FileValue
from gcodesim.declarations.reading import UNREAD, Reading, Unread
from gcodesim.declarations.reading import Path as KeyPath

if TYPE_CHECKING:
    from gcodesim.kinematics.chain import Chain


def user_chain(
    file: FileValue, to: Reading, path: KeyPath, flange: str | None = None, *, robot: bool = True
) -> Chain | Unread:
    """The chain of a user's URDF; findings about it point to its own lines. The meshes it names are hashed too.

    `flange` is the link that the cell names as such, beside the key at `path`. One that is no `robot` need not move.
    """
    from gcodesim.kinematics.urdf import NamedFlange, load_urdf

    chain, findings = load_urdf(
        file.path,
        name=file.name,
        packages=to.shelf.packages,
        may_read=to.shelf.may_read,
        flange=None if flange is None else NamedFlange(link=flange, span=to.span((*path[:-1], "flange"))),
        robot=robot,
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
