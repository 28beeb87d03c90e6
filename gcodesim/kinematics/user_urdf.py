"""Descriptions of robots that a cell names, URDF or MJCF, as chains."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from gcodesim.declarations.file_kind import FileValue
from gcodesim.declarations.reading import UNREAD, Reading, Unread
from gcodesim.declarations.reading import Path as KeyPath

if TYPE_CHECKING:
    from gcodesim.kinematics.chain import Chain
    from gcodesim.kinematics.urdf import NamedFlange


def user_chain(
    file: FileValue, to: Reading, path: KeyPath, flange: str | None = None, *, robot: bool = True
) -> Chain | Unread:
    """The chain of a user's URDF; findings about it point to its own lines. The meshes it names are hashed too.

    `flange` is the link that the cell names as such, beside the key at `path`. One that is no `robot` need not move.
    """
    from gcodesim.kinematics.urdf import load_urdf

    chain, findings = load_urdf(
        file.path,
        name=file.name,
        packages=to.shelf.packages,
        may_read=to.shelf.may_read,
        flange=_flange(flange, to, path),
        robot=robot,
    )
    to.findings.extend(findings)
    return UNREAD if chain is None else _hashed(chain, file, to, path)


def mjcf_chain(file: FileValue, to: Reading, path: KeyPath, flange: str | None, *, has_speeds: bool) -> Chain | Unread:
    """The chain of a user's MJCF, likewise; `has_speeds`: the cell says how fast its joints are."""
    from gcodesim.kinematics.mjcf import load_mjcf

    chain, findings = load_mjcf(
        file.path,
        name=file.name,
        may_read=to.shelf.may_read,
        flange=_flange(flange, to, path),
        has_speeds=has_speeds,
    )
    to.findings.extend(findings)
    return UNREAD if chain is None else _hashed(chain, file, to, path)


def _flange(link: str | None, to: Reading, path: KeyPath) -> NamedFlange | None:
    """The link that the cell names as the flange, beside the key at `path`."""
    from gcodesim.kinematics.urdf import NamedFlange

    return None if link is None else NamedFlange(link=link, span=to.span((*path[:-1], "flange")))


def _hashed(chain: Chain, file: FileValue, to: Reading, path: KeyPath) -> Chain | Unread:
    """The chain, with the files that it names in the list of those that decide the result."""
    for mesh in chain.files:
        name = Path(os.path.relpath(mesh, to.shelf.folder)).as_posix()
        try:
            to.shelf.open(name, mesh)
        except OSError as error:
            return to.fault("GS714", to.span(path), f"mesh `{name}` of `{file.name}` cannot be read: {error.strerror}")
    return chain
