"""The language of the laser's control: that of LinuxCNC with short lines, and programs end where the file ends."""

from dataclasses import replace

from gcodesim.rs274.dialects.linuxcnc import LINUXCNC

BRIGHT = replace(LINUXCNC, name="bright", longest_line=40, needs_end=False)
