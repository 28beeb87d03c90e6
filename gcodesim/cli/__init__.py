"""The command line: `gcodesim COMMAND …`."""

from gcodesim.cli.main import main

__all__ = ["main"]
