"""Packages that only some commands need: each belongs to an extra, which `pip install 'gcodesim[NAME]'` brings."""

from __future__ import annotations

from typing import Final

EXTRAS: Final = {
    "dae": ("pycollada",),
    "compile": ("numba",),
    "live": ("foxglove-sdk",),
    "lsp": ("pygls",),
    "mcp": ("mcp",),
    "mjcf": ("mujoco",),
    "plot": ("matplotlib",),
    "report": ("metaflow-card-uplot",),
    "ros": ("rosbags",),
    "rosbridge": ("roslibpy",),
    "scale": ("cryptography", "distributed", "pyarrow"),
    "usd": ("usd-core",),
}
"""The packages of each extra that a command may need, as package indexes name them."""


class ExtraMissingError(Exception):
    """Something needs an extra that is not installed; the text names both, and the command that installs it."""


def require_extra(name: str, what: str) -> None:
    """ExtraMissingError if a package of the extra `name` is missing, without which there can be no `what`.

    Nothing is imported, so a command may ask before it does any work.
    """
    missing = [package for package in EXTRAS[name] if not _is_installed(package)]
    if missing:
        raise ExtraMissingError(
            f"{what} needs the extra `{name}`, which is not installed (no {', no '.join(missing)}): "
            f"pip install 'gcodesim[{name}]'"
        )


def _is_installed(package: str) -> bool:
    from importlib.metadata import PackageNotFoundError, distribution  # costs as much as a third of a short `lint`

    try:
        distribution(package)
    except PackageNotFoundError:
        return False
    return True
