"""Simulate G-code-driven manufacturing cells: programs, robots and machine tools, material and process forces."""

from importlib.metadata import PackageNotFoundError, version

try:
    __version__ = version("gcodesim")
except PackageNotFoundError:  # run from a source tree that was never installed
    __version__ = "0+unknown"
