"""MeatPack: two of the fifteen most frequent characters of G-code in a byte.

A half byte 15 says that its character comes whole behind; 255 twice begins a command (MeatPack by S. Mudge,
Firmware/meatpack.cpp; libbgcode, src/LibBGCode/binarize/meatpack.cpp).
"""

from __future__ import annotations

from gcodesim.compiled import kernel
from gcodesim.rs274.plain.columns import Column

_SIGNAL = 255
_PACKING, _NOT_PACKING, _RESET, _NO_BLANKS, _BLANKS = 251, 250, 249, 247, 246
_LINE_END, _BLANK, _G, _E = 10, 32, 71, 69
_WHOLE, _BLANK_CODE = 15, 11


@kernel(lean=True)
def unpack(packed: Column, out: Column, characters: Column) -> int:
    """Fill `out` (twice as long) from `packed`, both uint8; how many characters that are.

    `characters` (15,) are those of the half bytes 0 to 14.
    """
    packing, blank, signals, whole, kept, done = False, _BLANK, 0, 0, -1, 0
    for i in range(len(packed)):
        byte = int(packed[i])
        if signals == 2:
            signals = 0
            if byte == _PACKING:
                packing = True
            elif byte in (_NOT_PACKING, _RESET):
                packing = False
            elif byte == _NO_BLANKS:
                blank = _E
            elif byte == _BLANKS:
                blank = _BLANK
            continue
        if byte == _SIGNAL:
            signals += 1
            continue
        value = _SIGNAL if signals else byte
        while True:
            low, high = value & 15, value >> 4
            if not packing:
                out[done] = value
                done += 1
            elif whole:
                whole -= 1
                out[done] = value
                done += 1
                if kept >= 0:
                    out[done] = kept
                    done += 1
                    kept = -1
            elif low == _WHOLE:
                whole = 1
                if high == _WHOLE:
                    whole = 2
                else:
                    kept = blank if high == _BLANK_CODE else int(characters[high])
            else:
                out[done] = blank if low == _BLANK_CODE else characters[low]
                done += 1
                if out[done - 1] == _LINE_END:  # what is left of the byte only fills it
                    pass
                elif high == _WHOLE:
                    whole = 1
                else:
                    out[done] = blank if high == _BLANK_CODE else characters[high]
                    done += 1
            if not signals:
                break
            signals, value = 0, byte
    return done


@kernel(lean=True)
def spread(text: Column, out: Column, begins_word: Column) -> int:
    """Fill `out` (twice as long) from `text`, both uint8; how many characters that are.

    Lines that begin with G were packed without blanks, and get one before each word again: before characters for
    which `begins_word` (256,) is 1. Empty lines are left out.
    """
    done, spaced, before = 0, False, _LINE_END
    for i in range(len(text)):
        byte = int(text[i])
        if byte == _LINE_END:
            spaced = False
            if before == _LINE_END and done > 0:
                continue
        elif before == _LINE_END and byte == _G:
            spaced = True
        elif spaced and before != _BLANK and begins_word[byte]:
            out[done] = _BLANK
            done += 1
        out[done] = byte
        done += 1
        before = byte
    return done
