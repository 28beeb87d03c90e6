"""The stays of one part in a run so far, kept as bare numbers: a thousand of them are some 150 kB."""

from __future__ import annotations

from array import array
from collections.abc import Iterator
from typing import Final

import numpy as np

from gcodesim.frames import Pose
from gcodesim.scene.stay import Stay

_NUMBERS: Final = 16  # of each stay: position (3), rotation (9), begin, end, opening, room


class Past:
    """Where the part whose frame is `body` has been, in the order of time."""

    def __init__(self, body: str) -> None:
        self._body = body
        self._numbers = array("d")
        self._words: dict[str, int] = {}  # names of parents and holders
        self._named = array("q")  # of each stay: its parent, its holder

    def __len__(self) -> int:
        return len(self._named) // 2

    def add(self, stay: Stay) -> None:
        """The part is there from now on; the stay before ended when it left."""
        assert stay.body == self._body
        self._numbers.extend(stay.X.p.tolist())
        self._numbers.extend(stay.X.R.ravel().tolist())
        self._numbers.extend((stay.begin, stay.end, stay.opening, stay.room))
        self._named.extend(self._words.setdefault(word, len(self._words)) for word in (stay.parent, stay.holder))

    def leave(self, end: float) -> None:
        """The last stay ends at `end` [s]."""
        if len(self):
            self._numbers[-3] = end

    def __iter__(self) -> Iterator[Stay]:
        words = list(self._words)
        rows = np.array(self._numbers).reshape(-1, _NUMBERS)
        for row, parent, holder in zip(rows, self._named[::2], self._named[1::2], strict=True):
            begin, end, opening, room = row[12:].tolist()
            yield Stay(
                body=self._body,
                parent=words[parent],
                X=Pose(row[:3].copy(), row[3:12].reshape(3, 3).copy()),
                begin=begin,
                end=end,
                holder=words[holder],
                opening=opening,
                room=room,
            )
