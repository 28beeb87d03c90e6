"""The command line: `gcodesim COMMAND …`."""

from gcodesim.cli import generated

generated.use_kept()

from gcodesim.cli.main import main  # noqa: E402  (it brings classes, which find their methods compiled now)

__all__ = ["main"]
