"""Sines for Bullet that do not depend on the processor.

Bullet asks the library of C for sines and cosines, and glibc has other code for
processors with fused multiplication than for those without. Its sines of long doubles
have one code for all: additions, multiplications and divisions of the x87 unit, which are
exact to the bit on every x86-64 processor. Their results, rounded to doubles, are the nearest
double in all but one of some thousand cases, and the same on every processor in all.

So where the engine's module would call `sin`, it gets the address of a few instructions
that call `sinl`: its table of imported functions (System V ABI, AMD64 supplement, 5.2:
the global offset table) holds those addresses. Nobody else's sines change.
"""

from __future__ import annotations

import ctypes
import mmap
import platform
import struct
import sys
from collections.abc import Iterator
from functools import cache
from typing import Any, Final

# the tags of a dynamic section, and kinds of relocations, that are needed here (ELF-64)
_STRINGS, _SYMBOLS, _IMPORTS_SIZE, _IMPORTS = 5, 6, 2, 23
_RELOCATIONS, _RELOCATIONS_SIZE = 7, 8
_SLOTS: Final = (6, 7)  # R_X86_64_GLOB_DAT, R_X86_64_JUMP_SLOT
_LINK_MAP: Final = 2  # RTLD_DI_LINKMAP
_READ_WRITE: Final = mmap.PROT_READ | mmap.PROT_WRITE

_ENTRY: Final = "f30f1efa"  # endbr64
# double f(double x) { return (double) f_long((long double) x); }; `{0}` is the address of f_long
_ONE: Final = (
    _ENTRY + "4883ec18"  # sub rsp, 24
    "f20f110424 dd0424 db3c24"  # movsd [rsp], xmm0; fld qword [rsp]; fstp tbyte [rsp]
    "48b8{0} ffd0"  # mov rax, f_long; call rax
    "dd1c24 f20f100424"  # fstp qword [rsp]; movsd xmm0, [rsp]
    "4883c418 c3"  # add rsp, 24; ret
)
# void sincos(double x, double *sine, double *cosine), by both
_BOTH: Final = (
    _ENTRY + "53 55 4889fb 4889f5 4883ec28"  # push rbx; push rbp; mov rbx, rdi; mov rbp, rsi; sub rsp, 40
    "f20f11442418"  # movsd [rsp+24], xmm0
    "dd442418 db3c24 48b8{0} ffd0 dd1b"  # fld qword [rsp+24]; fstp tbyte [rsp]; call sinl; fstp qword [rbx]
    "dd442418 db3c24 48b8{1} ffd0 dd5d00"  # the same with cosl; fstp qword [rbp]
    "4883c428 5d 5b c3"  # add rsp, 40; pop rbp; pop rbx; ret
)
_CODE: Final = {
    "sin": (_ONE, ("sinl",)),
    "cos": (_ONE, ("cosl",)),
    "tan": (_ONE, ("tanl",)),
    "sincos": (_BOTH, ("sinl", "cosl")),
}

_kept: list[mmap.mmap] = []  # the instructions, as long as the process lives


@cache
def give_to(module: Any) -> bool:
    """Let the functions of C in a loaded extension module be the same on every processor; whether it could be done.

    Only x86-64 Linux has one form of this; PyBullet has wheels for no other system.
    """
    if not (sys.platform == "linux" and platform.machine() == "x86_64" and sys.maxsize > 2**32):
        return False
    try:
        addresses = _instructions()
        library = ctypes.CDLL(module.__file__)
        found = False
        for name, slot in _imports(library):
            if name in addresses:
                _write(slot, addresses[name])
                found = True
    except (AttributeError, OSError, ValueError):  # a library of C without them, or memory may not hold instructions
        return False
    return found


def _instructions() -> dict[str, int]:
    """Addresses of functions for doubles, by name."""
    libm = ctypes.CDLL("libm.so.6")
    room = mmap.mmap(-1, mmap.PAGESIZE, prot=_READ_WRITE | mmap.PROT_EXEC)
    start = ctypes.addressof(ctypes.c_char.from_buffer(room))
    found = {}
    for name, (text, wanted) in _CODE.items():
        targets = [_address(getattr(libm, one)) for one in wanted]
        found[name] = start + room.tell()
        room.write(bytes.fromhex(text.format(*(struct.pack("<Q", target).hex() for target in targets))))
        room.seek(-(-room.tell() // 16) * 16)
    _kept.append(room)
    return found


def _address(function: Any) -> int:
    address = ctypes.cast(function, ctypes.c_void_p).value
    assert address is not None
    return address


def _imports(library: ctypes.CDLL) -> Iterator[tuple[str, int]]:
    """Functions that a loaded library calls in others: their names, and where it keeps their addresses."""
    base, section = _link_map(library)
    tags = {}
    while (tag := _word(section)) != 0:
        tags[tag], section = _word(section + 8), section + 16
    # glibc has made these absolute, other loaders leave them relative to where the library lies
    strings, symbols = (tags[tag] if tags[tag] >= base else base + tags[tag] for tag in (_STRINGS, _SYMBOLS))
    for table, size in ((_IMPORTS, _IMPORTS_SIZE), (_RELOCATIONS, _RELOCATIONS_SIZE)):
        if table not in tags:
            continue
        first = tags[table] if tags[table] >= base else base + tags[table]
        for place, info, _ in struct.iter_unpack("<QQq", ctypes.string_at(first, tags[size])):
            if info & 0xFFFFFFFF in _SLOTS:
                name = struct.unpack("<I", ctypes.string_at(symbols + 24 * (info >> 32), 4))[0]
                yield ctypes.string_at(strings + name).decode("ascii", "replace"), base + place


def _link_map(library: ctypes.CDLL) -> tuple[int, int]:
    """Where a library lies, and its dynamic section."""
    dlinfo = ctypes.CDLL(None).dlinfo
    dlinfo.argtypes = (ctypes.c_void_p, ctypes.c_int, ctypes.c_void_p)
    place = ctypes.c_void_p()
    if dlinfo(library._handle, _LINK_MAP, ctypes.byref(place)) or place.value is None:
        raise OSError("the loader does not tell where the library lies")
    return _word(place.value), _word(place.value + 16)


def _word(address: int) -> int:
    value: int = struct.unpack("<Q", ctypes.string_at(address, 8))[0]
    return value


def _write(slot: int, address: int) -> None:
    page = slot // mmap.PAGESIZE * mmap.PAGESIZE
    mprotect = ctypes.CDLL(None, use_errno=True).mprotect
    mprotect.argtypes = (ctypes.c_void_p, ctypes.c_size_t, ctypes.c_int)
    if mprotect(page, mmap.PAGESIZE, _READ_WRITE):
        raise OSError(ctypes.get_errno(), "the table of imported functions cannot be written")
    ctypes.c_uint64.from_address(slot).value = address
