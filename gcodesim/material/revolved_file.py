"""The file of a lathe's stock: a line of text, a line of JSON with sorted keys, then the rings, compressed."""

from __future__ import annotations

import json
import zlib
from pathlib import Path
from typing import Final

import numpy as np

from gcodesim.files.whole_file import write_whole
from gcodesim.material.revolved import Profile, Revolved
from gcodesim.numbers import read_json

MAGIC: Final = b"gcodesim-revolved/1\n"
_MOST_DISCS: Final = 10_000_000
_MOST_RINGS: Final = 1000


def save_revolved(stock: Revolved, path: Path) -> None:
    """Write what is in the chuck, or the part that was parted off last; threads are left out."""
    profile = stock.finished[-1]
    used = np.arange(profile.lo.shape[1])[None, :] < profile.number[:, None]
    head = {
        "discs": len(profile.number),
        "z_m": float(profile.z),
        "dz_m": float(profile.dz),
        "radius_m": float(stock.bounds[1][0]),
        "material": stock.material,
    }
    body = profile.number.astype("<i4").tobytes()
    body += profile.lo[used].astype("<f8").tobytes() + profile.hi[used].astype("<f8").tobytes()
    text = json.dumps(head, sort_keys=True, ensure_ascii=False).encode() + b"\n"
    write_whole(path, MAGIC + text + zlib.compress(body, 1))


def revolved_from_bytes(raw: bytes) -> Revolved:
    """The stock in the bytes of such a file; ValueError or KeyError if they are damaged."""
    text, _, packed = raw[len(MAGIC) :].partition(b"\n")
    head = read_json(text)
    count = int(head["discs"])
    if not 0 < count <= _MOST_DISCS:
        raise ValueError(f"{count} discs are none that gcodesim writes")
    body = zlib.decompress(packed)
    number = np.frombuffer(body[: 4 * count], "<i4").astype(np.int32)
    if len(number) != count or (number < 0).any() or (number > _MOST_RINGS).any():
        raise ValueError("its parts do not fit together")
    total = int(number.sum())
    ends = np.frombuffer(body[4 * count :], "<f8").astype(np.float64)
    if len(ends) != 2 * total:
        raise ValueError("its parts do not fit together")
    k = max(1, int(number.max()))
    used = np.arange(k)[None, :] < number[:, None]
    lo, hi = np.zeros((count, k)), np.zeros((count, k))
    lo[used], hi[used] = ends[:total], ends[total:]
    profile = Profile(lo, hi, number, float(head["z_m"]), float(head["dz_m"]))
    return Revolved(profile=profile, radius=float(head["radius_m"]), material=str(head["material"]))
