"""Compiles kernels before they are needed, on all cores, and says how far it is."""

from __future__ import annotations

import compileall
import time
from collections.abc import Callable, Sequence
from pathlib import Path

from gcodesim.compiled import is_compiler_off
from gcodesim.compiled.known import known_parts, missing, part_with
from gcodesim.compiled.parallel import compile_all

Say = Callable[[str], None]


def warm_up(say: Say) -> bool:
    """Compile everything that is on the list of kernels; those that are there already take only a moment.

    Returns whether all of them are there now.
    """
    # a package installed with `-e` has no byte code, which costs 0.2 s at each start if none can be written
    compileall.compile_dir(Path(__file__).parent, quiet=2)
    if is_compiler_off():
        say("NUMBA_DISABLE_JIT is set: kernels run as Python, and none is compiled")
        return True
    parts = known_parts()
    ahead = {name: missing(signatures) for name, signatures in parts.items()}
    if not any(ahead.values()):
        say(f"all {sum(map(len, parts.values()))} kernels are compiled")
    done = [_compile(name, signatures, say) for name, signatures in ahead.items() if signatures]
    return all(done)


def warm_up_for(signature: str, obstacle: str, say: Say) -> None:
    """Compile the part of the list in which a kernel is, which is about to be called; see `compiled.when_cold`."""
    part = part_with(signature)
    name = part[0] if part else signature.partition(" ")[0]
    if obstacle:
        _say_once(f"compiling kernels, and again at the next run, since they cannot be kept: {obstacle}", say)
    elif part is None:
        say(f"compiling {name}, once for this version")
    else:
        _compile(name, missing(part[1]), say)


def _compile(name: str, signatures: Sequence[str], say: Say) -> bool:
    """Returns whether all could be compiled."""
    begin = time.monotonic()
    what = f"compiling kernels, once for this version: {name}"
    say(f"{what}, {len(signatures)} on all cores")
    failed = compile_all(signatures, lambda done: say(f"{what}, {_far(done, len(signatures), begin)}"))
    for signature, reason in failed.items():
        say(f"{signature.partition(' ')[0]}: {reason}")
    return not failed


def _far(done: int, count: int, begin: float) -> str:
    return f"{done} of {count} done, {time.monotonic() - begin:.0f} s"


def _say_once(text: str, say: Say) -> None:
    if text not in _SAID:
        _SAID.append(text)
        say(text)


_SAID: list[str] = []
