"""A map of doses: where the beam was, and what it gave there."""

from __future__ import annotations

from typing import ClassVar, TextIO

from gcodesim.export.exporter import Exporter, NoExportError, Option, Request, counted
from gcodesim.playback.recording import Recording


class Doses(Exporter):
    """`gcodesim export LOG --to doses`."""

    kind: ClassVar[str] = "doses"
    says: ClassVar[str] = "place of the tip [mm] and dose [J/mm^2], one line for each sample with the beam on"
    suffix: ClassVar[str] = ".doses.txt"
    takes: ClassVar[frozenset[Option]] = frozenset(("time", "lines", "period"))

    def write(self, recording: Recording, out: TextIO, request: Request) -> str:
        process, tip = recording.series("/process"), recording.series("/tcp")
        names = list(process.names)
        if "dose_j_mm2" not in names:
            raise NoExportError("no engraver was at work in this run")
        dose = process.values[:, names.index("dose_j_mm2")]
        at = [list(tip.names).index(f"pose.position.{axis}") for axis in "xyz"]
        places = tip.values[:, at] * 1e3
        count = 0
        for index in request.part.chosen(process.t_ns):
            if dose[index] > 0.0:
                x, y, z = places[index]
                out.write(f"{x:.3f} {y:.3f} {z:.3f} {dose[index]:.6g}\n")
                count += 1
        return counted(count, "dose")
