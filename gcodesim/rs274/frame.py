"""The data of one call of a subroutine."""

from __future__ import annotations

from dataclasses import dataclass, field

from gcodesim.diagnostics import Caller
from gcodesim.frozen import frozen
from gcodesim.rs274.program_file import ProgramFile
from gcodesim.rs274.state import ModalState


@frozen(kw_only=False)
class Label:
    """An O-word seen in this subroutine: what opened it, and at which line of which file."""

    kind: str
    index: int
    left: int | None = None  # rounds of a repeat still to go; None where the count is to be computed


@dataclass(slots=True)
class Frame:
    """The running main program or subroutine; `at` is the index of the line to execute next."""

    file: ProgramFile
    at: int
    name: str = ""
    first: int = 0  # index of the line that opened the subroutine
    by_m98: bool = False
    rounds: int = 1  # M98 L: how often still
    arguments: tuple[float, ...] = ()  # the caller's #1 to #30
    named: dict[str, float] = field(default_factory=dict)  # the caller's named parameters
    callers: tuple[Caller, ...] = ()
    saved: ModalState | None = None  # M70, M73
    saved_g92: bool = False  # whether G92 was in force then
    restores: bool = False  # M73

    @property
    def calls_at_moves(self) -> bool:
        """Whether each move calls a macro."""
        return False

    def resume(self, file: ProgramFile) -> None:
        """Go on in another text of the same file, whose lines up to here are the same."""
        self.file = file

    def situation(self) -> tuple[object, ...]:
        """What of it decides how the program goes on, as a copy."""
        file = (id(self.file), self.at, self.name, self.first, self.by_m98, self.rounds)
        return (*file, self.arguments, dict(self.named), self.saved, self.saved_g92, self.restores)
