"""Comments in which slicers say what they print: layers, features, sizes of beads.

PrusaSlicer, OrcaSlicer: `;LAYER_CHANGE`, `;TYPE:`, `;WIDTH:`, `;HEIGHT:`. BambuStudio: `; CHANGE_LAYER`,
`; FEATURE:`, `; LINE_WIDTH:`, `; LAYER_HEIGHT:`. Cura: `;LAYER:0`, `;TYPE:`. Simplify3D: `; layer 1, Z = 0.2`,
`; feature`, `; tool H0.2 W0.48`. Kiri:Moto: `;; --- layer 0 (0.25mm @ 0.25mm) ---`, height and place. KISSlicer:
`; BEGIN_LAYER_OBJECT z=0.5 z_thickness=0.25`, `; 'Loop Path', 1.0 [feed mm/s]`. IceSL: `; <layer>`. ideaMaker:
`;LAYER:`, `;TYPE:`, `;WIDTH:`, `;HEIGHT:`.
"""

from __future__ import annotations

import re
from typing import Final

from gcodesim.rs274.marlin.printer import Printer
from gcodesim.units import MM

_LAYER: Final = re.compile(r"(?:LAYER|layer)[: ] ?(-?[0-9]+)\b")
_CHANGE: Final = re.compile(r"LAYER_CHANGE|CHANGE_LAYER")
_FEATURE: Final = re.compile(r"(?:TYPE|FEATURE|feature)[: ] ?(.*)")
_SIZE: Final = re.compile(r"(WIDTH|LINE_WIDTH|HEIGHT|LAYER_HEIGHT) ?: ?([0-9]+\.?[0-9]*|\.[0-9]+)")
_BOTH_SIZES: Final = re.compile(r"tool H([0-9.]+) W([0-9.]+)")
_KIRI: Final = re.compile(r"layer [0-9]+ \(([0-9]*\.?[0-9]+)(?:mm)? @")
_KISS: Final = re.compile(r"BEGIN_LAYER_\w+ z=[-0-9.]+(?: z_thickness=([0-9]*\.?[0-9]+))?")
_KISS_FEATURE: Final = re.compile(r"'([^']+) Path',")
_ICESL: Final = "<layer>"


def take_comment(note: str, printer: Printer) -> bool:
    """Take over what a comment (without its semicolon) says; whether the section has changed."""
    text = note.lstrip(" \t;-")
    before = printer.section
    if found := _FEATURE.match(text):
        printer.section = before._replace(feature=found[1].strip())
    elif found := _SIZE.match(text):
        size = float(found[2]) * MM
        printer.section = before._replace(width=size) if "WIDTH" in found[1] else before._replace(height=size)
    elif found := _BOTH_SIZES.match(text):
        printer.section = before._replace(height=float(found[1]) * MM, width=float(found[2]) * MM)
    elif found := _KISS_FEATURE.match(text):
        printer.section = before._replace(feature=found[1])
    elif _CHANGE.match(text) or text.rstrip() == _ICESL:
        _next_layer(printer)
    elif found := _KISS.match(text):
        _next_layer(printer)
        _take_height(printer, found[1])
    elif (found := _LAYER.match(text)) and not printer.said_layers:
        _next_layer(printer, said=False)
        if found := _KIRI.match(text):
            _take_height(printer, found[1])
    return printer.section != before


def _take_height(printer: Printer, height_mm: str | None) -> None:
    """The height of a layer, where its slicer says it and it is one."""
    if height_mm is not None and (height := float(height_mm)) > 0.0:
        printer.section = printer.section._replace(height=height * MM)


def _next_layer(printer: Printer, said: bool = True) -> None:
    """A layer begins; where a slicer writes both forms, `LAYER_CHANGE` counts."""
    printer.said_layers = printer.said_layers or said
    printer.layers += 1
    printer.section = printer.section._replace(layer=printer.layers)
