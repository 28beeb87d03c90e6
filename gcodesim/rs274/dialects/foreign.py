"""Languages of other kinds of controls: what to say to those who bring a program in one of them."""

from __future__ import annotations

from typing import Final

FOREIGN: Final = {
    "printer": (
        "this is a program for the control of a 3D printer (`{word}`), not for this dialect",
        "take the dialect `marlin`, `klipper` or `reprapfirmware`: `--dialect marlin`, or `dialect:` in the cell",
    ),
    "Klartext": (
        "this is Heidenhain's Klartext (`{word}`): no dialect here reads it",
        "let the post write DIN/ISO blocks, for a Fanuc control as an example",
    ),
    "Okuma": (
        "this is a program for an Okuma OSP (`{word}`): no dialect here reads it",
        "let the post write plain blocks, for a Fanuc control as an example",
    ),
    "Sinumerik": (
        "this is a program for a Sinumerik (`{word}`): no dialect here reads it",
        "let the post write plain blocks, for a Fanuc control as an example",
    ),
    "script": (
        "this is a script that makes a program (`{word}`), as those of CAMotics: no script is run here",
        "let it make its program, as with `tplang part.tpl > part.nc` of CAMotics, and take that",
    ),
}
"""Message and hint of GS016 by the kind that `other_machines.foreign_of` finds; `{word}` is what gave it away."""
